#include "cli/verify_points.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>

#include "geometry/closest_point.h"
#include "geometry/random.h"

namespace promenade {
namespace {

constexpr double kRounding = 1 + 1e-5;  // of distances between points in single precision
constexpr double kRoundingM = 1e-6;

/// Points spread over a mesh by area.
class PointsOn {
 public:
  PointsOn(const Mesh& mesh, const Random& random) : mesh_(mesh), random_(random) {
    area_until_.reserve(mesh.triangle_count());
    double area = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
      area_until_.push_back(area += double(glm::length(triangle_cross(mesh, t))));
  }
  /// False where there is no area.
  bool next(glm::vec3& point) {
    if (area_until_.empty() || !(area_until_.back() > 0)) return false;
    const double at = area_until_.back() * random_.unit();
    const auto found = std::upper_bound(area_until_.begin(), area_until_.end(), at) - area_until_.begin();
    const size_t t = std::min(static_cast<size_t>(found), area_until_.size() - 1);
    const auto corner = [&](size_t c) { return mesh_.positions[mesh_.indices[3 * t + c]]; };
    const auto r = static_cast<float>(std::sqrt(random_.unit())), w = static_cast<float>(random_.unit());
    point = corner(0) + r * (1 - w) * (corner(1) - corner(0)) + r * w * (corner(2) - corner(0));
    return true;
  }

 private:
  const Mesh& mesh_;
  Random random_;
  std::vector<double> area_until_;
};

/// Everything that does not move, in model space; positions and triangles.
Result<Mesh> read_surface(const VerifyPointsOptions& options, const ModelManifest& manifest, JobMonitor& monitor) {
  const Result<std::vector<SourcePart>> parts = list_source(options.sources);
  if (!parts) return parts.error();
  Mesh surface;
  uint64_t triangles = 0;
  for (size_t i = 0; i < parts->size(); ++i) {
    monitor.progress("read the source", i, parts->size());
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<Scene> scene = import_part((*parts)[i], options.import, monitor);
    if (!scene) return scene.error();
    for (const SceneInstance& instance : scene->instances) {
      triangles += scene->meshes[instance.mesh].triangle_count();
      if (instance.joint != kNoJoint) continue;
      const Mesh placed = flattened(*scene, instance, manifest.origin);
      const auto first = static_cast<uint32_t>(surface.positions.size());
      surface.positions.insert(surface.positions.end(), placed.positions.begin(), placed.positions.end());
      surface.indices.reserve(surface.indices.size() + placed.indices.size());
      for (const uint32_t v : placed.indices) surface.indices.push_back(first + v);
    }
  }
  monitor.progress("read the source", parts->size(), parts->size());
  if (triangles != manifest.source_triangles)
    return Error{fmt::format("{} has {} triangles, this model's source had {}: not the same, or read otherwise",
                             options.sources.front().string(), triangles, manifest.source_triangles)};
  return surface;
}

/// All leaves' triangles, and whose they are.
struct Leaves {
  std::vector<uint32_t> node_of_triangle;
  std::optional<ClosestPointTree> tree;
};

Result<Leaves> read_leaves(const ModelReader& reader) {
  Leaves leaves;
  const Model& model = reader.model();
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < model.first_moving_node(); ++i) {
    if (model.tables.nodes[i].child_count > 0) continue;
    const Result<Mesh> mesh = reader.read_mesh(NodeId{i});
    if (!mesh) return mesh.error();
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), mesh->positions.begin(), mesh->positions.end());
    indices.reserve(indices.size() + mesh->indices.size());
    for (const uint32_t v : mesh->indices) indices.push_back(first + v);
    leaves.node_of_triangle.resize(leaves.node_of_triangle.size() + mesh->triangle_count(), i);
  }
  leaves.tree.emplace(positions, indices);
  return leaves;
}

bool is_within(double distance, double bound_m) { return distance <= bound_m * kRounding + kRoundingM; }

double distance_m(const ClosestPointTree& tree, const glm::vec3& p) {
  return std::sqrt(double(tree.nearest(p).distance2_m2));
}

