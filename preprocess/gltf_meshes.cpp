#include "preprocess/gltf_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "preprocess/gltf_draco.h"

namespace promenade {

namespace {

// Meshes may share accessors and compressed views expand: bounds what a small hostile file can make of that.
constexpr uint64_t kMaxExpansion = 256;
constexpr uint64_t kFreeBytes = uint64_t(64) << 20;
constexpr uint64_t kBytesEach = 40;  // about what a vertex or a triangle takes

enum class Mode : uint8_t { triangles = 4, strip = 5, fan = 6 };

/// One primitive's values, from accessors or from Draco.
class PrimitiveSource {
 public:
  PrimitiveSource(GltfDocument& document, const Json& primitive, std::string what)
      : document_(document), primitive_(primitive), what_(std::move(what)) {}

  Status open() {
    const Json& draco = member(member(primitive_, "extensions"), "KHR_draco_mesh_compression");
    if (draco.is_object()) {
      Result<GltfDracoPrimitive> decoded = GltfDracoPrimitive::decode(document_, draco, what_);
      if (!decoded.ok()) return decoded.error();
      draco_.emplace(*std::move(decoded));
      vertices_ = draco_->vertex_count();
      indices_ = draco_->index_count();
      return Done{};
    }
    const std::optional<uint64_t> position = accessor_of("POSITION");
    if (!position) return Done{};
    const Result<GltfAccessor> a = document_.accessor(*position);
    if (!a.ok()) return a.error();
    vertices_ = indices_ = a->count;
    if (const std::optional<uint64_t> index = whole(member(primitive_, "indices"))) {
      const Result<GltfAccessor> i = document_.accessor(*index);
      if (!i.ok()) return i.error();
      indices_ = i->count;
    }
    return Done{};
  }

  uint64_t vertices() const { return vertices_; }
  uint64_t indices() const { return indices_; }

  /// Components of an attribute; 0: the primitive has none such.
  Result<uint32_t> components(const char* attribute) {
    if (draco_ && draco_->components(attribute) != 0) return draco_->components(attribute);
    const std::optional<uint64_t> index = accessor_of(attribute);
    if (!index) return 0U;
    const Result<GltfAccessor> a = document_.accessor(*index);
    if (!a.ok()) return a.error();
    if (a->count != vertices_)
      return Error{fmt::format("{}: {}: {} values of {} for {} vertices; the file is broken", document_.name(), what_,
                               a->count, attribute, vertices_)};
    return a->components;
  }

  /// Values of the vertices from `first` on.
  Status floats(const char* attribute, uint64_t first, std::span<float> out) {
    if (draco_ && draco_->components(attribute) != 0) {
      if (draco_->floats(attribute, first, out)) return Done{};
      return Error{
          fmt::format("{}: {}: Draco's {} does not decode; the file is broken", document_.name(), what_, attribute)};
    }
    return document_.read_floats(*accessor_of(attribute), first, out);
  }

  Status read_indices(std::span<uint32_t> out) {
    if (draco_) {
      draco_->indices(out);
      return Done{};
    }
    if (const std::optional<uint64_t> index = whole(member(primitive_, "indices")))
      return document_.read_indices(*index, out);
    for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<uint32_t>(i);
    return Done{};
  }

 private:
  std::optional<uint64_t> accessor_of(const char* attribute) const {
    return whole(member(member(primitive_, "attributes"), attribute));
  }

  GltfDocument& document_;
  const Json& primitive_;
  std::string what_;
  std::optional<GltfDracoPrimitive> draco_;
  uint64_t vertices_ = 0, indices_ = 0;
};

/// Strips and fans as lists.
std::vector<uint32_t> to_triangles(std::vector<uint32_t> indices, Mode mode) {
  if (mode == Mode::triangles) {
    indices.resize(indices.size() / 3 * 3);
    return indices;
  }
  std::vector<uint32_t> out;
  for (size_t i = 2; i < indices.size(); ++i) {
    const size_t odd = mode == Mode::strip ? i & 1U : 0;
    const size_t first = mode == Mode::strip ? i - 2 : 0;
    out.insert(out.end(), {indices[first], indices[i - 1 + odd], indices[i - odd]});
  }
  return out;
}

/// Removes triangles whose indices are out of range; how many.
uint64_t drop_wild(std::vector<uint32_t>& indices, uint64_t vertices) {
  size_t kept = 0;
  for (size_t i = 0; i + 2 < indices.size(); i += 3) {
    if (indices[i] >= vertices || indices[i + 1] >= vertices || indices[i + 2] >= vertices) continue;
    std::copy_n(indices.begin() + static_cast<ptrdiff_t>(i), 3, indices.begin() + static_cast<ptrdiff_t>(kept));
    kept += 3;
  }
  const uint64_t dropped = (indices.size() - kept) / 3;
  indices.resize(kept);
  return dropped;
}

class MeshReader {
 public:
  MeshReader(GltfDocument& document, const std::vector<GltfTexcoords>& texcoords, Scene& scene)
      : document_(document), texcoords_(texcoords), scene_(scene) {}

