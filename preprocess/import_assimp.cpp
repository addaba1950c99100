// Everything that has no reader of ours, through assimp: COLLADA, FBX, 3DS, IFC, STL, OFF ... Its readers are not made
// for broken files, so they run in a process of their own, and see only files in the source's folder.

#include <fmt/format.h>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <map>
#include <span>

#include "layout/file_io.h"
#include "preprocess/import_builder.h"
#include "preprocess/import_isolated.h"
#include "preprocess/import_readers.h"
#include "preprocess/import_uri.h"

namespace promenade {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kMaxImageBytes = uint64_t(1) << 30;
constexpr int kMaxNodes = 50'000'000;  // bounds hostile hierarchies

/// Opens nothing outside one folder, and nothing for writing.
class ConfinedFiles : public Assimp::DefaultIOSystem {
 public:
  explicit ConfinedFiles(const fs::path& folder) {
    std::error_code ignored;
    folder_ = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, ignored);
  }
  bool Exists(const char* file) const override { return allowed(file) && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return allowed(file) && mode[0] == 'r' ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  bool allowed(const char* file) const {
    std::error_code error;
    const fs::path path = fs::canonical(file, error);
    if (error || !fs::is_regular_file(path, error)) return false;
    const auto end = std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end()).first;
    return end == folder_.end();
  }
  fs::path folder_;
};

uint8_t unit_byte(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isnan(value) ? 1.0F : value, 0.0F, 1.0F) * 255.0F));
}

Wrap wrap_of(aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Mirror ? Wrap::mirror : mode == aiTextureMapMode_Wrap ? Wrap::repeat : Wrap::clamp;
}

