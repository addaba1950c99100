#include "preprocess/parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace promenade {

namespace {

constexpr size_t kQuickPoints = 4;  // that the quick estimate asks about

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t place) {
  while (parent[place] != place) place = parent[place] = parent[parent[place]];
  return place;
}

}  // namespace

Parts::Parts(const WorkMesh& work) : tree_(work.positions, work.place) {
  std::vector<uint32_t> parent(work.place_count());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto triangles = static_cast<uint32_t>(work.triangle_count());
  for (uint32_t t = 0; t < triangles; ++t)
    for (uint32_t c = 1; c < 3; ++c) {
      const uint32_t a = root_of(parent, work.place[size_t(t) * 3]);
      const uint32_t b = root_of(parent, work.place[size_t(t) * 3 + c]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<uint32_t> part_of_root(work.place_count(), WorkMesh::kNone);
  part_of_triangle_.resize(triangles);
  for (uint32_t t = 0; t < triangles; ++t) {
    uint32_t& part = part_of_root[root_of(parent, work.place[size_t(t) * 3])];
    if (part == WorkMesh::kNone) {
      part = static_cast<uint32_t>(triangles_.size());
      triangles_.emplace_back();
    }
    part_of_triangle_[t] = part;
    triangles_[part].push_back(t);
  }
  points_.resize(triangles_.size());
  part_of_place_.assign(work.place_count(), WorkMesh::kNone);
  for (uint32_t p = 0; p < work.place_count(); ++p) {
    const uint32_t part = part_of_root[root_of(parent, p)];
    if (part == WorkMesh::kNone) continue;  // a place that no triangle uses
    part_of_place_[p] = part;
    points_[part].push_back(work.positions[p]);
  }
  hidden_.assign(count(), 0);
  remaining_ = count();
}

float Parts::cost_of_points(uint32_t part, size_t stride) {
  if (remaining_ < 2) return std::numeric_limits<float>::infinity();
  hidden_[part] = 1;
  float cost2 = 0;
  uint32_t hint = kNoTriangle;
  for (size_t i = 0; i < points_[part].size(); i += stride) {
    const ClosestPointTree::Nearest found =
        tree_.nearest(points_[part][i], {.hint = hint,
                                         .enough_distance2_m2 = cost2,
                                         .group_of_triangle = part_of_triangle_.data(),
                                         .group_hidden = hidden_.data()});
    cost2 = std::max(cost2, found.distance2_m2);
    hint = found.triangle;
  }
  hidden_[part] = 0;
  return std::sqrt(cost2);
}

float Parts::least_removal_cost(uint32_t part) {
  return cost_of_points(part, std::max<size_t>(1, points_[part].size() / kQuickPoints));
}

float Parts::removal_cost(uint32_t part) { return cost_of_points(part, 1); }

void Parts::remove(uint32_t part) {
  hidden_[part] = 1;
  --remaining_;
  uint32_t hint = kNoTriangle;
  for (const glm::vec3& p : points_[part]) {
    const ClosestPointTree::Nearest found =
        tree_.nearest(p, {.hint = hint, .group_of_triangle = part_of_triangle_.data(), .group_hidden = hidden_.data()});
    hint = found.triangle;
    if (found.triangle != kNoTriangle) points_[part_of_triangle_[found.triangle]].push_back(p);
  }
  points_[part] = {};
}

}  // namespace promenade
