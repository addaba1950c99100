#include "preprocess/tree_units.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <optional>

#include "preprocess/mesh_piece.h"
#include "preprocess/split_tree.h"
#include "preprocess/survey.h"

namespace promenade {

namespace {

/// Progress in triangles that leaves hold, and what stops a build.
class Progress {
 public:
  Progress(uint64_t total, JobMonitor& monitor) : total_(total), monitor_(monitor) {}
  void add(uint64_t triangles) { monitor_.progress("simplify", std::min(done_ += triangles, total_), total_); }
  bool stopped() const { return monitor_.cancelled() || failed_; }
  void fail() { failed_ = true; }

 private:
  uint64_t total_;
  std::atomic<uint64_t> done_ = 0;
  std::atomic<bool> failed_ = false;
  JobMonitor& monitor_;
};

/// Builds children's surfaces at once and returns the first error or all of them.
Result<std::vector<NodeSurface>> build_children(size_t count, const std::function<Result<NodeSurface>(size_t)>& build) {
  std::vector<std::optional<Result<NodeSurface>>> built(count);
  tbb::parallel_for(
      size_t(0), count, [&](size_t i) { built[i] = build(i); }, tbb::simple_partitioner());
  std::vector<NodeSurface> surfaces;
  for (std::optional<Result<NodeSurface>>& child : built) {
    if (!child->ok()) return child->error();
    surfaces.push_back(std::move(**child));
  }
  return surfaces;
}

/// Areas by class of some triangles of a mesh.
class ClassAreas {
 public:
  /// No names: nothing is kept.
  ClassAreas(const std::vector<ClassRun>& runs, bool named) {
    if (!named) return;
    uint64_t end = 0;
    for (const ClassRun& run : runs) ends_.emplace_back(end += run.triangles, run.class_index);
  }
  std::vector<ClassArea> of(const Mesh& mesh, const std::vector<uint32_t>& triangles) const {
    std::map<uint32_t, double> areas;
    if (!ends_.empty())
      for (const uint32_t t : triangles) {
        const auto run = std::upper_bound(ends_.begin(), ends_.end(), std::pair<uint64_t, uint32_t>(t, kLast));
        if (run != ends_.end()) areas[run->second] += double(glm::length(triangle_cross(mesh, t))) / 2;
      }
    std::vector<ClassArea> out;
    out.reserve(areas.size());
    for (const auto& [class_index, area] : areas) out.push_back({class_index, static_cast<float>(area)});
    return out;
  }

 private:
  static constexpr uint32_t kLast = 0xffffffffU;
  std::vector<std::pair<uint64_t, uint32_t>> ends_;  ///< where a run ends, and its class
};

/// One chunk's nodes, bottom up. Nodes are built by several threads, each into its own slot.
class ChunkWork {
 public:
  ChunkWork(Mesh mesh, const std::vector<ClassRun>& classes, const Box& cell, float cut_step_m,
            const NodeBuilder& builder, const TreeOptions& options, Progress& progress)
      : mesh_(std::move(mesh)),
        classes_(classes, options.named_classes),
        split_(split_chunk(mesh_, cell, options.node_triangles, options.level_factors, cut_step_m)),
        nodes_(split_.nodes.size()),
        builder_(builder),
        progress_(progress) {
    find_borders_of_leaves(cell, cut_step_m);
  }

  Result<NodeUnit> run(const WorkFolder& folder, const std::string& name, uint64_t hash) {
    Result<NodeSurface> root = build(0);
    if (!root.ok()) return root.error();
    std::vector<std::vector<uint32_t>> children;
    for (SplitTree::Node& node : split_.nodes) children.push_back(std::move(node.children));
    mesh_ = {};
    return store_node_unit(folder, name, hash, nodes_, children, *root);
  }

 private:
  void find_borders_of_leaves(const Box& cell, float cut_step_m) {
    std::vector<size_t> leaves;
    std::vector<std::span<const uint32_t>> triangles;
    for (size_t i = 0; i < split_.nodes.size(); ++i) {
      if (!split_.nodes[i].children.empty()) continue;
      leaves.push_back(i), triangles.emplace_back(split_.nodes[i].triangles);
    }
    std::vector<Border> borders = find_borders(mesh_, triangles, cell, cut_step_m);
    borders_.resize(split_.nodes.size());
    for (size_t i = 0; i < leaves.size(); ++i) borders_[leaves[i]] = std::move(borders[i]);
  }

