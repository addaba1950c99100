#include "preprocess/collapse.h"

#include <smmintrin.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace promenade {

namespace {

using Four = __m128;  // lanes: g++ and clang give it the arithmetic operators
constexpr uint32_t kNone = WorkMesh::kNone;
/// The hub of a larger fan waits until its spokes have gone: looking at all its targets takes the square of their
/// number.
constexpr size_t kLargestFan = 64;
/// The same when flips are allowed and little else is left.
constexpr size_t kLargestFanAtLast = 512;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// A triangle may not turn further than this in one collapse.
constexpr float kLeastTurnCosine = 0.2F;
/// A triangle's height over its longest edge: flatter ones may come from no collapse of fatter ones.
constexpr float kLeastHeight = 1e-3F;
/// The same for triangles that lie in a plane at all.
constexpr float kLeastPlane = 1e-4F;
/// Of a metre that a border between colours or materials moves, to a metre that the surface does.
constexpr float kSeamWeight = 0.5F;
/// From which on a border between colours counts in full. Measured on a city: at 1 the panes of glass towers, all of
/// much the same blue, ran into each other; at 0.25 a tenth fewer pixels have a colour that is not near, fronts are 1 %
/// larger and models no larger; at 0.1 the same.
constexpr float kFullContrast = 0.25F;
/// Of an edge of the node's border: the neighbouring node begins there.
constexpr float kBorderWeight = 4;
/// Of the distance to planes, which overestimates what round shapes lose. Measured: at 0.5 and 0.7 a city's fronts are
/// the same within 1 %, and the upper levels of a soup of single faces are half as far off again.
constexpr float kPlaneWeight = 0.6F;
/// A metre of edge length: between collapses that cost nothing the shorter goes first, for rounder triangles.
constexpr float kLengthWeight = 1e-4F;
/// Cosine of the turn at an edge from which it is a crease: beyond it lies another plane.
constexpr float kCreaseCosine = 0.9999F;
/// Pieces that points divide an edge into: bounds the time on long ones.
constexpr float kMostPieces = 16;

uint32_t triangle_of(uint32_t corner) { return corner / 3; }
uint32_t next_corner_in(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
uint32_t previous_corner_in(uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

}  // namespace

Collapser::Collapser(WorkMesh& work, const Mesh& source, BorderLines& borders, float spacing_m)
    : work_(work),
      source_(source),
      borders_(borders),
      normals_(work.triangle_count()),
      points_(work.positions),
      next_point_(work.place_count(), kNone),
      first_point_(work.triangle_count(), kNone),
      seen_(work.place_count(), Seen{0, 0}) {
  for (uint32_t t = 0; t < work.triangle_count(); ++t) set_normal(t);
  for (uint32_t p = 0; p < work.place_count(); ++p) {
    if (work.first_corner[p] == kNone) continue;
    attach(p, triangle_of(work.first_corner[p]));
  }
  for (uint32_t corner = 0; corner < work.place.size(); ++corner)
    if (is_crease(corner)) add_points_along(corner, spacing_m);
}

/// Whether the edge from a corner to its triangle's next one is open or lies between two planes, and the triangle is
/// the first that has it.
bool Collapser::is_crease(uint32_t corner) const {
  const uint32_t triangle = triangle_of(corner);
  const uint32_t to = work_.place[next_corner_in(corner)];
  bool open = true, bent = false;
  for (uint32_t c = work_.first_corner[work_.place[corner]]; c != kNone; c = work_.next_corner[c]) {
    if (triangle_of(c) == triangle ||
        (work_.place[next_corner_in(c)] != to && work_.place[previous_corner_in(c)] != to))
      continue;
    if (triangle_of(c) < triangle) return false;
    open = false;
    bent = bent || glm::dot(normals_[triangle_of(c)], normals_[triangle]) < kCreaseCosine;
  }
  return open || bent;
}

void Collapser::add_points_along(uint32_t corner, float spacing_m) {
  const glm::vec3 from = work_.at(corner), along = work_.at(next_corner_in(corner)) - from;
  const float pieces = std::min(std::ceil(glm::length(along) / spacing_m), kMostPieces);
  for (float i = 1; i < pieces; ++i) {
    points_.push_back(from + along * (i / pieces));
    next_point_.push_back(kNone);
    attach(static_cast<uint32_t>(points_.size() - 1), triangle_of(corner));
  }
}

/// What has been pressed flat lies in no plane, and rounding would make one up.
void Collapser::set_normal(uint32_t triangle) {
  const uint32_t c = triangle * 3;
  const glm::vec3 ab = work_.at(c + 1) - work_.at(c), ac = work_.at(c + 2) - work_.at(c), bc = ac - ab;
  const glm::vec3 cross = glm::cross(ab, ac);
  const float edge2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  const float length = glm::length(cross);
  normals_[triangle] = length > kLeastPlane * edge2 ? cross / length : glm::vec3(0);
}

void Collapser::find_ring(uint32_t place) {
  ring_.clear();
  fan_.clear();
  ++walk_;
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c]) {
    const uint32_t t = triangle_of(c);
    if (work_.alive[t] == 0) continue;
    fan_.push_back(c);
    for (const uint32_t other : {work_.place[next_corner_in(c)], work_.place[previous_corner_in(c)]}) {
      Seen& seen = seen_[other];
      if (seen.walk != walk_) {
        seen = {walk_, static_cast<uint32_t>(ring_.size())};
        ring_.push_back({other, c, 1, 0});
        continue;
      }
      Neighbour& known = ring_[seen.index];
      ++known.triangles;
      if (!source_.materials.empty() && source_.materials[work_.source_triangle[t]] !=
                                            source_.materials[work_.source_triangle[triangle_of(known.corner)]])
        known.contrast = 1;
      if (source_.colors.empty() || work_.attributes[c] == work_.attributes[known.corner]) continue;
      const glm::u8vec4 &here = source_.colors[work_.attributes[c]],
                        &there = source_.colors[work_.attributes[known.corner]];
      if (here != there) known.contrast = std::max(known.contrast, color_contrast(here, there));
    }
  }
}

