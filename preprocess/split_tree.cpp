#include "preprocess/split_tree.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "preprocess/chunk_tree.h"
#include "preprocess/triangle_cut.h"

namespace promenade {

namespace {

constexpr double kMostCut = 0.25;  // as in chunk_tree.cpp: bounds the growth by cutting

class Splitter {
 public:
  Splitter(Mesh& mesh, uint32_t node_triangles, uint32_t level_factor)
      : mesh_(mesh), node_triangles_(node_triangles), level_factor_(level_factor) {
    add_centroids();
  }

  uint32_t split(std::vector<uint32_t> triangles, const Box& cell) {
    const auto index = static_cast<uint32_t>(tree.nodes.size());
    tree.nodes.emplace_back().cell = cell;
    const LeafShares shares(triangles.size(), node_triangles_, level_factor_);
    if (shares.leaves == 1) {
      std::sort(triangles.begin(), triangles.end());
      tree.nodes[index].triangles = std::move(triangles);
    } else {
      split(std::move(triangles), cell, shares, 0, shares.children, index);
    }
    return index;
  }

  SplitTree tree;

 private:
  /// Triangles of the children [first, last) of a node.
  void split(std::vector<uint32_t> triangles, const Box& cell, const LeafShares& shares, uint32_t first, uint32_t last,
             uint32_t parent) {
    if (last - first == 1) {
      const uint32_t child = split(std::move(triangles), cell);
      tree.nodes[parent].children.push_back(child);
      return;
    }
    const uint32_t middle = first + (last - first) / 2;
    const size_t rank = triangles.size() * shares.leaves_of(first, middle) / shares.leaves_of(first, last);
    std::vector<uint32_t> below, above;
    const CutPlane plane = halve(triangles, rank, below, above);
    triangles = {};
    Box below_cell = cell, above_cell = cell;
    below_cell.max[plane.axis] = above_cell.min[plane.axis] = plane.value;
    split(std::move(below), below_cell, shares, first, middle, parent);
    split(std::move(above), above_cell, shares, middle, last, parent);
  }

  CutPlane halve(std::vector<uint32_t>& triangles, size_t rank, std::vector<uint32_t>& below,
                 std::vector<uint32_t>& above) {
    Box box;
    for (const uint32_t t : triangles) box.add(centroids_[t]);
    const int axis = box.longest_axis();
    // The index decides where places coincide: the two halves are never empty.
    const auto less = [&](uint32_t a, uint32_t b) {
      return std::tie(centroids_[a][axis], a) < std::tie(centroids_[b][axis], b);
    };
    const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(triangles.begin(), middle, triangles.end(), less);
    const CutPlane plane{axis, centroids_[*middle][axis],
                         shortest_cut_m(double(box.diagonal()), triangles.size(), node_triangles_)};
    TriangleCutter cutter(mesh_, plane);
    const auto crosses = [&](uint32_t t) { return cutter.crosses(t); };
    const auto cuts = std::count_if(triangles.begin(), triangles.end(), crosses);
    if (cuts == 0 || double(cuts) > kMostCut * double(triangles.size())) {
      below.assign(triangles.begin(), middle);
      above.assign(middle, triangles.end());
      return plane;
    }
    for (size_t i = 0; i < triangles.size(); ++i) {
      if (cutter.crosses(triangles[i]))
        cutter.cut(triangles[i], below, above), moved_.push_back(triangles[i]);
      else
        (i < rank ? below : above).push_back(triangles[i]);
    }
    add_centroids();
    if (below.empty() || above.empty()) balance(below.empty() ? above : below, below.empty() ? below : above);
    return plane;
  }

  /// All pieces fell on one side: half of them change it.
  static void balance(std::vector<uint32_t>& full, std::vector<uint32_t>& empty) {
    const auto half = full.begin() + static_cast<std::ptrdiff_t>(full.size() / 2);
    empty.assign(half, full.end());
    full.erase(half, full.end());
  }

  /// Of new triangles, and of those whose first piece took their place.
  void add_centroids() {
    for (const uint32_t t : moved_) centroids_[t] = centroid(mesh_, t);
    moved_.clear();
    for (size_t t = centroids_.size(); t < mesh_.triangle_count(); ++t)
      centroids_.push_back(centroid(mesh_, static_cast<uint32_t>(t)));
  }

  Mesh& mesh_;
  uint32_t node_triangles_, level_factor_;
  std::vector<glm::vec3> centroids_;
  std::vector<uint32_t> moved_;
};

}  // namespace

SplitTree split_chunk(Mesh& mesh, const Box& cell, uint32_t node_triangles, uint32_t level_factor) {
  std::vector<uint32_t> all(mesh.triangle_count());
  std::iota(all.begin(), all.end(), 0U);
  Splitter splitter(mesh, node_triangles, level_factor);
  splitter.split(std::move(all), cell);
  return std::move(splitter.tree);
}

}  // namespace promenade
