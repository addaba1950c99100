#include "preprocess/split_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <tuple>

#include "preprocess/chunk_tree.h"
#include "preprocess/mesh_piece.h"

namespace promenade {

namespace {

constexpr double kMostMoved = 0.03;  // as in chunk_tree.cpp

struct SplitPlane {
  int axis;
  float value;
};

class Splitter {
 public:
  Splitter(const Mesh& mesh, uint32_t node_triangles, const LevelFactors& factors, float cut_step_m)
      : node_triangles_(node_triangles), factors_(factors), cut_step_m_(cut_step_m) {
    centroids_.reserve(mesh.triangle_count());
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) centroids_.push_back(centroid(mesh, t));
  }

  using Nodes = std::vector<SplitTree::Node>;

  /// A node and what is below it, which are numbered from it on. planned: see LeafShares.
  Nodes split(std::vector<uint32_t> triangles, const Box& cell, uint32_t planned = 0) const {
    Nodes nodes(1);
    nodes.front().cell = cell;
    const LeafShares shares(triangles.size(), node_triangles_, factors_, planned);
    if (shares.leaves == 1) {
      std::sort(triangles.begin(), triangles.end());
      nodes.front().triangles = std::move(triangles);
      return nodes;
    }
    for (Nodes& child : split(std::move(triangles), cell, shares, 0, shares.children)) {
      const auto first = static_cast<uint32_t>(nodes.size());
      nodes.front().children.push_back(first);
      for (SplitTree::Node& node : child) {
        for (uint32_t& below : node.children) below += first;
        nodes.push_back(std::move(node));
      }
    }
    return nodes;
  }

 private:
  /// The children [first, last) of a node, which have these triangles.
  std::vector<Nodes> split(std::vector<uint32_t> triangles, const Box& cell, const LeafShares& shares, uint32_t first,
                           uint32_t last) const {
    std::vector<Nodes> children;
    if (last - first == 1) {
      children.push_back(split(std::move(triangles), cell, shares.leaves_of(first)));
      return children;
    }
    const uint32_t middle = first + (last - first) / 2;
    const size_t rank = triangles.size() * shares.leaves_of(first, middle) / shares.leaves_of(first, last);
    std::vector<uint32_t> below, above;
    const SplitPlane plane = halve(triangles, rank, below, above);
    triangles = {};
    Box below_cell = cell, above_cell = cell;
    below_cell.max[plane.axis] = above_cell.min[plane.axis] = plane.value;
    std::vector<Nodes> rest;
    tbb::parallel_invoke([&] { children = split(std::move(below), below_cell, shares, first, middle); },
                         [&] { rest = split(std::move(above), above_cell, shares, middle, last); });
    std::move(rest.begin(), rest.end(), std::back_inserter(children));
    return children;
  }

  SplitPlane halve(std::vector<uint32_t>& triangles, size_t rank, std::vector<uint32_t>& below,
                   std::vector<uint32_t>& above) const {
    Box box;
    for (const uint32_t t : triangles) box.add(centroids_[t]);
    const int axis = box.longest_axis();
    // The index decides where places coincide: the two halves are never empty.
    const auto less = [&](uint32_t a, uint32_t b) {
      return std::tie(centroids_[a][axis], a) < std::tie(centroids_[b][axis], b);
    };
    const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(triangles.begin(), middle, triangles.end(), less);
    SplitPlane plane{axis, on_lattice(centroids_[*middle][axis], cut_step_m_)};
    const auto is_below = [&](uint32_t t) { return centroids_[t][axis] < plane.value; };
    const auto at = static_cast<size_t>(std::count_if(triangles.begin(), triangles.end(), is_below));
    const size_t moved = std::max(at, rank) - std::min(at, rank);
    if (at == 0 || at == triangles.size() || double(moved) > kMostMoved * double(triangles.size())) {
      plane.value = centroids_[*middle][axis];
      below.assign(triangles.begin(), middle);
      above.assign(middle, triangles.end());
      return plane;
    }
    for (const uint32_t t : triangles) (is_below(t) ? below : above).push_back(t);
    return plane;
  }

  uint32_t node_triangles_;
  const LevelFactors& factors_;
  float cut_step_m_;
  std::vector<glm::vec3> centroids_;
};

}  // namespace

SplitTree split_chunk(const Mesh& mesh, const Box& cell, uint32_t node_triangles, const LevelFactors& factors,
                      float cut_step_m) {
  std::vector<uint32_t> all(mesh.triangle_count());
  std::iota(all.begin(), all.end(), 0U);
  return {Splitter(mesh, node_triangles, factors, cut_step_m).split(std::move(all), cell)};
}

}  // namespace promenade
