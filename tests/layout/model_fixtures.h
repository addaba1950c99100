#pragma once
// Small models with known answers.

#include <filesystem>
#include <glm/geometric.hpp>

#include "codec/geometry_codec.h"
#include "codec/image_codec.h"
#include "layout/model_io.h"

namespace promenade {

inline Mesh square_at(float x) {
  Mesh mesh;
  mesh.positions = {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}};
  mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {1, 1};
  return mesh;
}

inline Image two_by_one() { return {2, 1, {{255, 0, 0, 255}, {0, 0, 255, 128}}}; }

inline NodeRecord node_with(const Box& box, float error_m, uint32_t level, NodeId parent, uint32_t segment) {
  NodeRecord node;
  node.box = box;
  node.error_m = error_m;
  node.error_p99_m = error_m / 2;
  node.cone = {{0, 0, 1}, 0.5F};
  node.average_normal = {0, 0, 1};
  node.surface_m2 = 1;
  node.parent = parent;
  node.level = level;
  node.triangles = 2;
  node.textured_triangles = 2;
  node.vertices = 4;
  node.segment = segment;
  return node;
}

/// A root, node 0, over two leaves, 1 and 2, that share a texture; segments 0 to 2 are meshes, 3 is the texture.
inline ModelTables root_and_two_leaves() {
  ModelTables tables;
  const Box left{{0, 0, 0}, {1, 1, 0}}, right{{2, 0, 0}, {3, 1, 0}}, both{{0, 0, 0}, {3, 1, 0}};
  tables.nodes = {node_with(both, 0.5F, 0, kNoNode, 0), node_with(left, 0, 1, NodeId{0}, 1),
                  node_with(right, 0, 1, NodeId{0}, 2)};
  tables.nodes[0].child_count = 2;
  tables.nodes[0].textured_triangles = 0;
  for (size_t leaf = 1; leaf <= 2; ++leaf) tables.nodes[leaf].texture_count = 1;
  tables.nodes[2].first_texture = 1;
  tables.children = {NodeId{1}, NodeId{2}};
  tables.roots = {NodeId{0}};
  tables.materials = {Material{},
                      Material{{200, 100, 50, 255}, 0, Wrap::clamp, Wrap::mirror, AlphaMode::mask, 7, true}};
  tables.textures = {{2, 1, 3, TextureRecord::kHasOpacity}};
  tables.node_textures = {0, 0};
  return tables;
}

inline ModelManifest manifest_of_squares() {
  ModelManifest manifest;
  manifest.tool_version = "0.0.1";
  manifest.input_hash = 0x0123456789abcdefU;
  manifest.origin = {500000.1, -3, 0.25};
  manifest.world_box = {{500000.1, -3, 0.25}, {500003.1, -2, 0.25}};
  manifest.source_triangles = 4;
  manifest.settings = {{"node-triangles", "2000"}, {"level-factor", "4"}};
  manifest.sources = {"squares \"a\".obj"};
  manifest.import_counts = {{"triangles", 4}, {"faces_degenerate", 1}};
  manifest.notes = {"missing texture facade.png"};
  return manifest;
}

/// The segments of root_and_two_leaves, in their order.
inline Status append_squares(ModelWriter& writer) {
  Mesh untextured = square_at(0);
  untextured.texcoords.clear();
  for (const Mesh& mesh : {untextured, square_at(0), square_at(2)}) {
    const Result<EncodedMesh> encoded = encode_mesh(mesh, {GeometryCodec::meshopt, 0.0009765625F, 9});
    if (!encoded) return encoded.error();
    const Result<uint32_t> segment = writer.append(SegmentRecord::Type::mesh, encoded->bytes);
    if (!segment) return segment.error();
  }
  const Result<std::vector<std::byte>> picture = encode_image(two_by_one(), ImageFormat::png);
  if (!picture) return picture.error();
  const Result<uint32_t> segment = writer.append(SegmentRecord::Type::texture, *picture);
  return segment ? Status(Done{}) : Status(segment.error());
}

inline Status write_squares(const std::filesystem::path& path, FileSystem& files = real_file_system(),
                            const std::string& tool_version = "0.0.1") {
  Result<ModelWriter> writer = ModelWriter::create(path, files);
  if (!writer) return writer.error();
  PROMENADE_TRY(append_squares(*writer));
  ModelManifest manifest = manifest_of_squares();
  manifest.tool_version = tool_version;
  return writer->finish(root_and_two_leaves(), manifest);
}

/// Segments and files that fit root_and_two_leaves without any bytes on disk.
inline Model model_of_squares() {
  Model model{manifest_of_squares(), root_and_two_leaves(), {}};
  model.manifest.files = {{"geometry.bin", 300}, {"textures.bin", 100}, {"tables.bin", 900}};
  for (uint32_t i = 0; i < 3; ++i)
    model.tables.segments.push_back({SegmentRecord::Type::mesh, 0, 100 * i, 100, 0x1111111111111111U * (i + 1)});
  model.tables.segments.push_back({SegmentRecord::Type::texture, 1, 0, 100, 0xfedcba9876543210U});
  return model;
}

}  // namespace promenade