/// A point of the source that belongs to a node.
struct SourcePoint {
  glm::vec3 at;
  double leaf_off_m;  ///< how far the leaf's surface is from it
  /// At most so far from it is what the leaf stands for: where leaves touch, the nearest may be another's.
  double source_off_m;
};

class PointCheck {
 public:
  PointCheck(const ModelReader& reader, const Mesh& source, Leaves leaves)
      : reader_(reader),
        model_(reader.model()),
        source_(source),
        source_tree_(source),
        leaves_(std::move(leaves)),
        points_of_(model_.first_moving_node()),
        largest_m_(model_.first_moving_node(), 0.0) {}

  /// Which nodes each of so many points of the source is held against.
  void spread(uint64_t points, const Random& random) {
    PointsOn on_source(source_, random);
    std::vector<glm::vec3> at;
    glm::vec3 p(0);
    at.reserve(points);
    while (at.size() < points && on_source.next(p)) at.push_back(p);
    std::vector<ClosestPointTree::Nearest> nearest(at.size());
    tbb::parallel_for(size_t(0), at.size(), [&](size_t i) { nearest[i] = leaves_.tree->nearest(at[i]); });
    for (size_t i = 0; i < at.size(); ++i)
      if (nearest[i].triangle != kNoTriangle) put(at[i], leaf_of(at[i], nearest[i]));
    points_on_source = at.size();
    leaves_ = {};
  }

  /// Asks a node, from its points and those of the nodes below.
  Status check(NodeId id, uint64_t points, const Random& random) {
    const Result<Mesh> mesh = reader_.read_mesh(id);
    if (!mesh) return mesh.error();
    const double bound_m = error_m(index_of(id));
    const bool is_leaf = model_.tables.nodes[index_of(id)].child_count == 0;
    PointsOn on_node(*mesh, random);
    uint64_t asked = 0, beyond = 0, of_source_beyond = 0;
    double largest = 0, farthest = 0;
    const auto note = [&](double distance) {
      largest = std::max(largest, distance);
      if (is_within(distance, bound_m)) return;
      ++beyond, farthest = std::max(farthest, distance - bound_m);
    };
    glm::vec3 p(0);
    for (; asked < points && on_node.next(p); ++asked) note(distance_m(source_tree_, p));
    std::swap(beyond, of_source_beyond);
    const ClosestPointTree tree(*mesh);
    each_point_below(id, [&](const SourcePoint& point) {
      note(is_leaf ? point.leaf_off_m : std::max(0.0, distance_m(tree, point.at) - point.source_off_m));
    });
    std::swap(beyond, of_source_beyond);
    const std::scoped_lock lock(mutex_);
    points_on_nodes += asked, node_points_beyond += beyond, source_points_beyond += of_source_beyond;
    farthest_beyond_m = std::max(farthest_beyond_m, farthest);
    largest_m_[index_of(id)] = largest;
    return Done{};
  }

  /// Bound over the largest distance found, of each inner node where any was; those that differ from their only child
  /// by smaller pictures alone are no nearer or farther than that.
  std::vector<double> ratios() const {
    std::vector<double> ratios;
    for (uint32_t i = 0; i < largest_m_.size(); ++i)
      if (has_own_surface(model_.tables.nodes[i]) && largest_m_[i] > 0) ratios.push_back(error_m(i) / largest_m_[i]);
    return ratios;
  }

  uint64_t points_on_source = 0, points_on_nodes = 0, source_points_beyond = 0, node_points_beyond = 0;
  double farthest_beyond_m = 0;

 private:
  bool has_own_surface(const NodeRecord& node) const {
    if (node.child_count != 1) return node.child_count > 0;
    return node.triangles != model_.tables.nodes[index_of(model_.tables.children[node.first_child])].triangles;
  }

  /// A leaf, and how far it is from a point.
  struct NearLeaf {
    uint32_t node;
    double off_m;
  };