void Collapser::find_lines(uint32_t place) {
  lines_.clear();
  for (const Neighbour& n : ring_) {
    float weight = std::min(1.0F, n.contrast / kFullContrast) * kSeamWeight;
    if (n.triangles == 1) weight = borders_.is_edge(place, n.place) ? kBorderWeight : 1.0F;
    if (weight <= 0) continue;
    const glm::vec3 along = work_.positions[n.place] - work_.positions[place];
    const float length = glm::length(along);
    if (length > 0) lines_.push_back({along / length, weight});
  }
}

/// For all targets in the ring, which has been found, four at a time.
void Collapser::estimate_ring(uint32_t place) {
  find_lines(place);
  const size_t groups = (ring_.size() + kAtOnce - 1) / kAtOnce;
  estimates_.resize(groups);
  const glm::vec3 from = work_.positions[place];
  for (size_t g = 0; g < groups; ++g) {
    alignas(16) float steps[3][kAtOnce];
    for (size_t i = 0; i < kAtOnce; ++i) {
      const glm::vec3 step = work_.positions[ring_[std::min(g * kAtOnce + i, ring_.size() - 1)].place] - from;
      steps[0][i] = step.x, steps[1][i] = step.y, steps[2][i] = step.z;
    }
    const Four x = _mm_load_ps(steps[0]), y = _mm_load_ps(steps[1]), z = _mm_load_ps(steps[2]);
    const auto along = [&](const glm::vec3& d) {
      return x * _mm_set1_ps(d.x) + y * _mm_set1_ps(d.y) + z * _mm_set1_ps(d.z);
    };
    const Four length2 = x * x + y * y + z * z;
    Four planes2 = _mm_setzero_ps();
    for (const uint32_t c : fan_) {
      const Four off = along(normals_[triangle_of(c)]);
      planes2 = _mm_max_ps(planes2, off * off);
    }
    Four lines2 = _mm_setzero_ps();
    for (const Line& line : lines_) {
      const Four on = along(line.direction);
      lines2 = _mm_max_ps(lines2, (length2 - on * on) * _mm_set1_ps(line.weight * line.weight));
    }
    const Four distance2 = _mm_max_ps(planes2 * _mm_set1_ps(kPlaneWeight * kPlaneWeight), lines2);
    const Four estimate = _mm_sqrt_ps(distance2) + _mm_set1_ps(kLengthWeight) * _mm_sqrt_ps(length2);
    _mm_store_ps(estimates_[g].data(), estimate);
  }
  if (!goes_along_border(place)) return;
  const std::array<uint32_t, 2> ways = *borders_.ways(place);
  for (size_t i = 0; i < ring_.size(); ++i)
    if (ring_[i].place != ways[0] && ring_[i].place != ways[1]) estimates_[i / kAtOnce][i % kAtOnce] = kInfinity;
}

bool Collapser::goes_along_border(uint32_t place) const {
  return border_rule_ != BorderRule::free && borders_.has(place) && borders_.ways(place).has_value();
}

