#include "preprocess/import.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <exception>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <new>

#include "preprocess/import_readers.h"
#include "preprocess/repair.h"

namespace promenade {

namespace fs = std::filesystem;

namespace {

constexpr glm::u8vec4 kPlainColor{180, 178, 174, 255};  // of a surface whose picture is missing: a light warm grey

constexpr size_t kSniffedBytes = 65536;

using Reader = Result<ReadScene> (*)(const fs::path&, const std::string&, JobMonitor&);

struct Format {
  std::string_view extension;
  Reader read;
};

// assimp reads many more extensions; these are the ones that hold surfaces and that it reads well.
constexpr auto kFormats = std::to_array<Format>(
    {{".glb", read_gltf},      {".gltf", read_gltf},         {".obj", read_obj},        {".ply", read_ply},
     {".json", read_cityjson}, {".cityjson", read_cityjson}, {".jsonl", read_cityjson}, {".dae", read_assimp},
     {".fbx", read_assimp},    {".3ds", read_assimp},        {".ifc", read_assimp},     {".stl", read_assimp},
     {".off", read_assimp},    {".ase", read_assimp},        {".x", read_assimp},       {".lwo", read_assimp},
     {".ac", read_assimp},     {".blend", read_assimp},      {".dxf", read_assimp},     {".3mf", read_assimp},
     {".amf", read_assimp},    {".x3d", read_assimp},        {".wrl", read_assimp},     {".zae", read_assimp}});

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

const Format* format_of(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  const auto found =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return f.extension == extension; });
  return found == kFormats.end() ? nullptr : &*found;
}

/// JSON is a model only when it is CityJSON: paths, manifests and the like lie beside models. Its words are looked for
/// near the start, where every writer puts one of them.
bool is_model_file(const fs::path& path) {
  const Format* format = format_of(path);
  if (format == nullptr || lower(path.extension().string()) != ".json") return format != nullptr;
  std::ifstream in(path, std::ios::binary);
  std::string head(kSniffedBytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return head.find("\"CityJSON\"") != std::string::npos || head.find("\"CityObjects\"") != std::string::npos;
}

std::string known_formats() {
  std::string out;
  for (const Format& format : kFormats) out += (out.empty() ? "" : " ") + std::string(format.extension.substr(1));
  return out;
}

Status add_folder(const fs::path& folder, std::vector<SourcePart>& parts) {
  std::error_code error;
  std::vector<SourcePart> found;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (!entry->is_regular_file(ignored) || !is_model_file(entry->path())) continue;
    found.push_back(
        {entry->path(), entry->path().lexically_relative(folder).generic_string(), entry->file_size(ignored)});
  }
  if (error)
    return Error{
        fmt::format("{}: the folder cannot be read ({}); check its permissions", folder.string(), error.message())};
  if (found.empty())
    return Error{fmt::format("{}: no model file in this folder; known formats: {}", folder.string(), known_formats())};
  std::sort(found.begin(), found.end(), [](const SourcePart& a, const SourcePart& b) { return a.name < b.name; });
  parts.insert(parts.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
  return Done{};
}

Status add_file(const fs::path& path, std::vector<SourcePart>& parts) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return Error{fmt::format("{}: is no plain file or folder; give a model file", path.string())};
  if (format_of(path) == nullptr)
    return Error{fmt::format("{}: unknown format '{}'; known formats: {}", path.string(), path.extension().string(),
                             known_formats())};
  if (!is_model_file(path))
    return Error{fmt::format("{}: JSON, but no CityJSON; known formats: {}", path.string(), known_formats())};
  const uint64_t bytes = fs::file_size(path, error);
  if (error) return Error{fmt::format("{}: {}", path.string(), error.message())};
  parts.push_back({path, path.filename().string(), bytes});
  return Done{};
}