  Result<Mesh> read(const Json& declared, size_t index) {
    Mesh mesh;
    const Json& primitives = member(declared, "primitives");
    for (size_t p = 0; p < (primitives.is_array() ? primitives.size() : 0); ++p)
      PROMENADE_TRY(read_primitive(primitives[p], fmt::format("mesh {} primitive {}", index, p), mesh));
    return mesh;
  }

 private:
  /// The vertices that a primitive uses: of its own, from `first` on; in the mesh, after `before` others.
  struct Range {
    uint32_t first;
    size_t before, count;
  };

  Status read_primitive(const Json& primitive, const std::string& what, Mesh& mesh) {
    const uint64_t mode = whole(member(primitive, "mode")).value_or(4);
    if (mode < 4 || mode > 6) {
      ++scene_.report.counts["primitives_skipped"];
      return Done{};
    }
    PrimitiveSource source(document_, primitive, what);
    PROMENADE_TRY(source.open());
    if (source.vertices() == 0 || source.indices() < 3) return Done{};
    PROMENADE_TRY(check_budget(0, source.indices(), what));
    std::vector<uint32_t> indices(static_cast<size_t>(source.indices()));
    PROMENADE_TRY(source.read_indices(indices));
    indices = to_triangles(std::move(indices), static_cast<Mode>(mode));
    const uint64_t dropped = drop_wild(indices, source.vertices());
    if (dropped != 0) scene_.report.counts["faces_dropped"] += dropped;
    if (indices.empty()) return Done{};

    // Only the vertices that the indices span: exporters share one huge buffer among many primitives.
    const auto [lowest, highest] = std::minmax_element(indices.begin(), indices.end());
    const Range range{*lowest, mesh.vertex_count(), size_t(*highest) - *lowest + 1};
    PROMENADE_TRY(check_budget(range.count, 0, what));
    if (range.count + mesh.vertex_count() > 0xffffffffU)
      return Error{fmt::format("{}: {}: more than 2^32 vertices; split the mesh", document_.name(), what)};
    const uint32_t material = material_of(primitive);
    PROMENADE_TRY(read_positions(source, what, mesh, range));
    PROMENADE_TRY(read_normals(source, mesh, range));
    PROMENADE_TRY(read_texcoords(source, material, mesh, range));
    PROMENADE_TRY(read_colors(source, mesh, range));
    const auto shift = static_cast<uint32_t>(range.before) - range.first;  // wraps around where it must
    for (uint32_t& i : indices) i += shift;
    if (mesh.indices.empty())
      mesh.indices = std::move(indices);
    else
      mesh.indices.insert(mesh.indices.end(), indices.begin(), indices.end());
    mesh.materials.resize(mesh.triangle_count(), material);
    return Done{};
  }

  Status check_budget(uint64_t vertices, uint64_t indices, const std::string& what) {
    const uint64_t most = (kFreeBytes + kMaxExpansion * document_.source_bytes()) / kBytesEach;
    used_ = vertices > most || indices > most ? most + 1 : used_ + vertices + indices;
    if (used_ <= most) return Done{};
    return Error{
        fmt::format("{}: {}: {} vertices, {} indices and what came before are more than a file of {} bytes can "
                    "mean; the file is broken",
                    document_.name(), what, vertices, indices, document_.source_bytes())};
  }

  uint32_t material_of(const Json& primitive) {
    const std::optional<uint64_t> index = whole(member(primitive, "material"));
    if (index && *index < texcoords_.size()) return static_cast<uint32_t>(*index);
    if (!default_material_) {
      default_material_ = static_cast<uint32_t>(scene_.materials.size());
      scene_.materials.emplace_back();
    }
    return *default_material_;
  }

  Status read_positions(PrimitiveSource& source, const std::string& what, Mesh& mesh, const Range& range) {
    const Result<uint32_t> components = source.components("POSITION");
    if (!components.ok()) return components.error();
    if (*components != 3) return Error{fmt::format("{}: {}: POSITION is no VEC3", document_.name(), what)};
    mesh.positions.resize(range.before + range.count);
    return source.floats("POSITION", range.first, {&mesh.positions[range.before].x, range.count * 3});
  }

