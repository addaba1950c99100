#include "preprocess/survey.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <unordered_set>

#include "codec/frame.h"
#include "preprocess/footprints.h"

namespace promenade {

namespace {

constexpr uint64_t kMiB = uint64_t(1) << 20;
// What importing a file takes, at most, in times its size: parsed text or decompressed geometry, then the scene.
constexpr uint64_t kImportFactor = 4;
// Farther than this from zero, single precision loses more than half a millimetre.
constexpr double kFarFromZeroM = 8192;

constexpr glm::u8vec4 kLostTexture{180, 178, 174, 255};  // as import draws what has no picture: a light warm grey

/// Bijective, so that no two triangles have the same priority. Source: Steele et al., SplitMix64, 2014.
uint64_t mixed(uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// Keeps the samples with the smallest priorities out of any number.
class SampleKeeper {
 public:
  explicit SampleKeeper(uint32_t limit) : limit_(limit) {}
  bool wants(uint64_t priority) const { return priority < threshold_; }
  void add(const TriangleSample& sample) {
    samples_.push_back(sample);
    if (samples_.size() >= size_t(limit_) * 2) reduce();
  }
  std::vector<TriangleSample> take() {
    if (samples_.size() > limit_) reduce();
    return std::move(samples_);
  }

 private:
  void reduce() {
    const auto end = samples_.begin() + std::ptrdiff_t(limit_);
    std::nth_element(samples_.begin(), end, samples_.end(),
                     [](const auto& a, const auto& b) { return a.priority < b.priority; });
    threshold_ = end->priority;
    samples_.erase(end, samples_.end());
  }
  uint32_t limit_;
  uint64_t threshold_ = ~uint64_t(0);
  std::vector<TriangleSample> samples_;
};

template <class T>
uint64_t hash_of(const std::vector<T>& values, uint64_t seed) {
  return checksum(std::as_bytes(std::span(values)), seed ^ values.size());
}

template <class T>
uint64_t hash_of(const T& value, uint64_t seed) {
  return checksum(std::as_bytes(std::span(&value, 1)), seed);
}

uint64_t hash_of(const Mesh& m, uint64_t seed) {
  seed = hash_of(m.positions, seed), seed = hash_of(m.normals, seed), seed = hash_of(m.texcoords, seed);
  return hash_of(m.materials, hash_of(m.indices, hash_of(m.colors, seed)));
}

uint64_t hash_of(const Animation& a, uint64_t seed) {
  for (const AnimationTrack& t : a.tracks) {
    const uint32_t fields[] = {uint32_t(t.way), t.components, t.first_time, t.first_value, t.keys};
    seed = hash_of(t.period_s, checksum(std::as_bytes(std::span(fields)), seed));
  }
  for (const AnimationJoint& j : a.joints) {
    seed = hash_of(j.parent_from_rest, hash_of(j.tracks, hash_of(j.parent, seed)));
    seed = hash_of(j.translation, hash_of(j.rotation, hash_of(j.scale, seed)));
  }
  return hash_of(a.values, hash_of(a.times, seed));
}

uint64_t hash_of(const Scene& scene) {
  uint64_t hash = 0;
  for (const Mesh& mesh : scene.meshes) hash = hash_of(mesh, hash);
  for (const Material& m : scene.materials) {
    const uint32_t fields[] = {m.texture,         uint32_t(m.wrap_u), uint32_t(m.wrap_v),
                               uint32_t(m.alpha), m.alpha_cutoff,     m.two_sided ? 1U : 0U};
    hash = checksum(std::as_bytes(std::span(fields)), hash_of(m.color, hash));
  }
  for (const SourceTexture& texture : scene.textures) hash = hash_of(texture.encoded, hash);
  for (const SceneInstance& instance : scene.instances) {
    hash = hash_of(instance.world_from_mesh, hash_of(instance.mesh, hash));
    hash = checksum(std::as_bytes(std::span(instance.class_name)), hash_of(instance.joint, hash));
    if (instance.joint != kNoJoint) hash = hash_of(instance.joint_from_mesh, hash);
    if (instance.is_solid) hash = hash_of(uint8_t(1), hash);
  }
  return hash_of(scene.animation, hash);
}

/// Passes on everything but progress: a part's own would only disturb that of all parts.
class QuietMonitor : public JobMonitor {
 public:
  explicit QuietMonitor(JobMonitor& monitor) : monitor_(monitor) {}
  void warning(std::string_view message) override { monitor_.warning(message); }
  bool cancelled() const override { return monitor_.cancelled(); }

 private:
  JobMonitor& monitor_;
};

/// Materials that an instanced mesh uses.
std::vector<bool> used_materials(const Scene& scene) {
  std::vector<bool> used(scene.materials.size());
  std::vector<bool> seen(scene.meshes.size());
  for (const SceneInstance& instance : scene.instances) {
    if (seen[instance.mesh]) continue;
    seen[instance.mesh] = true;
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.materials.empty()) used[0] = true;
    for (const uint32_t m : mesh.materials) used[m] = true;
  }
  return used;
}

/// Adds parts in order.
class Surveyor {
 public:
  Surveyor(const MemoryBudget& budget, TextureStore& textures)
      : budget_(budget), textures_(textures), keeper_(budget.samples) {}