/// Finds the ring, unless the place stays anyway.
bool Collapser::may_go(uint32_t place) {
  if (border_rule_ == BorderRule::stay && borders_.has(place)) return false;
  find_ring(place);
  return fan_.size() <= (flips_allowed_ ? kLargestFanAtLast : kLargestFan);
}

float Collapser::estimate(uint32_t place) {
  if (!may_go(place)) return kInfinity;
  return least_estimate(place);
}

/// Of the ring, which has been found.
float Collapser::least_estimate(uint32_t place) {
  estimate_ring(place);
  float least = kInfinity;
  for (size_t i = 0; i < ring_.size(); ++i) least = std::min(least, estimates_[i / kAtOnce][i % kAtOnce]);
  return least;
}

float Collapser::estimate_colorless(uint32_t place) {
  if (!may_go(place)) return kInfinity;
  for (Neighbour& n : ring_) n.contrast = 0;
  return least_estimate(place);
}

Collapser::Choice Collapser::choose(uint32_t place, float limit_m) {
  Choice best;
  if (!may_go(place)) return best;
  estimate_ring(place);
  choices_.clear();
  for (size_t i = 0; i < ring_.size(); ++i)
    choices_.push_back({ring_[i].place, estimates_[i / kAtOnce][i % kAtOnce], estimates_[i / kAtOnce][i % kAtOnce]});
  std::sort(choices_.begin(), choices_.end(), [](const Choice& a, const Choice& b) {
    return a.cost_m != b.cost_m ? a.cost_m < b.cost_m : a.target < b.target;
  });
  if (!choices_.empty() && choices_.front().cost_m > limit_m && choices_.front().cost_m < kInfinity)
    return choices_.front();
  float least_unsound = kInfinity;
  for (const Choice& choice : choices_) {
    if (choice.cost_m == kInfinity || (best.target != kNone && choice.cost_m >= best.cost_m)) break;
    if (!is_sound(place, choice.target)) {
      least_unsound = std::min(least_unsound, choice.cost_m);
      continue;
    }
    const float limit = best.target == kNone ? limit_m : std::min(limit_m, best.cost_m);
    float cost = std::max(choice.cost_m, measure(place, choice.target, limit, moved_));
    if (goes_along_border(place))
      cost = std::max(cost, kBorderWeight * borders_.deviation_m(place, limit / kBorderWeight));
    if (best.target != kNone && cost >= best.cost_m) continue;
    best = {choice.target, cost, 0};
    best_moved_.swap(moved_);
  }
  best.firm_m = std::min(best.cost_m, least_unsound);
  return best;
}

bool Collapser::is_sound(uint32_t place, uint32_t target) const {
  if (flips_allowed_) return true;
  const glm::vec3 from = work_.positions[place];
  const glm::vec3 to = work_.positions[target];
  for (const uint32_t c : fan_) {
    const uint32_t next = work_.place[next_corner_in(c)], previous = work_.place[previous_corner_in(c)];
    if (next == target || previous == target) continue;
    const glm::vec3 a = work_.positions[next], b = work_.positions[previous];
    const glm::vec3 before = glm::cross(a - from, b - from), after = glm::cross(a - to, b - to);
    const float before2 = glm::dot(before, before), after2 = glm::dot(after, after);
    const float ab2 = glm::dot(a - b, a - b);
    const float edge2 = std::max({ab2, glm::dot(a - to, a - to), glm::dot(b - to, b - to)});
    const float old_edge2 = std::max({ab2, glm::dot(a - from, a - from), glm::dot(b - from, b - from)});
    constexpr float kLeast = kLeastHeight * kLeastHeight;
    if (before2 <= kLeast * old_edge2 * old_edge2) continue;  // a sliver before: any turn is as good
    if (after2 <= kLeast * edge2 * edge2) return false;
    if (glm::dot(before, after) < kLeastTurnCosine * std::sqrt(before2 * after2)) return false;
  }
  return true;
}

uint32_t Collapser::triangles_between(uint32_t place, uint32_t target) const {
  uint32_t count = 0;
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c])
    if (work_.alive[triangle_of(c)] != 0 &&
        (work_.place[next_corner_in(c)] == target || work_.place[previous_corner_in(c)] == target))
      ++count;
  return count;
}

void Collapser::chosen_ring(std::vector<uint32_t>& ring) const {
  ring.clear();
  for (const Neighbour& n : ring_) ring.push_back(n.place);
}