  Status read_normals(PrimitiveSource& source, Mesh& mesh, const Range& range) {
    const Result<uint32_t> components = source.components("NORMAL");
    if (!components.ok()) return components.error();
    const bool has = *components == 3;
    if (!has && mesh.normals.empty()) return Done{};
    mesh.normals.resize(range.before, glm::vec3(0));  // (0, 0, 0): none yet; complete_normals makes them flat
    mesh.normals.resize(range.before + range.count, glm::vec3(0));
    if (!has) return Done{};
    return source.floats("NORMAL", range.first, {&mesh.normals[range.before].x, range.count * 3});
  }

  Status read_texcoords(PrimitiveSource& source, uint32_t material, Mesh& mesh, const Range& range) {
    const GltfTexcoords wanted = material < texcoords_.size() ? texcoords_[material] : GltfTexcoords{};
    const std::string attribute = fmt::format("TEXCOORD_{}", wanted.set);
    const Result<uint32_t> components = wanted.textured ? source.components(attribute.c_str()) : Result<uint32_t>(0U);
    if (!components.ok()) return components.error();
    const bool has = *components == 2;
    if (!has && mesh.texcoords.empty()) return Done{};
    mesh.texcoords.resize(range.before, glm::vec2(0));
    mesh.texcoords.resize(range.before + range.count, glm::vec2(0));
    if (!has) return Done{};
    PROMENADE_TRY(source.floats(attribute.c_str(), range.first, {&mesh.texcoords[range.before].x, range.count * 2}));
    if (wanted.has_transform)
      for (size_t v = range.before; v < range.before + range.count; ++v)
        mesh.texcoords[v] = glm::vec2(glm::dvec2(wanted.transform * glm::dvec3(glm::dvec2(mesh.texcoords[v]), 1.0)));
    return Done{};
  }

  Status read_colors(PrimitiveSource& source, Mesh& mesh, const Range& range) {
    const Result<uint32_t> components = source.components("COLOR_0");
    if (!components.ok()) return components.error();
    const bool has = *components == 3 || *components == 4;
    if (!has && mesh.colors.empty()) return Done{};
    mesh.colors.resize(range.before, glm::u8vec4(255));
    mesh.colors.resize(range.before + range.count, glm::u8vec4(255));
    if (!has) return Done{};
    std::vector<float> linear(range.count * *components);
    PROMENADE_TRY(source.floats("COLOR_0", range.first, linear));
    for (size_t v = 0; v < range.count; ++v) {
      const float* from = linear.data() + v * *components;
      glm::u8vec4& to = mesh.colors[range.before + v];
      for (int c = 0; c < 3; ++c) to[c] = linear_to_srgb(std::isnan(from[c]) ? 1.0F : from[c]);
      if (*components == 4 && !std::isnan(from[3]))
        to.a = static_cast<uint8_t>(std::lround(std::clamp(from[3], 0.0F, 1.0F) * 255.0F));
    }
    return Done{};
  }

  GltfDocument& document_;
  const std::vector<GltfTexcoords>& texcoords_;
  Scene& scene_;
  std::optional<uint32_t> default_material_;
  uint64_t used_ = 0;
};

/// Where some primitives had normals and others not, the others get their triangles' own.
void complete_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  const auto missing = [&](uint32_t v) { return mesh.normals[v] == glm::vec3(0); };
  std::vector<uint32_t> without;
  std::vector<uint32_t> with;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const uint32_t* corners = mesh.indices.data() + size_t(t) * 3;
    (missing(corners[0]) && missing(corners[1]) && missing(corners[2]) ? without : with).push_back(t);
  }
  if (without.empty()) return;
  Mesh flat = submesh(mesh, without);
  flat.normals.clear();
  Mesh rest = submesh(mesh, with);
  if (rest.triangle_count() == 0) {
    mesh = std::move(flat);
    return;
  }
  append(rest, flat);
  mesh = std::move(rest);
}

}  // namespace

Status read_gltf_meshes(GltfDocument& document, const std::vector<GltfTexcoords>& texcoords, Scene& scene,
                        std::vector<uint32_t>& mesh_of, JobMonitor& monitor) {
  const Json& declared = member(document.json(), "meshes");
  if (!declared.is_array()) return Done{};
  MeshReader reader(document, texcoords, scene);
  std::map<std::string, uint32_t> known;
  for (size_t i = 0; i < declared.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    monitor.progress("import", i, declared.size());
    const Json& primitives = member(declared[i], "primitives");
    const auto [place, is_new] = known.emplace(primitives.dump(-1, ' ', false, Json::error_handler_t::replace),
                                               static_cast<uint32_t>(scene.meshes.size()));
    mesh_of.push_back(place->second);
    if (!is_new) continue;
    Result<Mesh> mesh = reader.read(declared[i], i);
    if (!mesh.ok()) return mesh.error();
    complete_normals(*mesh);
    scene.meshes.push_back(*std::move(mesh));
  }
  return Done{};
}

}  // namespace promenade