  Result<NodeSurface> build(uint32_t index) {
    if (progress_.stopped()) return Error{kInterrupted};
    const SplitTree::Node& node = split_.nodes[index];
    Result<BuiltNode> built = node.children.empty()
                                  ? builder_.leaf(piece_of(mesh_, node.triangles), std::move(borders_[index]))
                                  : inner(node);
    if (!built.ok()) return built.error();
    if (node.children.empty()) progress_.add(node.triangles.size());
    if (node.children.empty()) built->stored.classes = classes_.of(mesh_, node.triangles);
    nodes_[index] = std::move(built->stored);
    return std::move(built->surface);
  }

  Result<BuiltNode> inner(const SplitTree::Node& node) {
    const Result<std::vector<NodeSurface>> children =
        build_children(node.children.size(), [&](size_t i) { return build(node.children[i]); });
    if (!children.ok()) return children.error();
    return builder_.inner(*children);
  }

  Mesh mesh_;
  ClassAreas classes_;
  SplitTree split_;
  std::vector<Border> borders_;  ///< of leaves, by node
  std::vector<StoredNode> nodes_;
  const NodeBuilder& builder_;
  Progress& progress_;
};

/// The nodes above the chunks.
class TopWork {
 public:
  TopWork(const ChunkTree& tree, const std::vector<NodeUnit>& chunks, const NodeBuilder& builder,
          const WorkFolder& folder, Progress& progress)
      : tree_(tree), chunks_(chunks), builder_(builder), folder_(folder), progress_(progress) {}

  Result<NodeUnit> run(const std::string& name, uint64_t hash) {
    plan(tree_.root);
    nodes_.resize(children_.size());
    Result<NodeSurface> root = build(0);
    if (!root.ok()) return root.error();
    return store_node_unit(folder_, name, hash, nodes_, children_, *root);
  }

 private:
  /// Gives every branch that shows something its number; returns what its parent has for a child: nothing when no
  /// chunk below has triangles, the only child of a branch in the branch's place.
  std::optional<uint32_t> plan(uint32_t ref) {
    if ((ref & ChunkTree::kChunk) != 0) {
      const uint32_t chunk = ref & ~ChunkTree::kChunk;
      if (chunks_[chunk].nodes.empty()) return std::nullopt;
      return NodeUnit::kOtherUnit | chunk;
    }
    const auto index = static_cast<uint32_t>(children_.size());
    children_.emplace_back();
    std::vector<uint32_t> children;
    for (const uint32_t child : tree_.branches[ref].children)
      if (const std::optional<uint32_t> planned = plan(child)) children.push_back(*planned);
    if (children.size() < 2 && index != 0 && index + 1 == children_.size()) {
      children_.pop_back();
      return children.empty() ? std::nullopt : std::optional(children.front());
    }
    children_[index] = std::move(children);
    return index;
  }

  Result<NodeSurface> build(uint32_t ref) {
    if (progress_.stopped()) return Error{kInterrupted};
    if ((ref & NodeUnit::kOtherUnit) != 0) return read_root_surface(folder_, chunks_[ref & ~NodeUnit::kOtherUnit]);
    const Result<std::vector<NodeSurface>> children =
        build_children(children_[ref].size(), [&](size_t i) { return build(children_[ref][i]); });
    if (!children.ok()) return children.error();
    Result<BuiltNode> built = builder_.inner(*children);
    if (!built.ok()) return built.error();
    nodes_[ref] = std::move(built->stored);
    return std::move(built->surface);
  }

  const ChunkTree& tree_;
  const std::vector<NodeUnit>& chunks_;
  const NodeBuilder& builder_;
  const WorkFolder& folder_;
  Progress& progress_;
  std::vector<std::vector<uint32_t>> children_;
  std::vector<StoredNode> nodes_;
};

/// All chunks, some at a time.
class ChunkQueue {
 public:
  ChunkQueue(const SpillIndex& spill, const ChunkTree& tree, const NodeBuilder& builder, const TreeOptions& options,
             const WorkFolder& folder, Progress& progress)
      : spill_(spill),
        tree_(tree),
        builder_(builder),
        options_(options),
        folder_(folder),
        progress_(progress),
        units(tree.chunks()) {}