void Collapser::add_candidate(uint32_t triangle, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const size_t lane = candidates_.size() % kLanes;
  if (lane == 0) corners_.emplace_back();
  candidates_.push_back(triangle);
  TriangleCorners& corners = corners_.back();
  for (int axis = 0; axis < 3; ++axis)
    corners.at[0][axis][lane] = a[axis], corners.at[1][axis][lane] = b[axis], corners.at[2][axis][lane] = c[axis];
}

void Collapser::make_frames() {
  frames_.resize(corners_.size());
  for (size_t lane = candidates_.size() % kLanes; lane % kLanes != 0; ++lane)  // spare lanes repeat the last triangle
    for (auto& corner : corners_.back().at)
      for (auto& axis : corner) axis[lane] = axis[lane - 1];
  kernels_.make_frames(corners_.data(), corners_.size(), frames_.data());
}

void Collapser::gather_candidates(uint32_t place, uint32_t target) {
  corners_.clear();
  candidates_.clear();
  for (const uint32_t middle : {place, target})
    for (uint32_t c = work_.first_corner[middle]; c != kNone; c = work_.next_corner[c]) {
      if (work_.alive[triangle_of(c)] == 0) continue;
      const uint32_t next = work_.place[next_corner_in(c)], previous = work_.place[previous_corner_in(c)];
      const uint32_t other = middle == place ? target : place;
      if (next == other || previous == other) continue;  // goes
      add_candidate(triangle_of(c), work_.positions[target], work_.positions[next], work_.positions[previous]);
    }
  make_frames();
}

uint32_t Collapser::nearest_candidate(const glm::vec3& p, float& distance2) const {
  const uint32_t lane = kernels_.nearest(frames_.data(), frames_.size(), &p.x, distance2);
  return candidates_[std::min(size_t(lane), candidates_.size() - 1)];
}

float Collapser::measure(uint32_t place, uint32_t target, float limit_m, std::vector<Moved>& moved) {
  gather_candidates(place, target);
  moved.clear();
  if (candidates_.empty()) return kInfinity;
  const float limit2 = limit_m * limit_m;
  float farthest2 = 0;
  // Three in four are too dear, and nearly always the place itself shows it.
  nearest_candidate(points_[place], farthest2);
  if (farthest2 > limit2) return std::sqrt(farthest2);
  for (const uint32_t c : fan_)
    for (uint32_t p = first_point_[triangle_of(c)]; p != kNone; p = next_point_[p]) {
      float distance2 = 0;
      moved.push_back({p, nearest_candidate(points_[p], distance2)});
      farthest2 = std::max(farthest2, distance2);
      if (farthest2 > limit2) return std::sqrt(farthest2);
    }
  return std::sqrt(farthest2);
}

void Collapser::attach(uint32_t point, uint32_t triangle) {
  next_point_[point] = first_point_[triangle];
  first_point_[triangle] = point;
}

/// The triangles around a place, as they are.
void Collapser::gather_around(uint32_t place) {
  corners_.clear();
  candidates_.clear();
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c])
    if (work_.alive[triangle_of(c)] != 0)
      add_candidate(triangle_of(c), work_.positions[place], work_.positions[work_.place[next_corner_in(c)]],
                    work_.positions[work_.place[previous_corner_in(c)]]);
  make_frames();
}

float Collapser::nearest_around(const std::vector<glm::vec3>& points, const std::vector<uint32_t>& places,
                                std::vector<uint32_t>& triangles) {
  triangles.assign(points.size(), kNone);
  float farthest2 = 0;
  uint32_t around = kNone;
  for (size_t i = 0; i < points.size(); ++i) {
    if (places[i] != around) gather_around(around = places[i]);
    if (candidates_.empty()) continue;
    float distance2 = 0;
    triangles[i] = nearest_candidate(points[i], distance2);
    farthest2 = std::max(farthest2, distance2);
  }
  return std::sqrt(farthest2);
}

void Collapser::add_point(const glm::vec3& point, uint32_t triangle) {
  points_.push_back(point);
  next_point_.push_back(kNone);
  attach(static_cast<uint32_t>(points_.size() - 1), triangle);
}

void Collapser::points_on(uint32_t triangle, std::vector<glm::vec3>& points) const {
  for (uint32_t p = first_point_[triangle]; p != kNone; p = next_point_[p]) points.push_back(points_[p]);
}

