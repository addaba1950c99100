#include "datasets/city_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <optional>

#include "geometry/animation.h"

namespace promenade {
Result<std::unique_ptr<CityFile>> CityTile::create(const std::filesystem::path& path) {
  Result<GlbWriter> writer = GlbWriter::create(path, "Promenade city generator");
  if (!writer) return writer.error();
  writer->add_material("painted", Material{});
  Material glass;
  glass.alpha = AlphaMode::blend;
  writer->add_material("glass", glass);
  return std::unique_ptr<CityFile>(new CityTile(std::move(*writer)));
}

Status CityTile::add_object(const UniqueObject& object, const EncodedFacade& facade, CityFigures& figures) {
  std::optional<Mesh> textured;
  if (!facade.jpeg.empty()) {
    const Result<uint32_t> texture = writer_.add_texture(object.name, "image/jpeg", facade.jpeg);
    if (!texture) return texture.error();
    Material wall;
    wall.texture = *texture;
    wall.wrap_u = wall.wrap_v = Wrap::clamp;
    const uint32_t material = writer_.add_material(object.name, wall);
    textured = object.mesh;
    std::replace(textured->materials.begin(), textured->materials.end(), kTexturedWall, material);
    figures.texture_megapixels += static_cast<double>(facade.pixels) * 1e-6;
  }
  const Mesh& mesh = textured ? *textured : object.mesh;
  const Result<uint32_t> index = writer_.add_mesh(object.name, mesh);
  if (!index) return index.error();
  const glm::dmat4 place = glm::translate(glm::dmat4(1), object.origin);
  writer_.add_node(object.name, object.class_name, *index, place);
  figures.box.add(transformed_box(bounds(mesh), place));
  figures.triangles += mesh.triangle_count(), figures.unique_triangles += mesh.triangle_count();
  ++figures.objects;
  if (object.class_name == "building") ++figures.buildings;
  return Done{};
}

Result<uint32_t> CityTile::mesh_of(const PropKind& kind, PropLibrary& props, CityFigures& figures) {
  const Mesh& mesh = props.mesh(kind);
  figures.triangles += mesh.triangle_count();
  ++figures.objects;
  if (const auto known = mesh_of_.find(kind); known != mesh_of_.end()) return known->second;
  const Result<uint32_t> added = writer_.add_mesh(fmt::format("{}_{}", name_of(kind.prop), kind.variant), mesh);
  if (!added) return added;
  mesh_of_.emplace(kind, *added);
  figures.unique_triangles += mesh.triangle_count();
  return added;
}

Status CityTile::add_prop(const PropInstance& prop, const std::string& name, PropLibrary& props, CityFigures& figures) {
  const Result<uint32_t> mesh = mesh_of(prop.kind, props, figures);
  if (!mesh) return mesh.error();
  glm::dmat4 place = glm::translate(glm::dmat4(1), prop.position);
  place = glm::rotate(place, prop.yaw_rad, glm::dvec3(0, 0, 1));
  place = glm::scale(place, glm::dvec3(prop.scale));
  writer_.add_node(name, name_of(prop.kind.prop), *mesh, place);
  return Done{};
}

Status CityTile::add_traffic(const std::vector<MovingCar>& cars, PropLibrary& props, CityFigures& figures) {
  for (size_t i = 0; i < cars.size(); ++i) {
    const Result<uint32_t> mesh = mesh_of(cars[i].kind, props, figures);
    if (!mesh) return mesh.error();
    PROMENADE_TRY(
        writer_.add_moving_node(fmt::format("traffic_{}", i), name_of(cars[i].kind.prop), *mesh, cars[i].motion));
  }
  return Done{};
}

Status CityTile::add(const CityBlock& block, uint32_t x, uint32_t y, const std::vector<EncodedFacade>& facades,
                     PropLibrary& props, CityFigures& figures) {
  for (size_t i = 0; i < block.objects.size(); ++i) PROMENADE_TRY(add_object(block.objects[i], facades[i], figures));
  for (size_t i = 0; i < block.props.size(); ++i)
    PROMENADE_TRY(add_prop(block.props[i], fmt::format("{}_{}_{}_{}", name_of(block.props[i].kind.prop), x, y, i),
                           props, figures));
  return Done{};
}

}  // namespace promenade
