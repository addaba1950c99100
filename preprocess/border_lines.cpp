#include "preprocess/border_lines.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {

namespace {

float distance2_to_segment(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 along = b - a, to_p = p - a;
  const float length2 = glm::dot(along, along);
  const float t = length2 > 0 ? std::clamp(glm::dot(to_p, along) / length2, 0.0F, 1.0F) : 0;
  const glm::vec3 off = to_p - along * t;
  return glm::dot(off, off);
}

}  // namespace

BorderLines::BorderLines(const WorkMesh& work, const Border& border) : work_(&work) {
  if (border.edges.empty()) return;
  uint32_t source_triangles = 0;
  for (const BorderEdge& edge : border.edges) source_triangles = std::max(source_triangles, edge.corner / 3 + 1);
  std::vector<uint32_t> work_triangle(source_triangles, kNone);
  for (uint32_t t = 0; t < work.triangle_count(); ++t)
    if (work.source_triangle[t] < source_triangles) work_triangle[work.source_triangle[t]] = t;
  role_.assign(work.place_count(), Role::none);
  in_.assign(work.place_count(), kNone), out_.assign(work.place_count(), kNone);
  edges_.reserve(border.edges.size());
  for (size_t e = 0; e < border.edges.size(); ++e) {
    const uint32_t corner = border.edges[e].corner, triangle = work_triangle[corner / 3];
    if (triangle == kNone) continue;
    Edge edge{work.place[triangle * 3 + corner % 3], work.place[next_in_triangle(triangle * 3 + corner % 3)]};
    for (const glm::vec3& p : border.passed_by(e)) {
      const auto point = static_cast<uint32_t>(points_.size());
      points_.push_back(p), next_point_.push_back(kNone);
      append(edge, point, point);
    }
    const auto index = static_cast<uint32_t>(edges_.size());
    edges_.push_back(edge);
    for (const uint32_t place : {edge.from, edge.to})
      if (role_[place] == Role::none) role_[place] = Role::passed;
    if (out_[edge.from] != kNone) hold(edge.from);
    if (in_[edge.to] != kNone) hold(edge.to);
    out_[edge.from] = in_[edge.to] = index;
  }
  for (uint32_t p = 0; p < role_.size(); ++p)
    if (role_[p] == Role::passed && (in_[p] == kNone || out_[p] == kNone)) hold(p);
}

void BorderLines::append(Edge& edge, uint32_t first, uint32_t last) {
  if (first == kNone) return;
  (edge.last == kNone ? edge.first : next_point_[edge.last]) = first;
  edge.last = last;
}

bool BorderLines::is_edge(uint32_t a, uint32_t b) const {
  if (!has(a) || !has(b)) return false;
  const auto leads = [&](uint32_t from, uint32_t to) {
    return (out_[from] != kNone && edges_[out_[from]].to == to) || (in_[to] != kNone && edges_[in_[to]].from == from);
  };
  return leads(a, b) || leads(b, a);
}

std::optional<std::array<uint32_t, 2>> BorderLines::ways(uint32_t place) const {
  if (role_[place] != Role::passed) return std::nullopt;
  const uint32_t before = edges_[in_[place]].from, after = edges_[out_[place]].to;
  // A border of three edges stays.
  if (before == after || (out_[after] != kNone && edges_[out_[after]].to == before)) return std::nullopt;
  return std::array{before, after};
}

float BorderLines::deviation_m(uint32_t place, float limit_m) const {
  const Edge &in = edges_[in_[place]], &out = edges_[out_[place]];
  const glm::vec3 a = work_->positions[in.from], b = work_->positions[out.to];
  const float limit2 = limit_m * limit_m;
  float farthest2 = distance2_to_segment(work_->positions[place], a, b);
  for (const Edge* edge : {&in, &out})
    for (uint32_t p = edge->first; p != kNone && farthest2 <= limit2; p = next_point_[p])
      farthest2 = std::max(farthest2, distance2_to_segment(points_[p] - work_->origin, a, b));
  return std::sqrt(farthest2);
}

void BorderLines::shorten(uint32_t place) {
  Edge &in = edges_[in_[place]], &out = edges_[out_[place]];
  const auto point = static_cast<uint32_t>(points_.size());
  points_.push_back(work_->model_positions[place]), next_point_.push_back(kNone);
  append(in, point, point);
  append(in, out.first, out.last);
  in.to = out.to;
  if (in_[in.to] == out_[place]) in_[in.to] = in_[place];
  out.alive = false;
  role_[place] = Role::none;
}

void BorderLines::leave(uint32_t place) {
  if (in_[place] != kNone) edges_[in_[place]].alive = false, hold(edges_[in_[place]].from);
  if (out_[place] != kNone) edges_[out_[place]].alive = false, hold(edges_[out_[place]].to);
  role_[place] = Role::none;
}

Border BorderLines::border(const WorkMesh& work) const {
  Border border;
  if (edges_.empty()) return border;
  std::vector<uint32_t> number(work.triangle_count(), kNone);  // of living triangles
  uint32_t living = 0;
  for (uint32_t t = 0; t < work.triangle_count(); ++t)
    if (work.alive[t] != 0) number[t] = living++;
  std::vector<std::pair<uint32_t, uint32_t>> kept;  // corner, edge
  for (uint32_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    if (!edge.alive || role_[edge.from] == Role::none || role_[edge.to] == Role::none) continue;
    for (uint32_t c = work.first_corner[edge.from]; c != kNone; c = work.next_corner[c])
      if (work.alive[c / 3] != 0 && work.place[next_in_triangle(c)] == edge.to) {
        kept.emplace_back(number[c / 3] * 3 + c % 3, e);
        break;
      }
  }
  std::sort(kept.begin(), kept.end());
  border.edges.reserve(kept.size());
  for (const auto& [corner, e] : kept) {
    for (uint32_t p = edges_[e].first; p != kNone; p = next_point_[p]) border.passed.push_back(points_[p]);
    border.edges.push_back({corner, static_cast<uint32_t>(border.passed.size())});
  }
  return border;
}

}  // namespace promenade
