#include "preprocess/parts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace promenade {

namespace {

/// Points looked from, spread over a part, when it has turned out too dear: the better its cost is known the less often
/// it is asked for.
constexpr size_t kMoreLooks = 8;

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t place) {
  while (parent[place] != place) place = parent[place] = parent[parent[place]];
  return place;
}

}  // namespace

Parts::Parts(const WorkMesh& work, const std::function<std::vector<glm::vec3>(uint32_t triangle)>& offsets_of)
    : positions_(work.positions),
      indices_(work.place),
      tree_(std::span<const glm::vec3>{}, std::span<const uint32_t>{}) {
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
  for (uint32_t t = 0; t < triangles; ++t) {
    uint32_t& part = part_of_root[root_of(parent, work.place[size_t(t) * 3])];
    if (part == WorkMesh::kNone) {
      part = static_cast<uint32_t>(triangles_.size());
      triangles_.emplace_back();
    }
    triangles_[part].push_back(t);
  }
  part_of_place_.assign(work.place_count(), WorkMesh::kNone);
  for (uint32_t p = 0; p < work.place_count(); ++p) part_of_place_[p] = part_of_root[root_of(parent, p)];
  copies_.reserve(originals());
  for (uint32_t part = 0; part < originals(); ++part) copies_.push_back({part, glm::vec3(0)});
  for (uint32_t part = 0; part < originals(); ++part) {
    first_copy_.push_back(count());
    if (!offsets_of) continue;
    for (const glm::vec3& offset : offsets_of(triangles_[part].front())) copies_.push_back({part, offset});
  }
  first_copy_.push_back(count());
  hidden_.assign(count(), 0);
  looked_at_.assign(count(), 0);
  farthest_.assign(count(), glm::vec3(0));
  for (uint32_t part = 0; part < count(); ++part) {
    hidden_[part] = work.alive[this->triangles(part).front()] == 0 ? 1 : 0;
    remaining_ += hidden_[part] == 0 ? 1U : 0U;
  }
  build_tree();
}

void Parts::build_tree() {
  if (remaining_ < (remaining_ == count() ? 2 : 1)) return;  // nothing will be asked
  std::vector<glm::vec3> positions = positions_;
  std::vector<uint32_t> indices;
  tree_triangles_.clear();
  part_of_tree_triangle_.clear();
  hidden_in_tree_ = 0;
  for (uint32_t part = 0; part < count(); ++part) {
    if (hidden_[part] != 0) continue;
    for (const uint32_t t : triangles(part)) {
      tree_triangles_.push_back(t);
      part_of_tree_triangle_.push_back(part);
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t place = indices_[size_t(t) * 3 + c];
        indices.push_back(part < originals() ? place : static_cast<uint32_t>(positions.size()));
        if (part >= originals()) positions.push_back(positions_[place] + offset(part));
      }
    }
  }
  tree_ = ClosestPointTree(positions, indices);
}

float Parts::first_look(uint32_t part, float limit_m) {
  looked_at_[part] = 1;
  farthest_[part] = positions_[indices_[size_t(triangles(part).front()) * 3]] + offset(part);
  const uint8_t hidden_before = hidden_[part];
  hidden_[part] = 1;
  const float distance2 = tree_
                              .nearest(farthest_[part], {.enough_distance2_m2 = limit_m * limit_m,
                                                         .group_of_triangle = part_of_tree_triangle_.data(),
                                                         .group_hidden = hidden_.data()})
                              .distance2_m2;
  hidden_[part] = hidden_before;
  return std::sqrt(distance2);
}

float Parts::removal_cost(uint32_t part, const std::vector<glm::vec3>& points, float limit_m,
                          std::vector<Beside>& beside) {
  beside.clear();
  const uint8_t hidden_before = hidden_[part];
  if (remaining_ < (hidden_before != 0 ? 1 : 2)) return std::numeric_limits<float>::infinity();
  const float limit2 = limit_m * limit_m;
  float cost2 = 0;
  uint32_t hint = kNoTriangle;
  const auto look_from = [&](const glm::vec3& p) {
    const ClosestPointTree::Nearest found = tree_.nearest(p, {.hint = hint,
                                                              .enough_distance2_m2 = std::max(limit2, cost2),
                                                              .group_of_triangle = part_of_tree_triangle_.data(),
                                                              .group_hidden = hidden_.data()});
    hint = found.triangle;
    if (found.distance2_m2 > cost2) cost2 = found.distance2_m2, farthest_[part] = p;
  };
  hidden_[part] = 1;
  look_from(farthest_[part]);
  for (size_t i = 0; i < points.size() && cost2 <= limit2; ++i) {
    look_from(points[i]);
    beside.push_back({corner_of(hint, points[i]), part_of_tree_triangle_[hint], hint});
  }
  if (cost2 > limit2)
    for (size_t i = 0; i < points.size(); i += points.size() / kMoreLooks + 1) look_from(points[i]);
  hidden_[part] = hidden_before;
  return std::sqrt(cost2);
}

void Parts::remove(uint32_t part) {
  if (hidden_[part] != 0) return;
  hidden_[part] = 1;
  --remaining_;
  hidden_in_tree_ += triangles(part).size();
  if (hidden_in_tree_ * 2 > tree_triangles_.size()) build_tree();
}

uint32_t Parts::corner_of(uint32_t tree_triangle, const glm::vec3& point) const {
  const uint32_t first = tree_triangles_[tree_triangle] * 3;
  const glm::vec3 at = point - offset(part_of_tree_triangle_[tree_triangle]);
  uint32_t nearest = first;
  float least2 = std::numeric_limits<float>::infinity();
  for (uint32_t c = first; c < first + 3; ++c) {
    const glm::vec3 off = positions_[indices_[c]] - at;
    if (const float d2 = glm::dot(off, off); d2 < least2) least2 = d2, nearest = c;
  }
  return nearest;
}

/// A triangle of the tree.
uint32_t Parts::nearest_besides(uint32_t part, const glm::vec3& point, uint32_t hint) {
  const uint8_t hidden_before = hidden_[part];
  hidden_[part] = 1;
  const ClosestPointTree::Nearest found = tree_.nearest(
      point, {.hint = hint, .group_of_triangle = part_of_tree_triangle_.data(), .group_hidden = hidden_.data()});
  hidden_[part] = hidden_before;
  return found.triangle;
}

uint32_t Parts::nearest_corner_besides(uint32_t part, const glm::vec3& point, uint32_t& near) {
  near = nearest_besides(part, point, near);
  return near == kNoTriangle ? WorkMesh::kNone : corner_of(near, point);
}

std::optional<float> Parts::height_besides(uint32_t part, const glm::vec3& point, const glm::vec3& normal) {
  const uint32_t found = nearest_besides(part, point);
  if (found == kNoTriangle) return std::nullopt;
  const size_t first = size_t(tree_triangles_[found]) * 3;
  const auto corner = [&](size_t c) { return positions_[indices_[first + c]]; };
  const glm::vec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const float length = glm::length(cross);
  if (!(length > 0) || glm::dot(cross, normal) <= 0) return std::nullopt;
  return glm::dot(point - offset(part_of_tree_triangle_[found]) - corner(0), cross / length);
}

}  // namespace promenade
