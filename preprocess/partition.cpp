#include "preprocess/partition.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <optional>

#include "preprocess/lattice_cut.h"
#include "preprocess/mesh_piece.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr size_t kSliceTriangles = size_t(1) << 16;  // of an instance at a time: some MiB, whatever the instance's size
constexpr const char* kPartitionUnit = "partition";

/// Some triangles of one instance.
struct Slice {
  std::shared_ptr<const Scene> scene;
  const SurveyedPart* part = nullptr;
  uint32_t instance = 0;
  size_t first = 0, last = 0;  ///< triangles
};
using Routed = std::vector<std::pair<uint32_t, Mesh>>;

/// Goes through all parts, instances and slices in order.
class SliceSource {
 public:
  SliceSource(Survey& survey, const ImportOptions& options, JobMonitor& monitor)
      : survey_(survey), options_(options), monitor_(monitor) {}

  /// nullopt: no more, or an error.
  std::optional<Slice> next() {
    while (!error) {
      if (!scene_ && !open_part()) return std::nullopt;
      if (instance_ == scene_->instances.size()) {
        survey_.parts[part_].cached.reset();
        scene_.reset();
        ++part_, instance_ = 0;
        continue;
      }
      const SceneInstance& instance = scene_->instances[instance_];
      const size_t triangles = scene_->meshes[instance.mesh].triangle_count();
      if (first_ >= triangles || instance.joint != kNoJoint) {  // what moves has trees of its own
        ++instance_, first_ = 0;
        continue;
      }
      const size_t last = std::min(first_ + kSliceTriangles, triangles);
      Slice slice{scene_, &survey_.parts[part_], instance_, first_, last};
      first_ = last;
      return slice;
    }
    return std::nullopt;
  }

  std::optional<Error> error;

 private:
  bool open_part() {
    if (part_ == survey_.parts.size()) return false;
    Result<std::shared_ptr<const Scene>> scene = scene_of(survey_.parts[part_], options_, monitor_);
    if (!scene.ok())
      error = scene.error();
    else
      scene_ = *scene;
    return scene.ok();
  }

  Survey& survey_;
  const ImportOptions& options_;
  JobMonitor& monitor_;
  std::shared_ptr<const Scene> scene_;
  size_t part_ = 0;
  uint32_t instance_ = 0;
  size_t first_ = 0;
};

/// A slice's triangles in model space, materials by the survey's table.
Mesh flattened_slice(const Slice& slice, const glm::dvec3& origin) {
  const SceneInstance& instance = slice.scene->instances[slice.instance];
  const Mesh& whole = slice.scene->meshes[instance.mesh];
  const glm::dmat4 model_from_mesh = glm::translate(glm::dmat4(1.0), -origin) * instance.world_from_mesh;
  Mesh mesh;
  if (slice.first == 0 && slice.last == whole.triangle_count()) {
    mesh = transformed(whole, model_from_mesh);
  } else {
    std::vector<uint32_t> triangles(slice.last - slice.first);
    std::iota(triangles.begin(), triangles.end(), static_cast<uint32_t>(slice.first));
    mesh = transformed(piece_of(whole, triangles), model_from_mesh);
  }
  if (mesh.materials.empty()) mesh.materials.assign(mesh.triangle_count(), 0);
  for (uint32_t& material : mesh.materials) material = slice.part->material_of[material];
  return mesh;
}

class Router {
 public:
  Router(Mesh mesh, const ChunkTree& tree) : mesh_(std::move(mesh)), tree_(tree) {}

  Routed route() {
    cut_along_lattice(mesh_, tree_.cut_step_m);
    box_ = bounds(mesh_);
    std::vector<uint32_t> all(mesh_.triangle_count());
    std::iota(all.begin(), all.end(), 0U);
    send(std::move(all), tree_.first_plane, box_);
    std::sort(lists_.begin(), lists_.end());
    Routed pieces;
    for (const auto& [chunk, triangles] : lists_) pieces.emplace_back(chunk, piece_of(mesh_, triangles));
    return pieces;
  }

 private:
  /// box: of everything that is sent.
  void send(std::vector<uint32_t> triangles, uint32_t to, const Box& box) {
    if (triangles.empty()) return;
    if ((to & ChunkTree::kChunk) != 0) {
      lists_.emplace_back(to & ~ChunkTree::kChunk, std::move(triangles));
      return;
    }
    const ChunkTree::Plane& plane = tree_.planes[to];
    if (plane.axis != ChunkTree::kByTurns) {
      if (box.max[plane.axis] < plane.value) return send(std::move(triangles), plane.below, box);
      if (box.min[plane.axis] >= plane.value) return send(std::move(triangles), plane.above, box);
    }
    std::vector<uint32_t> below, above;
    divide(triangles, plane, below, above);
    triangles = {};
    const Box below_box = box_of(below);
    send(std::move(below), plane.below, below_box);
    const Box above_box = box_of(above);
    send(std::move(above), plane.above, above_box);
  }