  Status run(const RandomAccessFile& file, uint32_t slots) {
    tbb::task_group group;
    for (uint32_t slot = 0; slot < slots; ++slot)
      group.run([&] {
        for (uint32_t chunk = next_++; chunk < units.size() && !progress_.stopped(); chunk = next_++)
          // Isolated: a thread that waits for one chunk's nodes must not begin another chunk.
          tbb::this_task_arena::isolate([&] { work(file, chunk); });
      });
    group.wait();
    const std::lock_guard lock(mutex_);
    if (failure_) return *failure_;
    return Done{};
  }

 private:
  void work(const RandomAccessFile& file, uint32_t chunk) {
    const ChunkSpill& spill = spill_.chunks[chunk];
    const std::string name = fmt::format("chunk-{:06}", chunk);
    if (spill.triangles == 0) return;
    if (std::optional<NodeUnit> known = load_node_unit(folder_, name, options_.hash)) {
      units[chunk] = std::move(*known);
      ++resumed;
      return progress_.add(spill.triangles);
    }
    Result<Mesh> mesh = read_spill(file, spill);
    if (!mesh.ok()) return fail(mesh.error());
    Result<NodeUnit> unit = ChunkWork(std::move(*mesh), spill.classes, tree_.chunk_cells[chunk], tree_.cut_step_m,
                                      builder_, options_, progress_)
                                .run(folder_, name, options_.hash);
    if (!unit.ok()) return fail(unit.error());
    units[chunk] = std::move(*unit);
  }

  void fail(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!failure_ || failure_->message == kInterrupted) failure_ = error;
    progress_.fail();
  }

  const SpillIndex& spill_;
  const ChunkTree& tree_;
  const NodeBuilder& builder_;
  const TreeOptions& options_;
  const WorkFolder& folder_;
  Progress& progress_;
  std::atomic<uint32_t> next_ = 0;
  std::mutex mutex_;
  std::optional<Error> failure_;  ///< guarded by mutex_

 public:
  std::vector<NodeUnit> units;  ///< each written by the thread that has its chunk
  std::atomic<uint64_t> resumed = 0;
};

}  // namespace

Result<TreeUnits> build_tree(const SpillIndex& spill, const ChunkTree& tree, const NodeBuilder& builder,
                             const TreeOptions& options, const MemoryBudget& budget, const WorkFolder& folder,
                             JobMonitor& monitor) {
  const Result<RandomAccessFile> file = folder.open_unit(kSpillFile);
  if (!file.ok()) return file.error();
  uint64_t triangles = 0;
  for (const ChunkSpill& chunk : spill.chunks) triangles += chunk.triangles;
  Progress progress(triangles, monitor);
  ChunkQueue queue(spill, tree, builder, options, folder, progress);
  PROMENADE_TRY(queue.run(*file, budget.chunk_slots));
  if (monitor.cancelled()) return Error{kInterrupted};
  TreeUnits units;
  units.chunks = std::move(queue.units);
  units.resumed = queue.resumed;
  if ((tree.root & ChunkTree::kChunk) != 0) return units;
  constexpr const char* kTop = "top";
  if (std::optional<NodeUnit> known = load_node_unit(folder, kTop, options.hash)) {
    units.top = std::move(*known);
    ++units.resumed;
    return units;
  }
  Result<NodeUnit> top = TopWork(tree, units.chunks, builder, folder, progress).run(kTop, options.hash);
  if (!top.ok()) return top.error();
  units.top = std::move(*top);
  return units;
}

Result<NodeUnit> build_object(ObjectMesh object, const NodeBuilder& builder, const TreeOptions& options,
                              const WorkFolder& folder, const std::string& name, JobMonitor& monitor) {
  Progress progress(object.mesh.triangle_count(), monitor);
  return ChunkWork(std::move(object.mesh), object.classes, unbounded_cell(), 0, builder, options, progress)
      .run(folder, name, options.hash);
}

}  // namespace promenade
