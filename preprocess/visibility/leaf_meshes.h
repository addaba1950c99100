#pragma once
// All leaves of a model that stand still, several at once.

#include <tbb/parallel_for.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/survey.h"

namespace promenade {

/// Of what stands still.
inline std::vector<NodeId> leaves_of(const Model& model) {
  std::vector<NodeId> leaves;
  leaves.reserve(model.tables.nodes.size());
  for (uint32_t i = 0; i < model.first_moving_node(); ++i)
    if (model.tables.nodes[i].child_count == 0) leaves.push_back(NodeId{i});
  return leaves;
}

/// Reads the leaves' meshes and calls visit(i, mesh) for leaves[i], on the threads of the arena, in no order. Errors:
/// reading the model, "interrupted".
template <class Visit>
Status for_each_mesh(const ModelReader& reader, std::span<const NodeId> leaves, const JobMonitor& monitor,
                     const Visit& visit) {
  std::mutex mutex;
  std::optional<Error> failure;
  std::atomic<bool> stop = false;
  tbb::parallel_for(size_t(0), leaves.size(), [&](size_t i) {
    if (stop || monitor.cancelled()) return;
    const Result<Mesh> mesh = reader.read_mesh(leaves[i]);
    if (mesh) return visit(i, *mesh);
    const std::lock_guard lock(mutex);
    if (!failure) failure = mesh.error();
    stop = true;
  });
  if (failure) return *failure;
  if (monitor.cancelled()) return Error{kInterrupted};
  return Done{};
}

/// The same for those leaves alone whose boxes overlap one, one after the other, in their order: visit(mesh).
template <class Visit>
Status for_each_mesh_near(const ModelReader& reader, const Box& around, const JobMonitor& monitor, const Visit& visit) {
  const Model& model = reader.model();
  for (uint32_t i = 0; i < model.first_moving_node(); ++i) {
    if (model.tables.nodes[i].child_count != 0 || !model.tables.nodes[i].box.overlaps(around)) continue;
    if (monitor.cancelled()) return Error{kInterrupted};
    const Result<Mesh> mesh = reader.read_mesh(NodeId{i});
    if (!mesh) return mesh.error();
    visit(*mesh);
  }
  return Done{};
}

}  // namespace promenade
