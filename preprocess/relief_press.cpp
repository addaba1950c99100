#include "preprocess/relief_press.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace promenade {

namespace {

/// Of a relief's depth: what is left when it is flat already, and within which places become one.
constexpr float kFlatShare = 0.02F;

void sort_once(std::vector<uint32_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

ReliefPress::ReliefPress(WorkMesh& work, Collapser& collapser, const BorderLines& borders, std::vector<Relief> reliefs,
                         const std::vector<Patch>& patches)
    : work_(work), collapser_(collapser), borders_(borders), reliefs_(std::move(reliefs)) {
  std::vector<std::pair<uint32_t, uint32_t>> copies;  // place, that of its copy
  for (const Patch& patch : patches)
    for (uint32_t i = 0; i < patch.triangles.size(); ++i)
      for (uint32_t c = 0; c < 3; ++c)
        copies.emplace_back(work_.place[patch.triangles[i] * 3 + c], work_.place[(patch.first_copy + i) * 3 + c]);
  std::sort(copies.begin(), copies.end());
  copies.erase(std::unique(copies.begin(), copies.end()), copies.end());
  for (Relief& relief : reliefs_) {
    const size_t own = relief.places.size();
    for (size_t i = 0; i < own; ++i)
      for (auto at = std::lower_bound(copies.begin(), copies.end(), std::pair{relief.places[i], 0U});
           at != copies.end() && at->first == relief.places[i]; ++at)
        relief.places.push_back(at->second);
  }
}

float ReliefPress::press(uint32_t index, float limit_m) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Relief& relief = reliefs_[index];
  gather_places(relief);
  if (is_flat(relief)) return kInfinity;
  gather_points();
  float low_m = kInfinity, high_m = -kInfinity;
  for (const glm::vec3& p : points_) {
    const float off_m = glm::dot(p, relief.normal);
    low_m = std::min(low_m, off_m), high_m = std::max(high_m, off_m);
  }
  if (points_.empty()) return kInfinity;
  const float half_m = (high_m - low_m) / 2, middle_m = low_m + half_m;
  if (half_m > limit_m) return half_m;
  to_.clear();
  to_.reserve(places_.size());
  for (const uint32_t p : places_)
    to_.push_back(work_.positions[p] + relief.normal * (middle_m - glm::dot(work_.positions[p], relief.normal)));
  const float cost_m = collapser_.move(places_, to_, limit_m);
  if (cost_m > limit_m) return cost_m;
  gather_changed();
  merge_places(relief);
  return cost_m;
}

/// Where the relief's places are now, but for those on borders and those that have gone to something else.
void ReliefPress::gather_places(const Relief& relief) {
  const float middle_m = (relief.low_m + relief.high_m) / 2;
  places_.clear();
  for (const uint32_t place : relief.places) {
    const uint32_t now = work_.current(place);
    if (!borders_.has(now) && std::abs(glm::dot(work_.positions[now], relief.normal) - middle_m) <= relief.depth_m())
      places_.push_back(now);
  }
  sort_once(places_);
  press_of_place_.resize(work_.place_count(), 0);
  ++press_;
  for (const uint32_t place : places_) press_of_place_[place] = press_;
}

/// Among living triangles.
bool ReliefPress::is_flat(const Relief& relief) const {
  float low_m = std::numeric_limits<float>::infinity(), high_m = -low_m;
  for (const uint32_t p : places_) {
    bool is_alive = false;
    for (uint32_t c = work_.first_corner[p]; c != WorkMesh::kNone && !is_alive; c = work_.next_corner[c])
      is_alive = work_.alive[c / 3] != 0;
    if (!is_alive) continue;
    const float off_m = glm::dot(work_.positions[p], relief.normal);
    low_m = std::min(low_m, off_m), high_m = std::max(high_m, off_m);
  }
  return !(high_m - low_m > kFlatShare * relief.depth_m());
}

/// The points that its triangles stand for.
void ReliefPress::gather_points() {
  points_.clear();
  const auto moves = [&](uint32_t corner) { return press_of_place_[work_.place[corner]] == press_; };
  for (const uint32_t p : places_)
    for (uint32_t c = work_.first_corner[p]; c != WorkMesh::kNone; c = work_.next_corner[c])
      if (c % 3 == 0 && work_.alive[c / 3] != 0 && moves(c + 1) && moves(c + 2)) collapser_.points_on(c / 3, points_);
}

/// Steps upright to the plane have no width now: they would only turn over.
void ReliefPress::merge_places(const Relief& relief) {
  const float least2 = std::pow(kFlatShare * relief.depth_m(), 2.0F);
  for (const uint32_t p : places_) {
    uint32_t target = WorkMesh::kNone;
    for (uint32_t c = work_.first_corner[p]; c != WorkMesh::kNone && target == WorkMesh::kNone;
         c = work_.next_corner[c])
      for (const uint32_t c2 : {next_in_triangle(c), previous_in_triangle(c)}) {
        const glm::vec3 off = work_.at(c2) - work_.positions[p];
        if (work_.alive[c / 3] != 0 && glm::dot(off, off) <= least2 && press_of_place_[work_.place[c2]] == press_)
          target = work_.place[c2];
      }
    if (target != WorkMesh::kNone) collapser_.merge(p, target);
  }
}

void ReliefPress::gather_changed() {
  changed_.clear();
  for (const uint32_t p : places_)
    for (uint32_t c = work_.first_corner[p]; c != WorkMesh::kNone; c = work_.next_corner[c])
      if (work_.alive[c / 3] != 0)
        for (uint32_t c2 = c / 3 * 3; c2 < c / 3 * 3 + 3; ++c2) changed_.push_back(work_.place[c2]);
  sort_once(changed_);
}

}  // namespace promenade