  /// The nearest, unless it is farther than it may be and another is not: leaves that touch have errors of their own.
  NearLeaf leaf_of(const glm::vec3& p, ClosestPointTree::Nearest nearest) const {
    constexpr int kMostLeaves = 8;
    const NearLeaf first = near_leaf(nearest);
    if (may_hold(first)) return first;
    std::vector<uint8_t> hidden(model_.tables.nodes.size(), 0);
    ClosestPointTree::Limits limits;
    limits.group_of_triangle = leaves_.node_of_triangle.data(), limits.group_hidden = hidden.data();
    for (int i = 1; i < kMostLeaves; ++i) {
      hidden[near_leaf(nearest).node] = 1;
      nearest = leaves_.tree->nearest(p, limits);
      if (nearest.triangle == kNoTriangle) break;
      if (const NearLeaf next = near_leaf(nearest); may_hold(next)) return next;
    }
    return first;
  }
  NearLeaf near_leaf(const ClosestPointTree::Nearest& nearest) const {
    return {leaves_.node_of_triangle[nearest.triangle], std::sqrt(double(nearest.distance2_m2))};
  }
  double error_m(uint32_t node) const { return double(model_.tables.nodes[node].error_m); }
  bool may_hold(const NearLeaf& leaf) const { return is_within(leaf.off_m, error_m(leaf.node)); }

  void put(const glm::vec3& point, const NearLeaf& leaf) {
    points_of_[leaf.node].push_back({point, leaf.off_m, leaf.off_m + error_m(leaf.node)});
  }

  template <class Visit>
  void each_point_below(NodeId id, const Visit& visit) const {
    for (const SourcePoint& point : points_of_[index_of(id)]) visit(point);
    for (const NodeId child : model_.children_of(id)) each_point_below(child, visit);
  }

  const ModelReader& reader_;
  const Model& model_;
  const Mesh& source_;
  const ClosestPointTree source_tree_;
  Leaves leaves_;
  std::vector<std::vector<SourcePoint>> points_of_;  ///< by leaf
  std::vector<double> largest_m_;                    ///< by node
  std::mutex mutex_;                                 ///< guards the sums
};

double median(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace

Status verify_points(const VerifyPointsOptions& options, const ModelReader& reader, JobMonitor& monitor,
                     Json& figures) {
  const Result<Mesh> source = read_surface(options, reader.model().manifest, monitor);
  if (!source) return source.error();
  Result<Leaves> leaves = read_leaves(reader);
  if (!leaves) return leaves.error();
  const uint32_t nodes = reader.model().first_moving_node();
  if (nodes == 0 || source->indices.empty()) return Error{"nothing in this model stands still: no point to ask"};
  PointCheck check(reader, *source, std::move(*leaves));
  const Random random(options.seed);
  check.spread(options.points / 2, random.fork(nodes));
  const uint64_t each = (options.points - options.points / 2 + nodes - 1) / nodes;
  constexpr uint32_t kAtOnce = 64;  // between two looks at the clock
  for (uint32_t first = 0; first < nodes; first += kAtOnce) {
    monitor.progress("ask points", first, nodes);
    if (monitor.cancelled()) return Error{"interrupted"};
    const uint32_t count = std::min(kAtOnce, nodes - first);
    std::vector<Status> done(count, Done{});
    tbb::parallel_for(uint32_t(0), count,
                      [&](uint32_t i) { done[i] = check.check(NodeId{first + i}, each, random.fork(first + i)); });
    for (const Status& status : done) PROMENADE_TRY(status);
  }
  monitor.progress("ask points", nodes, nodes);
  const double ratio = median(check.ratios());
  figures["points_on_source"] = check.points_on_source, figures["points_on_nodes"] = check.points_on_nodes;
  figures["source_points_beyond_bound"] = check.source_points_beyond;
  figures["node_points_beyond_bound"] = check.node_points_beyond;
  figures["farthest_beyond_bound_m"] = check.farthest_beyond_m;
  figures["bound_over_distance_median"] = ratio;
  fmt::print(
      "{} points of the source, {} of nodes: {} and {} farther from the other surface than the node's bound says",
      check.points_on_source, check.points_on_nodes, check.source_points_beyond, check.node_points_beyond);
  if (check.source_points_beyond + check.node_points_beyond > 0)
    fmt::print(" (by {:.3g} m at most)", check.farthest_beyond_m);
  fmt::print("\n  bound over the largest distance found, median of inner nodes: {:.2f}\n", ratio);
  return Done{};
}

}  // namespace promenade
