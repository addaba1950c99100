#include "runtime/surroundings.h"

#include <algorithm>
#include <condition_variable>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace promenade {
namespace {

constexpr float kAsideM = 10, kAboveM = 6, kBelowM = 50;
constexpr double kAgainM = 3;                  // the eye has gone this far: read again
constexpr uint64_t kBytesATriangle = 2 * 180;  // of a tree and what it is made from, two of them

struct NearLeaf {
  float distance_m = 0;
  NodeId id = kNoNode;
};

/// Leaves with something in the box, the nearest to the eye first.
std::vector<NearLeaf> leaves_in(const Model& model, const Box& box, const glm::vec3& eye) {
  std::vector<NearLeaf> leaves;
  std::vector<NodeId> open = model.tables.roots;  // of what stands still: who walks lets what moves pass through
  open.resize(open.size() - model.objects.moving.size());
  while (!open.empty()) {
    const NodeId id = open.back();
    open.pop_back();
    const NodeRecord& node = model.tables.nodes[index_of(id)];
    if (!node.box.overlaps(box)) continue;
    if (node.child_count == 0) leaves.push_back({node.box.distance(eye), id});
    for (const NodeId child : model.children_of(id)) open.push_back(child);
  }
  std::sort(leaves.begin(), leaves.end(), [](const NearLeaf& a, const NearLeaf& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : index_of(a.id) < index_of(b.id);
  });
  return leaves;
}

Result<Mesh> read_leaf(const ModelSource& source, NodeId id) {
  const uint32_t segment = source.model().tables.nodes[index_of(id)].segment;
  std::vector<std::byte> stored(source.model().tables.segments[segment].stored_bytes);
  PROMENADE_TRY(source.read_piece(segment, 0, stored));
  return source.decode_mesh(id, stored);
}

/// The triangles with something in the box, until there are too many.
ClosestPointTree read_surface(const ModelSource& source, const glm::vec3& eye, uint64_t most_triangles) {
  const Box box{eye - glm::vec3(kAsideM, kAsideM, kBelowM), eye + glm::vec3(kAsideM, kAsideM, kAboveM)};
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;
  for (const NearLeaf& leaf : leaves_in(source.model(), box, eye)) {
    const Result<Mesh> mesh = read_leaf(source, leaf.id);
    if (!mesh) continue;  // the loader has met it, too, and says so
    for (size_t t = 0; t < mesh->triangle_count(); ++t) {
      Box triangle;
      for (size_t c = 0; c < 3; ++c) triangle.add(mesh->positions[mesh->indices[3 * t + c]]);
      if (!triangle.overlaps(box)) continue;
      if (indices.size() / 3 >= most_triangles) return ClosestPointTree(positions, indices);
      for (size_t c = 0; c < 3; ++c) {
        indices.push_back(static_cast<uint32_t>(positions.size()));
        positions.push_back(mesh->positions[mesh->indices[3 * t + c]]);
      }
    }
  }
  return ClosestPointTree(positions, indices);
}

}  // namespace

struct Surroundings::State {
  const ModelSource& source;
  uint64_t most_triangles;
  mutable std::mutex mutex;  // guards everything below
  std::condition_variable wake;
  bool ending = false;
  std::optional<glm::dvec3> wanted;  ///< not read for yet
  std::optional<glm::dvec3> asked;   ///< the last that was wanted
  std::shared_ptr<const ClosestPointTree> surface;
  std::thread thread;  // last: starts when all else is there

  State(const ModelSource& model, uint64_t bytes)
      : source(model), most_triangles(bytes / kBytesATriangle), thread([this] { run(); }) {}

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [this] { return ending || wanted; });
      if (ending) return;
      const glm::dvec3 eye = *wanted;
      lock.unlock();
      auto made = std::make_shared<const ClosestPointTree>(read_surface(source, glm::vec3(eye), most_triangles));
      lock.lock();
      surface = std::move(made);
      if (wanted == eye) wanted.reset();
    }
  }
};

Surroundings::Surroundings(const ModelSource& source, uint64_t bytes) : state_(new State(source, bytes)) {}

Surroundings::~Surroundings() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->wake.notify_one();
  state_->thread.join();
}

void Surroundings::move_to(const glm::dvec3& eye) {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->asked && glm::distance(*state_->asked, eye) < kAgainM) return;
    state_->wanted = state_->asked = eye;
  }
  state_->wake.notify_one();
}

std::shared_ptr<const ClosestPointTree> Surroundings::surface() const {
  const std::lock_guard lock(state_->mutex);
  return state_->surface;
}

bool Surroundings::up_to_date() const {
  const std::lock_guard lock(state_->mutex);
  return state_->surface != nullptr && !state_->wanted;
}

}  // namespace promenade
