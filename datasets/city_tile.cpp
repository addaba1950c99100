#include "datasets/city_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <optional>

namespace promenade {
namespace {

DBox moved_box(const Box& box, const glm::dmat4& world_from_mesh) {
  DBox result;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                            (i & 4) != 0 ? box.max.z : box.min.z, 1);
    result.add(glm::dvec3(world_from_mesh * corner));
  }
  return result;
}

}  // namespace

Result<CityTile> CityTile::create(const std::filesystem::path& path) {
  Result<GlbWriter> writer = GlbWriter::create(path, "Promenade city generator");
  if (!writer) return writer.error();
  writer->add_material("painted", Material{});
  Material glass;
  glass.alpha = AlphaMode::blend;
  writer->add_material("glass", glass);
  return CityTile(std::move(*writer));
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
  figures.box.add(moved_box(bounds(mesh), place));
  figures.triangles += mesh.triangle_count(), figures.unique_triangles += mesh.triangle_count();
  ++figures.objects;
  if (object.class_name == "building") ++figures.buildings;
  return Done{};
}

Status CityTile::add_prop(const PropInstance& prop, const std::string& name, PropLibrary& props, CityFigures& figures) {
  const Mesh& mesh = props.mesh(prop.kind);
  auto known = mesh_of_.find(prop.kind);
  if (known == mesh_of_.end()) {
    const std::string mesh_name = fmt::format("{}_{}", name_of(prop.kind.prop), prop.kind.variant);
    const Result<uint32_t> added = writer_.add_mesh(mesh_name, mesh);
    if (!added) return added.error();
    known = mesh_of_.emplace(prop.kind, *added).first;
    figures.unique_triangles += mesh.triangle_count();
  }
  glm::dmat4 place = glm::translate(glm::dmat4(1), prop.position);
  place = glm::rotate(place, prop.yaw_rad, glm::dvec3(0, 0, 1));
  place = glm::scale(place, glm::dvec3(prop.scale));
  writer_.add_node(name, name_of(prop.kind.prop), known->second, place);
  figures.triangles += mesh.triangle_count();
  ++figures.objects;
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