  Status add(const SourcePart& part, Scene scene) {
    SurveyedPart surveyed;
    surveyed.part = part;
    surveyed.hash = hash_of(scene);
    PROMENADE_TRY(add_materials(scene, surveyed));
    for (const SceneInstance& instance : scene.instances) {
      survey_.classes.try_emplace(instance.class_name, static_cast<uint32_t>(survey_.classes.size()));
      surveyed.triangles += scene.meshes[instance.mesh].triangle_count();
      if (instance.joint == kNoJoint) add_instance(scene.meshes[instance.mesh], instance.world_from_mesh);
      if (instance.is_solid && instance.joint == kNoJoint) add_footprints(scene, instance);
    }
    add_objects(scene);
    survey_.triangles += surveyed.triangles;
    for (const auto& [name, count] : scene.report.counts) survey_.report.counts[name] += count;
    for (const std::string& warning : scene.report.warnings) warn(warning);
    survey_.hash = hash_of(surveyed.hash, survey_.hash);
    // Half of the share: the other half is for parts that are being imported.
    if (const uint64_t bytes = byte_size(scene); cached_bytes_ + bytes <= budget_.scenes / 2) {
      cached_bytes_ += bytes;
      surveyed.cached = std::make_shared<const Scene>(std::move(scene));
    }
    survey_.parts.push_back(std::move(surveyed));
    return Done{};
  }

  Survey finish() {
    survey_.samples = keeper_.take();
    const glm::dvec3 far = glm::max(glm::abs(survey_.world_box.min), glm::abs(survey_.world_box.max));
    if (std::max({far.x, far.y, far.z}) > kFarFromZeroM) survey_.origin = glm::round(survey_.world_box.center());
    const glm::dmat4 model_from_world = glm::translate(glm::dmat4(1), -survey_.origin);
    for (const auto& [footprints, world_from_mesh] : footprints_)
      if (const auto there = placed(footprints, model_from_world * world_from_mesh)) survey_.footprints.append(*there);
    return std::move(survey_);
  }

