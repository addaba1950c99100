#include "preprocess/chunk_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

namespace promenade {

namespace {

// Steps of the cutting lattice to a leaf's side, taking the triangles for a surface: pieces small enough for tight
// boxes.
constexpr double kStepsOfLeaf = 4;
// Cutting may add this share of triangles; coarser lattices are taken until it does not.
constexpr double kMostAdded = 0.1;
// How far a plane may move to lie on the lattice, as a share of the triangles on it.
constexpr double kMostMoved = 0.03;

class Divider {
 public:
  Divider(const ChunkTreeOptions& options, double triangles_per_sample)
      : options_(options),
        factors_(options.level_factors.above(double(options.chunk_triangles) / options.node_triangles)),
        triangles_per_sample_(triangles_per_sample) {}

  struct Refs {
    uint32_t node, plane;
  };

  Refs divide(std::span<TriangleSample> samples, const Box& cell) {
    const auto triangles = static_cast<uint64_t>(double(samples.size()) * triangles_per_sample_);
    if (triangles <= options_.chunk_triangles || samples.size() < 2) {
      const uint32_t chunk = ChunkTree::kChunk | tree.chunks();
      tree.chunk_cells.push_back(cell);
      return {chunk, chunk};
    }
    LeafShares shares(triangles, options_.chunk_triangles, factors_);
    shares.children = static_cast<uint32_t>(std::min<size_t>(shares.children, samples.size()));
    const auto branch = static_cast<uint32_t>(tree.branches.size());
    tree.branches.emplace_back();
    const uint32_t plane = divide(samples, cell, shares, 0, shares.children, branch);
    return {branch, plane};
  }

  ChunkTree tree;

 private:
  /// The planes between the children [first, last) of a branch.
  uint32_t divide(std::span<TriangleSample> samples, const Box& cell, const LeafShares& shares, uint32_t first,
                  uint32_t last, uint32_t branch) {
    if (last - first == 1) {
      const Refs child = divide(samples, cell);
      tree.branches[branch].children.push_back(child.node);
      return child.plane;
    }
    const uint32_t middle = first + (last - first) / 2;
    size_t rank = samples.size() * shares.leaves_of(first, middle) / shares.leaves_of(first, last);
    rank = std::clamp<size_t>(rank, middle - first, samples.size() - (last - middle));
    const auto index = static_cast<uint32_t>(tree.planes.size());
    tree.planes.push_back(plane_at(samples, rank));
    Box below_cell = cell, above_cell = cell;
    if (const ChunkTree::Plane& plane = tree.planes[index]; plane.axis != ChunkTree::kByTurns)
      below_cell.max[plane.axis] = above_cell.min[plane.axis] = plane.value;
    const uint32_t below = divide(samples.first(rank), below_cell, shares, first, middle, branch);
    const uint32_t above = divide(samples.subspan(rank), above_cell, shares, middle, last, branch);
    tree.planes[index].below = below, tree.planes[index].above = above;
    return index;
  }

  /// Orders the samples about the plane and returns it; rank: how many lie below (moved where places coincide).
  ChunkTree::Plane plane_at(std::span<TriangleSample> samples, size_t& rank) const {
    DBox box;
    for (const TriangleSample& s : samples) box.add(s.centroid);
    const int axis = box.longest_axis();
    ChunkTree::Plane plane;
    if (!(box.size()[axis] > 0)) {
      plane.axis = ChunkTree::kByTurns;
      rank = samples.size() / 2;
      return plane;
    }
    const auto less = [axis](const TriangleSample& a, const TriangleSample& b) {
      return std::tie(a.centroid[axis], a.priority) < std::tie(b.centroid[axis], b.priority);
    };
    const auto at_rank = samples.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(samples.begin(), at_rank, samples.end(), less);
    double below = std::max_element(samples.begin(), at_rank, less)->centroid[axis];
    if (!(below < at_rank->centroid[axis])) {  // places coincide
      std::sort(samples.begin(), samples.end(), less);
      rank = between_places(samples, axis, rank);
      below = samples[rank - 1].centroid[axis];
    }
    const double value = (below + samples[rank].centroid[axis]) / 2;
    plane.axis = axis;
    plane.value = static_cast<float>(value - options_.origin[axis]);
    snap(samples, axis, rank, plane);
    return plane;
  }

  /// Moves the plane onto the lattice where that changes its rank by little.
  void snap(std::span<TriangleSample> samples, int axis, size_t& rank, ChunkTree::Plane& plane) const {
    const float value = on_lattice(plane.value, tree.cut_step_m);
    const double world = double(value) + options_.origin[axis];
    const auto is_below = [&](const TriangleSample& s) { return s.centroid[axis] < world; };
    const auto snapped = static_cast<size_t>(std::count_if(samples.begin(), samples.end(), is_below));
    const size_t moved = std::max(snapped, rank) - std::min(snapped, rank);
    if (snapped == 0 || snapped == samples.size() || double(moved) > kMostMoved * double(samples.size())) return;
    std::partition(samples.begin(), samples.end(), is_below);
    rank = snapped, plane.value = value;
  }

  /// The rank nearest to the wanted one at which the coordinate changes: a plane can only pass there.
  static size_t between_places(std::span<const TriangleSample> samples, int axis, size_t wanted) {
    const auto place = [&](size_t i) { return samples[i].centroid[axis]; };
    for (size_t by = 0; by < samples.size(); ++by) {
      if (wanted + by < samples.size() && wanted + by > 0 && place(wanted + by - 1) < place(wanted + by))
        return wanted + by;
      if (wanted > by && place(wanted - by - 1) < place(wanted - by)) return wanted - by;
    }
    return wanted;
  }

  const ChunkTreeOptions& options_;
  LevelFactors factors_;  // above chunks
  double triangles_per_sample_;
};

}  // namespace

Box unbounded_cell() {
  return {glm::vec3(std::numeric_limits<float>::lowest()), glm::vec3(std::numeric_limits<float>::max())};
}

namespace {

/// About an eighth of a leaf, or as coarse as it takes to add few triangles: stacked sheets would multiply without end.
float cut_step_m(const std::vector<TriangleSample>& samples, const ChunkTreeOptions& options) {
  DBox box;
  for (const TriangleSample& s : samples) box.add(s.centroid);
  const double leaves = std::max(1.0, double(options.triangles) / options.node_triangles);
  const double leaf_m =
      box.size().x > 0 || box.size().y > 0 || box.size().z > 0 ? box.diagonal() / std::sqrt(leaves) : 0.0;
  if (!(leaf_m > 0) || !std::isfinite(leaf_m) || leaves < 2) return 0;
  double step = std::exp2(std::ceil(std::log2(leaf_m / kStepsOfLeaf)));
  const auto added = [&] {
    double sum = 0;
    for (const TriangleSample& s : samples)
      if (double(s.edge_m) > step) sum += 2 * double(s.edge_m) / step + 2 * double(s.area_m2) / (step * step);
    return sum / double(samples.size());
  };
  while (added() > kMostAdded) step *= 2;
  return static_cast<float>(step);
}

}  // namespace

ChunkTree divide_into_chunks(std::vector<TriangleSample>& samples, const ChunkTreeOptions& options) {
  Divider divider(options, double(options.triangles) / double(samples.size()));
  divider.tree.cut_step_m = cut_step_m(samples, options);
  const auto [root, plane] = divider.divide(samples, unbounded_cell());
  divider.tree.root = root;
  divider.tree.first_plane = plane;
  return std::move(divider.tree);
}

float on_lattice(float value, float step_m) { return step_m > 0 ? std::round(value / step_m) * step_m : value; }

}  // namespace promenade
