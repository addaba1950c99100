#include "preprocess/collapse.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {

namespace {

constexpr uint32_t kNone = WorkMesh::kNone;
/// A triangle may not turn further than this in one collapse.
constexpr float kLeastTurnCosine = 0.2F;
/// A triangle's height over its longest edge: flatter ones may come from no collapse of fatter ones.
constexpr float kLeastHeight = 1e-3F;
/// Of a border's plane to a triangle's: an outline shows more than a bump.
constexpr double kBorderWeight = 1;
/// Of an edge along the cell's face: the neighbouring node ends there too.
constexpr double kCellBorderWeight = 100;

uint32_t triangle_of(uint32_t corner) { return corner / 3; }
uint32_t next_corner_in(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
uint32_t previous_corner_in(uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

}  // namespace

Collapser::Collapser(WorkMesh& work, const Mesh& source, const std::vector<uint8_t>& cell_faces)
    : work_(work),
      source_(source),
      quadrics_(work.place_count()),
      locked_(work.place_count(), 0),
      seen_in_(work.place_count(), 0) {
  add_triangle_planes();
  add_edge_planes(cell_faces);
}

void Collapser::add_triangle_planes() {
  for (uint32_t t = 0; t < work_.triangle_count(); ++t) {
    const glm::dvec3 a(work_.at(t * 3)), b(work_.at(t * 3 + 1)), c(work_.at(t * 3 + 2));
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    if (!(length > 0)) continue;
    Quadric q;
    q.add_plane(cross / length, a, length * 0.5);
    for (uint32_t i = 0; i < 3; ++i) quadrics_[work_.place[t * 3 + i]].add(q);
  }
}

/// Each edge from its lower place's side: found by walking that place's chain, which is short.
void Collapser::add_edge_planes(const std::vector<uint8_t>& cell_faces) {
  for (uint32_t corner = 0; corner < work_.place.size(); ++corner) {
    const uint32_t from = work_.place[corner];
    const uint32_t to = work_.place[next_corner_in(corner)];
    uint32_t sharing = 0;
    float contrast = 0;
    for (uint32_t c = work_.first_corner[from]; c != kNone; c = work_.next_corner[c]) {
      const uint32_t t = triangle_of(c);
      if (t == triangle_of(corner)) continue;
      const bool ahead = work_.place[next_corner_in(c)] == to;
      if (!ahead && work_.place[previous_corner_in(c)] != to) continue;
      ++sharing;
      if (source_.material_of(work_.source_triangle[t]) !=
          source_.material_of(work_.source_triangle[triangle_of(corner)]))
        contrast = 1;
      if (!source_.colors.empty())
        contrast = std::max(
            contrast, color_contrast(source_.colors[work_.attributes[corner]], source_.colors[work_.attributes[c]]));
    }
    if (sharing != 1) contrast = 1;  // an outline, or where sheets meet
    if (contrast <= 0) continue;
    const glm::dvec3 a(work_.positions[from]), b(work_.positions[to]);
    const glm::dvec3 normal = glm::cross(b - a, glm::dvec3(work_.at(previous_corner_in(corner))) - a);
    const glm::dvec3 across = glm::cross(b - a, normal);
    const double length = glm::length(across);
    if (!(length > 0)) continue;
    const bool on_cell = (cell_faces[from] & cell_faces[to]) != 0;
    const double length2 = glm::dot(b - a, b - a);
    Quadric q;
    q.add_plane(across / length, a, double(contrast) * length2 * (on_cell ? kCellBorderWeight : kBorderWeight));
    quadrics_[from].add(q);
    quadrics_[to].add(q);
  }
}

const std::vector<uint32_t>& Collapser::neighbours(uint32_t place) {
  ring_.clear();
  ++walk_;
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c]) {
    if (work_.alive[triangle_of(c)] == 0) continue;
    for (const uint32_t other : {work_.place[next_corner_in(c)], work_.place[previous_corner_in(c)]}) {
      if (seen_in_[other] == walk_) continue;
      seen_in_[other] = walk_;
      ring_.push_back(other);
    }
  }
  return ring_;
}

float Collapser::cost(uint32_t place, uint32_t target) const {
  const glm::dvec3 p(work_.positions[target]);
  const Quadric& a = quadrics_[place];
  const Quadric& b = quadrics_[target];
  const double weight = a.weight + b.weight;
  return weight > 0 ? static_cast<float>(std::sqrt((a.at(p) + b.at(p)) / weight)) : 0.0F;
}