float Collapser::move(const std::vector<uint32_t>& places, const std::vector<glm::vec3>& to, float limit_m) {
  changed_.clear();
  from_.clear();
  for (size_t i = 0; i < places.size(); ++i) {
    for (uint32_t c = work_.first_corner[places[i]]; c != kNone; c = work_.next_corner[c])
      if (work_.alive[triangle_of(c)] != 0) changed_.push_back(triangle_of(c));
    from_.push_back(work_.positions[places[i]]);
    work_.positions[places[i]] = to[i];
  }
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  float farthest2 = 0;
  for (size_t i = 0; i < changed_.size() && farthest2 <= limit_m * limit_m; ++i)
    farthest2 = std::max(farthest2, farthest2_on(changed_[i]));
  const float cost_m = std::sqrt(farthest2);
  if (cost_m > limit_m) {
    for (size_t i = 0; i < places.size(); ++i) work_.positions[places[i]] = from_[i];
    return cost_m;
  }
  for (size_t i = 0; i < places.size(); ++i) work_.model_positions[places[i]] += to[i] - from_[i];
  for (const uint32_t t : changed_) set_normal(t);
  return cost_m;
}

void Collapser::merge(uint32_t place, uint32_t target) {
  find_ring(place);
  measure(place, target, kInfinity, best_moved_);
  collapse(place, target);
}

/// Squared: of the points on a triangle from it.
float Collapser::farthest2_on(uint32_t triangle) {
  if (first_point_[triangle] == kNone) return 0;
  corners_.clear();
  candidates_.clear();
  add_candidate(triangle, work_.at(3 * triangle), work_.at(3 * triangle + 1), work_.at(3 * triangle + 2));
  make_frames();
  float farthest2 = 0;
  for (uint32_t p = first_point_[triangle]; p != kNone; p = next_point_[p]) {
    float distance2 = 0;
    nearest_candidate(points_[p], distance2);
    farthest2 = std::max(farthest2, distance2);
  }
  return farthest2;
}

void Collapser::unlink_dead(uint32_t place) {
  uint32_t* link = &work_.first_corner[place];
  while (*link != kNone) {
    if (work_.alive[triangle_of(*link)] == 0)
      *link = work_.next_corner[*link];
    else
      link = &work_.next_corner[*link];
  }
}

/// The triangle that lies where the corner's would, moved to `target`, in the same turn; kNone: there is none.
uint32_t Collapser::find_twin(uint32_t corner, uint32_t target) const {
  const uint32_t next = work_.place[next_corner_in(corner)];
  const uint32_t previous = work_.place[previous_corner_in(corner)];
  for (uint32_t c = work_.first_corner[target]; c != kNone; c = work_.next_corner[c])
    if (work_.place[next_corner_in(c)] == next && work_.place[previous_corner_in(c)] == previous) return triangle_of(c);
  return kNone;
}

void Collapser::collapse(uint32_t place, uint32_t target) {
  // Along the triangles that go, attributes of the place lead over to those of the target on the same side of a seam.
  leads_.clear();
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c]) {
    if (work_.alive[triangle_of(c)] == 0) continue;
    first_point_[triangle_of(c)] = kNone;
    for (const uint32_t other : {next_corner_in(c), previous_corner_in(c)}) {
      if (work_.place[other] != target) continue;
      work_.kill(triangle_of(c));
      leads_.push_back({work_.attributes[c], work_.attributes[other]});
    }
  }
  if (goes_along_border(place))
    borders_.shorten(place);
  else if (borders_.has(place))
    borders_.leave(place);
  unlink_dead(target);
  twins_.clear();
  for (uint32_t c = work_.first_corner[place]; c != kNone;) {
    const uint32_t next = work_.next_corner[c];
    if (work_.alive[triangle_of(c)] != 0) move_corner(c, target);
    c = next;
  }
  work_.first_corner[place] = kNone;
  work_.merged_into[place] = target;
  for (const Moved& m : best_moved_) {
    uint32_t triangle = m.triangle;
    for (const auto& [gone, twin] : twins_)
      if (triangle == gone) triangle = twin;
    attach(m.point, triangle);
  }
}

void Collapser::move_corner(uint32_t corner, uint32_t target) {
  const uint32_t triangle = triangle_of(corner);
  if (const uint32_t twin = find_twin(corner, target); twin != kNone) {
    work_.kill(triangle);
    twins_.push_back({triangle, twin});
    return;
  }
  for (const auto& [from, to] : leads_)
    if (from == work_.attributes[corner]) {
      work_.attributes[corner] = to;
      break;
    }
  work_.place[corner] = target;
  work_.next_corner[corner] = work_.first_corner[target];
  work_.first_corner[target] = corner;
  set_normal(triangle);
}

}  // namespace promenade