/// Meshes and instances from the file's axes and units to metres, z up. The unit cancels in the instances' rotation and
/// scale; the turn (x, -z, y) is exact.
void convert_frame(Scene& scene, UpAxis up, double unit_m) {
  const auto turned = [up](const auto& v) { return up == UpAxis::y ? decltype(v + v)(v.x, -v.z, v.y) : v; };
  if (up == UpAxis::y || unit_m != 1)
    for (Mesh& mesh : scene.meshes) {
      for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(turned(p)) * unit_m);
      for (glm::vec3& n : mesh.normals) n = turned(n);
    }
  const glm::dmat3 turn(turned(glm::dvec3(1, 0, 0)), turned(glm::dvec3(0, 1, 0)), turned(glm::dvec3(0, 0, 1)));
  const glm::dmat3 back = glm::transpose(turn);
  for (SceneInstance& instance : scene.instances) {
    glm::dmat4& m = instance.world_from_mesh;
    const glm::dvec3 offset = turned(glm::dvec3(m[3])) * unit_m;
    m = glm::dmat4(turn * glm::dmat3(m) * back);
    m[3] = glm::dvec4(offset, 1);
    // Joints stay in the file's frame among themselves: only what hangs on them, and what they hang on, is turned.
    instance.joint_from_mesh *= glm::dmat4(back / unit_m);
  }
  for (AnimationJoint& joint : scene.animation.joints)
    if (joint.parent == kNoJoint) joint.parent_from_rest = glm::dmat4(turn * unit_m) * joint.parent_from_rest;
}

void drop_non_finite(Scene& scene) {
  Counts& counts = scene.report.counts;
  for (Mesh& mesh : scene.meshes) {
    const std::vector<bool> broken = mark_non_finite(mesh, counts);
    if (std::find(broken.begin(), broken.end(), true) == broken.end()) continue;
    counts["faces_dropped"] += drop_vertices(mesh, broken);
  }
}

/// Materials whose picture is missing get a plain colour; each missing picture is named once.
void plain_for_missing(Scene& scene) {
  for (size_t t = 0; t < scene.textures.size(); ++t) {
    if (!scene.textures[t].encoded.empty()) continue;
    bool used = false;
    for (Material& material : scene.materials) {
      if (material.texture != t) continue;
      used = true;
      material.texture = kNoTexture;
      if (glm::u8vec3(material.color) == glm::u8vec3(255))
        material.color = {glm::u8vec3(kPlainColor), material.color.a};
    }
    if (!used) continue;
    ++scene.report.counts["textures_missing"];
    scene.report.warnings.push_back(fmt::format("missing texture {}", scene.textures[t].name));
  }
}

/// Meshes without triangles go, with their instances; so do meshes that no instance shows.
void drop_unused(Scene& scene) {
  constexpr uint32_t kGone = 0xffffffffU;
  std::vector<uint32_t> renamed(scene.meshes.size(), kGone);
  for (const SceneInstance& instance : scene.instances)
    if (scene.meshes[instance.mesh].triangle_count() != 0) renamed[instance.mesh] = 0;
  std::vector<Mesh> meshes;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    if (renamed[m] == kGone) continue;
    renamed[m] = static_cast<uint32_t>(meshes.size());
    meshes.push_back(std::move(scene.meshes[m]));
  }
  scene.meshes = std::move(meshes);
  std::erase_if(scene.instances, [&](const SceneInstance& i) { return renamed[i.mesh] == kGone; });
  for (SceneInstance& instance : scene.instances) instance.mesh = renamed[instance.mesh];
}

/// Objects whose movement is not sound (numbers that are not finite, or larger than any model) stand still.
void check_movement(Scene& scene, double max_extent_m) {
  Animation& animation = scene.animation;
  const bool sound = find_defect(animation).empty();
  uint64_t moving = 0, dropped = 0;
  for (SceneInstance& instance : scene.instances) {
    if (instance.joint == kNoJoint) continue;
    bool moves = sound;
    if (moves) {
      const DBox swept = swept_box(animation, instance.joint,
                                   transformed_box(bounds(scene.meshes[instance.mesh]), instance.joint_from_mesh));
      const glm::dvec3 size = swept.size(), far = glm::max(glm::abs(swept.min), glm::abs(swept.max));
      const double scale = largest_scale(animation, instance.joint);
      moves = std::max({size.x, size.y, size.z}) <= 2 * max_extent_m && std::isfinite(far.x + far.y + far.z) &&
              scale > 0 && std::isfinite(scale);
    }
    moves ? ++moving : ++dropped;
    if (!moves) instance.joint = kNoJoint;
  }
  if (moving == 0) animation = {};
  if (moving > 0) scene.report.counts["moving_objects"] = moving;
  if (dropped > 0) scene.report.counts["animations_dropped"] = dropped;
}

