#include "tests/preprocess/import_fixtures.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>

namespace promenade {

namespace fs = std::filesystem;

Result<Scene> import_file(const fs::path& path, const ImportOptions& options) {
  JobMonitor monitor;
  return import_part({path, path.filename().string(), 0}, options, monitor);
}

Result<Scene> import_bytes(const std::string& name, std::string_view bytes, const ImportOptions& options) {
  const TemporaryFolder folder;
  return import_file(folder.write(name, bytes), options);
}

size_t GlbFixture::components(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
}

size_t GlbFixture::add_view(std::span<const std::byte> bytes, size_t stride) {
  while (binary_.size() % 4 != 0) binary_.push_back('\0');
  nlohmann::json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  json["bufferViews"].push_back(view);
  binary_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return json["bufferViews"].size() - 1;
}

size_t GlbFixture::add_accessor(size_t view, size_t count, const char* type, int component_type, bool normalized) {
  nlohmann::json accessor = {{"bufferView", view}, {"count", count}, {"type", type}, {"componentType", component_type}};
  if (normalized) accessor["normalized"] = true;
  json["accessors"].push_back(accessor);
  return json["accessors"].size() - 1;
}

size_t GlbFixture::add_floats(const std::vector<float>& values, const char* type) {
  return add_values(values, type, 5126);
}

size_t GlbFixture::add_mesh(size_t positions, size_t indices) {
  json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  return json["meshes"].size() - 1;
}

std::string GlbFixture::gltf(const std::string& uri) const {
  nlohmann::json out = json;
  out["buffers"] = {{{"byteLength", binary_.size()}}};
  if (!uri.empty()) out["buffers"][0]["uri"] = uri;
  return out.dump();
}

std::string GlbFixture::bytes() const {
  std::string text = gltf("");
  while (text.size() % 4 != 0) text.push_back(' ');
  std::string binary = binary_;
  while (binary.size() % 4 != 0) binary.push_back('\0');
  std::string out;
  const auto u32 = [&out](size_t value) {
    const auto v = static_cast<uint32_t>(value);
    out.append(reinterpret_cast<const char*>(&v), 4);
  };
  u32(0x46546C67), u32(2), u32(12 + 8 + text.size() + 8 + binary.size());
  u32(text.size()), u32(0x4E4F534A);
  out += text;
  u32(binary.size()), u32(0x004E4942);
  return out + binary;
}

GlbFixture tetrahedron_glb() {
  GlbFixture glb;
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
  const size_t indices = glb.add_values<uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, "SCALAR", 5123);
  glb.add_mesh(positions, indices);
  glb.json["nodes"] = {{{"mesh", 0}, {"name", "tetrahedron"}}};
  return glb;
}

std::string find_scene_defect(const Scene& scene) {
  if (scene.materials.empty()) return "no material";
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    if (std::string defect = find_defect(scene.meshes[m]); !defect.empty())
      return fmt::format("mesh {}: {}", m, defect);
    for (size_t t = 0; t < scene.meshes[m].triangle_count(); ++t)
      if (scene.meshes[m].material_of(t) >= scene.materials.size()) return fmt::format("mesh {}: material {}", m, t);
  }
  for (const Material& material : scene.materials)
    if (material.texture != kNoTexture && material.texture >= scene.textures.size()) return "texture out of range";
  for (const SceneInstance& instance : scene.instances)
    if (instance.mesh >= scene.meshes.size()) return "instance of no mesh";
  return {};
}

}  // namespace promenade