glm::dmat4 to_matrix(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

class AssimpConverter {
 public:
  AssimpConverter(const aiScene& from, fs::path folder) : from_(from), folder_(std::move(folder)) {}

  ReadScene convert() {
    Scene& scene = out_.scene;
    for (unsigned i = 0; i < from_.mNumMaterials; ++i) scene.materials.push_back(to_material(*from_.mMaterials[i]));
    if (scene.materials.empty()) scene.materials.emplace_back();
    for (unsigned i = 0; i < from_.mNumMeshes; ++i) add_mesh(*from_.mMeshes[i]);
    if (from_.mRootNode != nullptr) place(*from_.mRootNode);
    out_.up = UpAxis::y;  // assimp turns z-up formats that say so to y up by the root's transform
    out_.sides_unknown = true;
    read_metadata();
    return std::move(out_);
  }

 private:
  /// FBX leaves its axes and unit (centimetres a unit) to the caller.
  void read_metadata() {
    if (from_.mMetaData == nullptr) return;
    int up = 1;
    if (from_.mMetaData->Get("UpAxis", up) && up == 2) out_.up = UpAxis::z;
    double centimetres = 0;
    float centimetres_single = 0;
    if (from_.mMetaData->Get("UnitScaleFactor", centimetres_single))
      centimetres = double(centimetres_single);
    else if (!from_.mMetaData->Get("UnitScaleFactor", centimetres))
      return;
    if (std::isfinite(centimetres) && centimetres > 0) out_.unit_m = centimetres / 100.0;
  }

  Material to_material(const aiMaterial& from) {
    Material to;
    aiColor4D color(1, 1, 1, 1);
    from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    float opacity = 1;
    from.Get(AI_MATKEY_OPACITY, opacity);
    to.color = {unit_byte(color.r), unit_byte(color.g), unit_byte(color.b), unit_byte(color.a * opacity)};
    if (to.color.a == 0) to.color.a = 255;  // exporters that mean the opposite; nothing is modelled to be invisible
    if (to.color.a < 255) to.alpha = AlphaMode::blend;
    const aiTextureType type =
        from.GetTextureCount(aiTextureType_DIFFUSE) != 0 ? aiTextureType_DIFFUSE : aiTextureType_BASE_COLOR;
    aiString path;
    std::array<aiTextureMapMode, 3> modes{aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (from.GetTexture(type, 0, &path, nullptr, nullptr, nullptr, nullptr, modes.data()) != aiReturn_SUCCESS)
      return to;
    to.texture = texture_named(path.C_Str());
    to.wrap_u = wrap_of(modes[0]), to.wrap_v = wrap_of(modes[1]);
    if (glm::u8vec3(to.color) == glm::u8vec3(0)) to.color = {255, 255, 255, to.color.a};
    return to;
  }

  uint32_t texture_named(const std::string& name) {
    const auto [place, is_new] = textures_.emplace(name, static_cast<uint32_t>(out_.scene.textures.size()));
    if (!is_new) return place->second;
    SourceTexture texture{name.substr(0, 200), {}};
    if (const aiTexture* embedded = from_.GetEmbeddedTexture(name.c_str()); embedded != nullptr) {
      if (embedded->mHeight == 0) {  // encoded; its width is its bytes
        const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);
        texture.encoded.assign(bytes, bytes + embedded->mWidth);
      }
    } else if (const Result<fs::path> path = resolve_picture(folder_, name); path.ok()) {
      if (Result<std::vector<std::byte>> bytes = read_file(*path, kMaxImageBytes); bytes.ok())
        texture.encoded = *std::move(bytes);
    }
    out_.scene.textures.push_back(std::move(texture));
    return place->second;
  }

  void add_mesh(const aiMesh& from) {
    MeshBuilder builder;
    const aiVector3D* uvs = from.mTextureCoords[0];
    const aiColor4D* colors = from.mColors[0];
    for (unsigned v = 0; v < from.mNumVertices; ++v) {
      SourceVertex vertex;
      const auto& p = from.mVertices[v];
      vertex.position = {p.x, p.y, p.z};
      if (from.mNormals != nullptr)
        vertex.normal = glm::vec3(from.mNormals[v].x, from.mNormals[v].y, from.mNormals[v].z);
      if (uvs != nullptr) vertex.texcoord = glm::vec2(uvs[v].x, 1.0F - uvs[v].y);  // assimp's origin is at the bottom
      if (colors != nullptr)
        vertex.color =
            glm::u8vec4(unit_byte(colors[v].r), unit_byte(colors[v].g), unit_byte(colors[v].b), unit_byte(colors[v].a));
      builder.add_vertex(vertex);
    }
    Counts& counts = out_.scene.report.counts;
    const uint32_t material = from.mMaterialIndex < out_.scene.materials.size() ? from.mMaterialIndex : 0;
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      const std::span<const uint32_t> corners(face.mIndices, face.mNumIndices);
      if (corners.size() < 3) {
        ++counts["primitives_skipped"];
        continue;
      }
      if (std::any_of(corners.begin(), corners.end(), [&](uint32_t v) { return v >= from.mNumVertices; })) {
        ++counts["faces_dropped"];
        continue;
      }
      const std::array<uint32_t, 1> ring{face.mNumIndices};
      builder.add_polygon(corners, ring, material, counts);
    }
    offsets_.emplace_back(0);
    out_.scene.meshes.push_back(builder.finish(offsets_.back()));
  }

  /// assimp names IFC's products by class, name and id: "IfcWall_north wall_2O2Fr$t4X7Zf8NOew3FLKr".
  static std::string class_of(const std::string& name) {
    const size_t end = name.find('_');
    return name.rfind("Ifc", 0) == 0 && end != std::string::npos ? name.substr(0, end) : std::string();
  }

  void place(const aiNode& root) {
    struct Visit {
      const aiNode* node;
      glm::dmat4 world_from_parent;
    };
    std::vector<Visit> stack{{&root, glm::dmat4(1)}};
    for (int visited = 0; !stack.empty() && visited < kMaxNodes; ++visited) {
      const Visit visit = stack.back();
      stack.pop_back();
      const glm::dmat4 world = visit.world_from_parent * to_matrix(visit.node->mTransformation);
      for (unsigned m = 0; m < visit.node->mNumMeshes; ++m) {
        const uint32_t mesh = visit.node->mMeshes[m];
        if (mesh >= offsets_.size()) continue;
        glm::dmat4 placed = world;
        placed[3] = world * glm::dvec4(offsets_[mesh], 1);
        std::string name = visit.node->mName.C_Str();
        if (name.empty()) name = from_.mMeshes[mesh]->mName.C_Str();
        out_.scene.instances.push_back({mesh, placed, name, class_of(name)});
      }
      for (unsigned c = visit.node->mNumChildren; c-- > 0;) stack.push_back({visit.node->mChildren[c], world});
    }
  }

  const aiScene& from_;
  fs::path folder_;
  ReadScene out_;
  std::map<std::string, uint32_t> textures_;
  std::vector<glm::dvec3> offsets_;
};

Result<ReadScene> read_with_assimp(const fs::path& path, const std::string& name) {
  Assimp::Importer importer;
  importer.SetIOHandler(new ConfinedFiles(path.parent_path()));  // the importer owns it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr) {
    std::string why = importer.GetErrorString();
    std::replace(why.begin(), why.end(), '\n', ' ');
    return Error{fmt::format("{}: cannot be read ({}); the file is cut off, broken or of another format", name,
                             why.substr(0, 200))};
  }
  ReadScene out = AssimpConverter(*scene, path.parent_path()).convert();
  // These have no axes of their own, and who writes them (printing, surveying) thinks z up.
  const std::string extension = path.extension().string();
  if (extension == ".stl" || extension == ".STL" || extension == ".off" || extension == ".OFF") out.up = UpAxis::z;
  return out;
}

}  // namespace

Result<ReadScene> read_assimp(const fs::path& path, const std::string& name, JobMonitor& monitor) {
  return read_isolated(
      name, [&] { return read_with_assimp(path, name); }, monitor);
}

}  // namespace promenade
