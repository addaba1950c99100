#include "runtime/far_follower.h"

#include <algorithm>
#include <array>

namespace promenade {
namespace {

/// Seconds ahead at which one looks where the eye will be.
constexpr std::array kAheadS = {0.25, 0.5, 1.0, 1.5, 2.0};

}  // namespace

std::vector<FarCellId> FarFollower::wanted(const glm::dvec3& eye, const glm::dvec3& velocity_m_per_s) const {
  std::vector<FarCellId> cells;
  const auto want = [&cells](const std::optional<FarCellId>& cell) {
    if (cell && std::find(cells.begin(), cells.end(), *cell) == cells.end()) cells.push_back(*cell);
  };
  want(far_cell_at(tables_, eye));
  want(shown_), want(fading_);
  for (const double ahead_s : kAheadS) want(far_cell_at(tables_, eye + velocity_m_per_s * ahead_s));
  // Across the faces, the nearest first.
  std::array<std::pair<double, glm::dvec3>, 6> beside;
  const glm::dvec3 inside = (eye - tables_.origin) / tables_.cell_m;
  for (int i = 0; i < 6; ++i) {
    const int axis = i / 2;
    const double place = inside[axis] - std::floor(inside[axis]);
    glm::dvec3 at = eye;
    at[axis] += i % 2 == 0 ? tables_.cell_m : -tables_.cell_m;
    beside[static_cast<size_t>(i)] = {i % 2 == 0 ? 1 - place : place, at};
  }
  std::sort(beside.begin(), beside.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [distance, at] : beside) want(far_cell_at(tables_, at));
  return cells;
}

/// Whether the eye is not farther than a cell from that of the picture that is shown.
bool FarFollower::near_shown(const glm::dvec3& eye) const {
  return cell_box(tables_, *shown_).grown(tables_.cell_m).contains(eye);
}

void FarFollower::set_layers() {
  layers_.clear(), near_.clear();
  if (!shown_) return;
  layers_.push_back({*shown_, 0, fading_ ? share_ : 1});
  near_.push_back(near_box(tables_, *shown_));
  if (!fading_) return;
  layers_.push_back({*fading_, share_, 1});
  near_.push_back(near_box(tables_, *fading_));
}

}  // namespace promenade
