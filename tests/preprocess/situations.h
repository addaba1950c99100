#pragma once
// Small worlds for hiders: named objects, each a node of its own, on disk as a model.

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>

#include "codec/geometry_codec.h"
#include "layout/model_io.h"
#include "preprocess/footprints.h"
#include "tests/preprocess/surfaces.h"
#include "tests/temporary_folder.h"

namespace promenade {

/// Materials of every situation.
constexpr uint32_t kStone = 0, kGlassPane = 1, kLeaves = 2, kBothSides = 3;

inline Mesh of_material(Mesh mesh, uint32_t material) {
  mesh.materials.assign(mesh.triangle_count(), material);
  mesh.normals.clear(), mesh.colors.clear();
  return mesh;
}

/// A closed box that faces outwards.
inline Mesh block(const glm::vec3& low, const glm::vec3& high, uint32_t material = kStone) {
  Mesh mesh;
  test::add_box(mesh, low, high, {255, 255, 255, 255});
  return of_material(std::move(mesh), material);
}

/// A quadrilateral, counter-clockwise from its front.
inline Mesh sheet(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
                  uint32_t material = kStone) {
  Mesh mesh;
  test::add_quad(mesh, a, b, c, d, {255, 255, 255, 255});
  return of_material(std::move(mesh), material);
}

inline Mesh flat_ground(float half = 60, float z = 0) {
  return sheet({-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z});
}

inline Mesh together(Mesh a, const Mesh& b) {
  append(a, b);
  return a;
}

/// Upright and turned about its middle by an angle.
inline Mesh turned_block(const glm::vec2& middle, const glm::vec2& half, float low, float high, float angle_rad) {
  Mesh mesh = block({-half.x, -half.y, low}, {half.x, half.y, high});
  for (glm::vec3& p : mesh.positions)
    p = {middle.x + p.x * std::cos(angle_rad) - p.y * std::sin(angle_rad),
         middle.y + p.x * std::sin(angle_rad) + p.y * std::cos(angle_rad), p.z};
  return mesh;
}

using Objects = std::vector<std::pair<std::string, Mesh>>;

/// What the source says of its objects.
enum class Tell : uint8_t { nothing, footprints };

/// The objects as a model: leaves that are roots, in their order.
class SituationModel {
 public:
  explicit SituationModel(const Objects& objects, Tell tell = Tell::nothing) {
    Result<ModelWriter> writer = ModelWriter::create(folder_ / "situation.prom");
    EXPECT_TRUE(writer.ok());
    ModelTables tables;
    tables.materials = {Material{}, Material{}, Material{}, Material{}};
    tables.materials[kGlassPane].alpha = AlphaMode::blend, tables.materials[kGlassPane].color.a = 90;
    tables.materials[kLeaves].alpha = AlphaMode::mask;
    tables.materials[kBothSides].two_sided = true;
    ModelManifest manifest;
    for (const auto& [name, mesh] : objects) {
      const Result<EncodedMesh> encoded = encode_mesh(mesh, {GeometryCodec::raw, std::nullopt, 1});
      EXPECT_TRUE(encoded.ok());
      NodeRecord node;
      node.box = bounds(mesh);
      node.cone = {{0, 0, 1}, -1};
      node.triangles = static_cast<uint32_t>(mesh.triangle_count());
      node.vertices = static_cast<uint32_t>(mesh.vertex_count());
      node.segment = *writer->append(SegmentRecord::Type::mesh, encoded->bytes);
      manifest.source_triangles += node.triangles;
      manifest.world_box.add(DBox{node.box.min, node.box.max});
      number_[name] = static_cast<uint32_t>(tables.nodes.size());
      tables.roots.push_back(NodeId{number_[name]});
      tables.nodes.push_back(node);
    }
    ModelObjects told;
    if (tell == Tell::footprints)
      for (const auto& [name, mesh] : objects) told.footprints.append(footprints_of(mesh, tables.materials));
    const Status finished = writer->stage(std::move(tables), std::move(manifest), std::move(told));
    EXPECT_TRUE(finished.ok()) << (finished.ok() ? "" : finished.error().message);
    EXPECT_TRUE(writer->publish().ok());
    Result<ModelReader> opened = ModelReader::open(folder_ / "situation.prom");
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
    reader_.emplace(std::move(*opened));
  }

  const ModelReader& reader() const { return *reader_; }
  uint32_t number_of(const std::string& name) const { return number_.at(name); }
  std::vector<NodeId> front() const { return reader_->model().tables.roots; }

 private:
  TemporaryFolder folder_;
  std::map<std::string, uint32_t> number_;
  std::optional<ModelReader> reader_;
};

}  // namespace promenade