 private:
  Status add_materials(const Scene& scene, SurveyedPart& surveyed) {
    const std::vector<bool> used = used_materials(scene);
    std::vector<bool> used_textures(scene.textures.size());
    for (size_t m = 0; m < scene.materials.size(); ++m)
      if (used[m] && scene.materials[m].texture != kNoTexture) used_textures[scene.materials[m].texture] = true;
    std::vector<std::string> notes;
    Result<std::vector<uint32_t>> ids = textures_.add(scene.textures, used_textures, notes);
    if (!ids.ok()) return ids.error();
    for (const std::string& note : notes) warn(note);
    surveyed.material_of.assign(scene.materials.size(), kUnusedMaterial);
    for (size_t m = 0; m < scene.materials.size(); ++m) {
      if (!used[m]) continue;
      Material material = scene.materials[m];
      if (material.texture != kNoTexture) material.texture = (*ids)[material.texture];
      const bool lost = scene.materials[m].texture != kNoTexture && material.texture == kNoTexture;
      if (lost && material.color == glm::u8vec4(255)) material.color = kLostTexture;
      surveyed.material_of[m] = survey_.materials.add(material);
    }
    return Done{};
  }

  /// What hangs on one joint becomes one object.
  void add_objects(const Scene& scene) {
    std::vector<bool> used(scene.animation.joints.size(), false);
    for (const SceneInstance& instance : scene.instances)
      if (instance.joint != kNoJoint) used[instance.joint] = true;
    const std::vector<uint32_t> joint_of = append_used(survey_.animation, scene.animation, used);
    std::map<uint32_t, SurveyedObject> by_joint;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
      const SceneInstance& instance = scene.instances[i];
      if (instance.joint == kNoJoint) continue;
      SurveyedObject& object = by_joint[instance.joint];
      object.instances.push_back(i);
      const Mesh& mesh = scene.meshes[instance.mesh];
      survey_.world_box.add(
          swept_box(scene.animation, instance.joint, transformed_box(bounds(mesh), instance.joint_from_mesh)));
      survey_.moving_triangles += mesh.triangle_count();
    }
    for (auto& [joint, object] : by_joint) {
      object.part = static_cast<uint32_t>(survey_.parts.size());
      object.joint = joint_of[joint];
      const double metres = 1 / largest_scale(scene.animation, joint);
      for (int i = 0; i < 3; ++i) object.joint_from_object[i][i] = metres;
      survey_.objects.push_back(std::move(object));
    }
  }

  void add_footprints(const Scene& scene, const SceneInstance& instance) {
    Footprints footprints = footprints_of(scene.meshes[instance.mesh], scene.materials);
    if (!footprints.empty()) footprints_.emplace_back(std::move(footprints), instance.world_from_mesh);
  }

  /// Many tiles may lack the same picture.
  void warn(const std::string& warning) {
    if (warned_.insert(warning).second) survey_.report.warnings.push_back(warning);
  }

  void add_instance(const Mesh& mesh, const glm::dmat4& world_from_mesh) {
    const auto placed = [&](uint32_t v) { return glm::dvec3(world_from_mesh * glm::dvec4(mesh.positions[v], 1.0)); };
    for (uint32_t v = 0; v < mesh.vertex_count(); ++v) survey_.world_box.add(placed(v));
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      const uint64_t priority = mixed(serial_++);
      if (!keeper_.wants(priority)) continue;
      const glm::dvec3 a = placed(mesh.indices[3 * t]), b = placed(mesh.indices[3 * t + 1]),
                       c = placed(mesh.indices[3 * t + 2]);
      const double edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
      const auto area = static_cast<float>(glm::length(glm::cross(b - a, c - a)) / 2);
      keeper_.add({(a + b + c) / 3.0, static_cast<float>(edge), area, priority});
    }
  }

  const MemoryBudget& budget_;
  TextureStore& textures_;
  SampleKeeper keeper_;
  Survey survey_;
  std::vector<std::pair<Footprints, glm::dmat4>> footprints_;  ///< and world from their own space
  std::unordered_set<std::string> warned_;
  uint64_t serial_ = 0;
  uint64_t cached_bytes_ = 0;
};

Status check_part_size(const SourcePart& part, const MemoryBudget& budget) {
  if (part.bytes <= budget.scenes) return Done{};
  return Error{fmt::format("{}: {} MiB do not fit into --memory {} MiB; give more, or divide the source into files",
                           part.name, part.bytes / kMiB, budget.memory_bytes / kMiB)};
}