Collapser::Choice Collapser::cheapest(uint32_t place) {
  Choice best;
  if (locked_[place] != 0) return best;
  for (const uint32_t target : neighbours(place)) {
    const float c = cost(place, target);
    if (best.target == kNone || c < best.cost_m || (c == best.cost_m && target < best.target)) best = {target, c};
  }
  return best;
}

Collapser::Choice Collapser::cheapest_sound(uint32_t place) {
  if (locked_[place] != 0) return {};
  choices_.clear();
  for (const uint32_t target : neighbours(place)) choices_.push_back({target, cost(place, target)});
  std::sort(choices_.begin(), choices_.end(), [](const Choice& a, const Choice& b) {
    return a.cost_m != b.cost_m ? a.cost_m < b.cost_m : a.target < b.target;
  });
  for (const Choice& choice : choices_)
    if (is_sound(place, choice.target)) return choice;
  return {};
}

bool Collapser::is_sound(uint32_t place, uint32_t target) {
  if (flips_allowed_) return true;
  const glm::vec3 from = work_.positions[place];
  const glm::vec3 to = work_.positions[target];
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c]) {
    if (work_.alive[triangle_of(c)] == 0) continue;
    const uint32_t next = work_.place[next_corner_in(c)], previous = work_.place[previous_corner_in(c)];
    if (next == target || previous == target) continue;
    const glm::vec3 a = work_.positions[next], b = work_.positions[previous];
    const glm::vec3 before = glm::cross(a - from, b - from), after = glm::cross(a - to, b - to);
    const float before2 = glm::dot(before, before), after2 = glm::dot(after, after);
    const float edge2 = std::max({glm::dot(a - b, a - b), glm::dot(a - to, a - to), glm::dot(b - to, b - to)});
    const float old_edge2 =
        std::max({glm::dot(a - b, a - b), glm::dot(a - from, a - from), glm::dot(b - from, b - from)});
    const float least = kLeastHeight * kLeastHeight;
    const bool was_sliver = before2 <= least * old_edge2 * old_edge2;
    if (was_sliver) continue;
    if (after2 <= least * edge2 * edge2) return false;
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

void Collapser::unlink_dead(uint32_t place) {
  uint32_t* link = &work_.first_corner[place];
  while (*link != kNone) {
    if (work_.alive[triangle_of(*link)] == 0)
      *link = work_.next_corner[*link];
    else
      link = &work_.next_corner[*link];
  }
}

/// Whether the corner's triangle, moved to `target`, would lie there twice, in the same turn.
bool Collapser::has_twin(uint32_t corner, uint32_t target) const {
  const uint32_t next = work_.place[next_corner_in(corner)];
  const uint32_t previous = work_.place[previous_corner_in(corner)];
  for (uint32_t c = work_.first_corner[target]; c != kNone; c = work_.next_corner[c])
    if (work_.place[next_corner_in(c)] == next && work_.place[previous_corner_in(c)] == previous) return true;
  return false;
}

void Collapser::collapse(uint32_t place, uint32_t target) {
  // Along the triangles that go, attributes of the place lead over to those of the target on the same side of a seam.
  std::array<std::array<uint32_t, 2>, 16> leads;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  size_t lead_count = 0;
  for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c]) {
    if (work_.alive[triangle_of(c)] == 0) continue;
    for (const uint32_t other : {next_corner_in(c), previous_corner_in(c)}) {
      if (work_.place[other] != target) continue;
      work_.kill(triangle_of(c));
      if (lead_count < leads.size()) leads[lead_count++] = {work_.attributes[c], work_.attributes[other]};
    }
  }
  unlink_dead(target);
  for (uint32_t c = work_.first_corner[place]; c != kNone;) {
    const uint32_t next = work_.next_corner[c];
    if (work_.alive[triangle_of(c)] != 0 && has_twin(c, target)) work_.kill(triangle_of(c));
    if (work_.alive[triangle_of(c)] != 0) {
      for (size_t i = 0; i < lead_count; ++i)
        if (leads[i][0] == work_.attributes[c]) {
          work_.attributes[c] = leads[i][1];
          break;
        }
      work_.place[c] = target;
      work_.next_corner[c] = work_.first_corner[target];
      work_.first_corner[target] = c;
    }
    c = next;
  }
  work_.first_corner[place] = kNone;
  quadrics_[target].add(quadrics_[place]);
}

}  // namespace promenade