  void divide(const std::vector<uint32_t>& triangles, const ChunkTree::Plane& plane, std::vector<uint32_t>& below,
              std::vector<uint32_t>& above) const {
    if (plane.axis == ChunkTree::kByTurns) {
      for (size_t i = 0; i < triangles.size(); ++i) (i % 2 == 0 ? below : above).push_back(triangles[i]);
      return;
    }
    for (const uint32_t t : triangles) (centroid(mesh_, t)[plane.axis] < plane.value ? below : above).push_back(t);
  }

  Box box_of(const std::vector<uint32_t>& triangles) const {
    Box box;
    for (const uint32_t t : triangles)
      for (size_t corner = 0; corner < 3; ++corner) box.add(mesh_.positions[mesh_.indices[size_t(t) * 3 + corner]]);
    return box;
  }

  Mesh mesh_;
  const ChunkTree& tree_;
  Box box_;
  std::vector<std::pair<uint32_t, std::vector<uint32_t>>> lists_;
};

std::vector<std::byte> unit_of(const SpillIndex& index) {
  UnitWriter writer;
  writer.value(index.file_bytes);
  writer.value(uint64_t(index.chunks.size()));
  for (const ChunkSpill& chunk : index.chunks) {
    writer.value(chunk.triangles), writer.value(chunk.mesh_bytes);
    writer.array(chunk.blocks), writer.array(chunk.classes);
  }
  return std::move(writer.bytes());
}

std::optional<SpillIndex> finished_partition(const WorkFolder& folder, uint64_t hash, uint32_t chunks) {
  const auto bytes = folder.load(kPartitionUnit, hash);
  if (!bytes) return std::nullopt;
  UnitReader reader(*bytes);
  SpillIndex index;
  index.file_bytes = reader.value<uint64_t>();
  if (reader.value<uint64_t>() != chunks) return std::nullopt;
  for (uint32_t i = 0; i < chunks; ++i) {
    ChunkSpill& chunk = index.chunks.emplace_back();
    chunk.triangles = reader.value<uint64_t>(), chunk.mesh_bytes = reader.value<uint64_t>();
    chunk.blocks = reader.array<SpillBlock>(), chunk.classes = reader.array<ClassRun>();
  }
  const Result<RandomAccessFile> file = folder.open_unit(kSpillFile);
  if (!reader.ok() || !file.ok() || file->size() != index.file_bytes) return std::nullopt;
  return index;
}

/// Slices in, pieces out, in order: flattening and routing on all threads, writing on one.
Status spill_slices(SliceSource& source, const Survey& survey, const ChunkTree& tree, size_t tokens,
                    SpillWriter& writer, JobMonitor& monitor) {
  std::optional<Error> failure;
  std::atomic<bool> stop = false;
  uint64_t done = 0;
  using Work = std::shared_ptr<std::pair<Slice, Routed>>;
  tbb::parallel_pipeline(
      tokens, tbb::make_filter<void, Work>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) -> Work {
                std::optional<Slice> slice;
                if (!stop) slice = source.next();
                if (!slice) {
                  control.stop();
                  return nullptr;
                }
                return std::make_shared<std::pair<Slice, Routed>>(*slice, Routed());
              }) & tbb::make_filter<Work, Work>(tbb::filter_mode::parallel, [&](Work work) -> Work {
                work->second = route(flattened_slice(work->first, survey.origin), tree);
                return work;
              }) & tbb::make_filter<Work, void>(tbb::filter_mode::serial_in_order, [&](const Work& work) {
                if (failure) return;
                const Slice& slice = work->first;
                const uint32_t of = survey.class_of(slice.scene->instances[slice.instance].class_name);
                for (const auto& [chunk, piece] : work->second)
                  if (const Status status = writer.add(chunk, piece, of); !status.ok() && !failure)
                    failure = status.error();
                done += work->first.last - work->first.first;
                monitor.progress("partition", done, survey.triangles - survey.moving_triangles);
                if (monitor.cancelled() && !failure) failure = Error{kInterrupted};
                stop = failure.has_value();
              }));
  if (source.error) return *source.error;
  if (failure) return *failure;
  return Done{};
}

}  // namespace

std::vector<std::pair<uint32_t, Mesh>> route(Mesh mesh, const ChunkTree& tree) {
  return Router(std::move(mesh), tree).route();
}

Result<SpillIndex> partition_source(Survey& survey, const ChunkTree& tree, const ImportOptions& options,
                                    const MemoryBudget& budget, const WorkFolder& folder, uint64_t hash,
                                    JobMonitor& monitor) {
  std::optional<SpillIndex> finished = finished_partition(folder, hash, tree.chunks());
  if (!finished) {
    Result<SpillWriter> writer = SpillWriter::create(folder, tree.chunks(), budget.spill_buffers);
    if (!writer.ok()) return writer.error();
    SliceSource source(survey, options, monitor);
    PROMENADE_TRY(spill_slices(source, survey, tree, size_t(budget.jobs) * 2, *writer, monitor));
    Result<SpillIndex> index = writer->finish();
    if (!index.ok()) return index.error();
    PROMENADE_TRY(folder.store(kPartitionUnit, hash, unit_of(*index)));
    finished = std::move(*index);
  }
  for (SurveyedPart& part : survey.parts) part.cached.reset();
  return std::move(*finished);
}

}  // namespace promenade