/// How many parts may be imported at once.
size_t import_tokens(const std::vector<SourcePart>& parts, const MemoryBudget& budget) {
  uint64_t largest = 1;
  for (const SourcePart& part : parts) largest = std::max(largest, part.bytes);
  return static_cast<size_t>(std::clamp<uint64_t>(budget.scenes / 2 / (kImportFactor * largest), 1, budget.jobs));
}

}  // namespace

uint32_t MaterialTable::add(const Material& m) {
  const uint32_t color = m.color.r | uint32_t(m.color.g) << 8 | uint32_t(m.color.b) << 16 | uint32_t(m.color.a) << 24;
  const auto key = std::tuple(m.texture, color, static_cast<uint8_t>(m.wrap_u), static_cast<uint8_t>(m.wrap_v),
                              static_cast<uint8_t>(m.alpha), m.alpha_cutoff, m.two_sided);
  const auto [place, is_new] = known_.emplace(key, static_cast<uint32_t>(materials_.size()));
  if (is_new) materials_.push_back(m);
  return place->second;
}

uint64_t byte_size(const Scene& scene) {
  uint64_t bytes = scene.instances.size() * sizeof(SceneInstance);
  for (const Mesh& mesh : scene.meshes) bytes += byte_size(mesh);
  for (const SourceTexture& texture : scene.textures) bytes += texture.encoded.size();
  return bytes;
}

Result<Survey> survey_source(const std::vector<SourcePart>& parts, const ImportOptions& options,
                             const MemoryBudget& budget, TextureStore& textures, JobMonitor& monitor) {
  for (const SourcePart& part : parts) PROMENADE_TRY(check_part_size(part, budget));
  QuietMonitor quiet(monitor);
  using Imported = std::pair<size_t, std::shared_ptr<Result<Scene>>>;
  Surveyor surveyor(budget, textures);
  std::optional<Error> failure;  // of the serial stage only
  size_t next = 0;
  std::atomic<bool> stop = false;
  tbb::parallel_pipeline(
      import_tokens(parts, budget),
      tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) -> size_t {
        if (next == parts.size() || stop) {
          control.stop();
          return 0;
        }
        return next++;
      }) & tbb::make_filter<size_t, Imported>(tbb::filter_mode::parallel, [&](size_t i) -> Imported {
        return {i, std::make_shared<Result<Scene>>(import_part(parts[i], options, parts.size() > 1 ? quiet : monitor))};
      }) & tbb::make_filter<Imported, void>(tbb::filter_mode::serial_in_order, [&](const Imported& imported) {
        if (failure) return;
        Result<Scene>& scene = *imported.second;
        const Status status = monitor.cancelled() ? Status(Error{kInterrupted})
                              : scene.ok()        ? surveyor.add(parts[imported.first], std::move(*scene))
                                                  : Status(scene.error());
        if (!status.ok()) failure = status.error(), stop = true;
        monitor.progress("survey", imported.first + 1, parts.size());
      }));
  if (failure) return *failure;
  Survey survey = surveyor.finish();
  if (survey.triangles == 0)
    return Error{fmt::format("{}: no triangles", parts.empty()       ? "source"
                                                 : parts.size() == 1 ? parts[0].name
                                                                     : fmt::format("{} and {} other files",
                                                                                   parts[0].name, parts.size() - 1))};
  return survey;
}

Result<std::shared_ptr<const Scene>> scene_of(const SurveyedPart& part, const ImportOptions& options,
                                              JobMonitor& monitor) {
  if (part.cached) return part.cached;
  QuietMonitor quiet(monitor);
  Result<Scene> scene = import_part(part.part, options, quiet);
  if (!scene.ok()) return scene.error();
  if (hash_of(*scene) != part.hash)
    return Error{fmt::format("{}: changed while it was being built; build again", part.part.name)};
  return std::make_shared<const Scene>(std::move(*scene));
}

}  // namespace promenade