void count_scene(Scene& scene) {
  Counts& counts = scene.report.counts;
  counts["meshes"] = scene.meshes.size();
  counts["instances"] = scene.instances.size();
  counts["triangles"] = counts["vertices"] = counts["triangles_unique"] = 0;
  for (const SceneInstance& instance : scene.instances)
    counts["triangles"] += scene.meshes[instance.mesh].triangle_count();
  for (const Mesh& mesh : scene.meshes) {
    counts["triangles_unique"] += mesh.triangle_count();
    counts["vertices"] += mesh.vertex_count();
  }
}

/// Formats that do not say: two-sided, but for materials of which every face belongs to a solid.
void decide_sides(Scene& scene) {
  std::vector<bool> seen(scene.materials.size(), false);
  std::vector<bool> open(scene.materials.size(), false);
  for (const Mesh& mesh : scene.meshes) {
    const std::vector<bool> solid = solid_triangles(mesh);
    for (size_t t = 0; t < solid.size(); ++t) {
      seen[mesh.material_of(t)] = true;
      if (!solid[t]) open[mesh.material_of(t)] = true;
    }
  }
  for (size_t m = 0; m < scene.materials.size(); ++m) scene.materials[m].two_sided = open[m] || !seen[m];
}

/// Meshes at once; isolated, so that a thread that waits here begins no other part of the source.
void repair_all(Scene& scene) {
  std::vector<Counts> counts(scene.meshes.size());
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(size_t(0), counts.size(), [&](size_t i) { repair_mesh(scene.meshes[i], counts[i]); }); });
  for (const Counts& of_mesh : counts)
    for (const auto& [what, count] : of_mesh) scene.report.counts[what] += count;
}

Scene finished(ReadScene read, const ImportOptions& options) {
  Scene scene = std::move(read.scene);
  if (scene.materials.empty()) scene.materials.emplace_back();
  convert_frame(scene, options.up.value_or(read.up), options.unit_m.value_or(read.unit_m));
  drop_non_finite(scene);
  drop_out_of_range(scene, options.max_extent_m);
  if (options.repair) repair_all(scene);
  for (Mesh& mesh : scene.meshes) drop_unused_vertices(mesh);
  if (read.sides_unknown) decide_sides(scene);
  plain_for_missing(scene);
  drop_unused(scene);
  check_movement(scene, options.max_extent_m);
  count_scene(scene);
  return scene;
}

}  // namespace

Result<std::vector<SourcePart>> list_source(std::span<const fs::path> paths) {
  std::vector<SourcePart> parts;
  if (paths.empty()) return Error{"no source given; name a model file or a folder of them"};
  for (const fs::path& path : paths) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status))
      return Error{fmt::format("{}: {}; check the path", path.string(), error ? error.message() : "is not there")};
    PROMENADE_TRY(fs::is_directory(status) ? add_folder(path, parts) : add_file(path, parts));
  }
  return parts;
}

Result<Scene> import_part(const SourcePart& part, const ImportOptions& options, JobMonitor& monitor) {
  const Format* format = format_of(part.path);
  if (format == nullptr) return Error{fmt::format("{}: unknown format; known formats: {}", part.name, known_formats())};
  try {
    Result<ReadScene> read = format->read(part.path, part.name, monitor);
    if (!read.ok()) return read.error();
    return finished(*std::move(read), options);
  } catch (const std::bad_alloc&) {
    return Error{fmt::format("{}: does not fit into memory; split the file", part.name)};
  } catch (const std::exception& error) {  // a library's
    return Error{fmt::format("{}: cannot be read ({}); the file is broken", part.name, error.what())};
  }
}

Mesh flattened(const Scene& scene, const SceneInstance& instance, const glm::dvec3& model_origin) {
  return transformed(scene.meshes[instance.mesh],
                     glm::translate(glm::dmat4(1), -model_origin) * instance.world_from_mesh);
}

}  // namespace promenade
