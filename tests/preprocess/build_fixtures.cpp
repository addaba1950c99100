#include "tests/preprocess/build_fixtures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace promenade {

std::string obj_text(const Mesh& mesh, const std::string& header, size_t vertices_before) {
  std::string text = header;
  for (const glm::vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  // OBJ's picture begins at the bottom.
  for (const glm::vec2& t : mesh.texcoords) text += fmt::format("vt {} {}\n", t.x, 1 - t.y);
  for (const glm::vec3& n : mesh.normals) text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
  for (size_t i = 0; i < mesh.indices.size(); ++i) {
    const size_t v = mesh.indices[i] + vertices_before + 1;
    text += i % 3 == 0 ? "f " : " ";
    text += fmt::format("{}/{}/{}", v, mesh.texcoords.empty() ? "" : std::to_string(v),
                        mesh.normals.empty() ? "" : std::to_string(v));
    if (i % 3 == 2) text += '\n';
  }
  return text;
}

BuildOptions small_build(const std::filesystem::path& source, const std::filesystem::path& model) {
  BuildOptions options;
  options.sources = {source};
  options.model = model;
  options.import.up = UpAxis::z;
  options.jobs = 2;
  options.node_triangles = 300;
  options.chunk_triangles = 4000;
  return options;
}

std::map<std::string, std::vector<std::byte>> bytes_of(const std::filesystem::path& folder) {
  std::map<std::string, std::vector<std::byte>> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files[entry.path().filename()] = *read_file(entry.path());
  return files;
}

Mesh mesh_of(const ModelReader& reader, uint32_t node) {
  Result<Mesh> mesh = reader.read_mesh(NodeId{node});
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return mesh.ok() ? *mesh : Mesh();
}

std::vector<uint32_t> leaves_below(const Model& model, uint32_t node) {
  const std::span<const NodeId> children = model.children_of(NodeId{node});
  if (children.empty()) return {node};
  std::vector<uint32_t> leaves;
  for (const NodeId child : children) {
    const std::vector<uint32_t> below = leaves_below(model, index_of(child));
    leaves.insert(leaves.end(), below.begin(), below.end());
  }
  return leaves;
}

}  // namespace promenade
