#include "runtime/far_follower.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

// How far ahead along its way the eye's next cells are asked for, and how many. A cell takes some 50 ms to decode.
constexpr double kAheadS = 2;
constexpr size_t kMostAhead = 6;
constexpr double kBorderCells = 1e-6;  // so far beyond a border one is in the next cell, in cells

}  // namespace

/// A cell and what is around it, each once.
void FarFollower::want(const std::optional<FarCellId>& cell, std::vector<FarCellId>& cells) const {
  if (!cell) return;
  for (const FarCellId each : chain_of(tables_, *cell))
    if (std::find(cells.begin(), cells.end(), each) == cells.end()) cells.push_back(each);
}

/// The cells that a straight way from the eye's leads through, in order, however short the way within each.
void FarFollower::want_ahead(const glm::dvec3& eye, const glm::dvec3& way_m, std::vector<FarCellId>& cells) const {
  const glm::dvec3 from = (eye - tables_.origin) / tables_.cell_m, way = way_m / tables_.cell_m;
  size_t found = 0;
  double at = 0;  // of the way
  for (size_t steps = 0; steps < 2 * kMostAhead && found < kMostAhead; ++steps) {
    // To the next border across the way, and a little over it.
    double next = 1;
    for (int i = 0; i < 3; ++i) {
      const double place = from[i] + at * way[i];
      const double border = way[i] > 0 ? std::floor(place) + 1 : std::ceil(place) - 1;
      if (way[i] != 0) next = std::min(next, (border - from[i]) / way[i]);
    }
    const double over = kBorderCells / std::max(glm::length(way), kBorderCells);
    at = std::max(next, at) + over;
    if (at >= 1) return;
    const std::optional<FarCellId> cell = far_cell_at(tables_, eye + at * way_m);
    if (!cell || std::find(cells.begin(), cells.end(), *cell) != cells.end()) continue;
    want(cell, cells);
    ++found;
  }
}

std::vector<FarCellId> FarFollower::wanted(const glm::dvec3& eye, const glm::dvec3& velocity_m_per_s) const {
  std::vector<FarCellId> cells;
  want(far_cell_at(tables_, eye), cells);
  want(shown_, cells), want(fading_, cells);
  want_ahead(eye, velocity_m_per_s * kAheadS, cells);
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
  for (const auto& [distance, at] : beside) want(far_cell_at(tables_, at), cells);
  return cells;
}

/// Whether the picture that is shown may stand in. Parallax grows as the way from the cell's centre does: half a cell
/// outside it is at most twice what it is inside, about.
bool FarFollower::near_shown(const glm::dvec3& eye) const {
  return cell_box(tables_, *shown_).grown(tables_.cell_m / 2).contains(eye);
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
