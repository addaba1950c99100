#include "preprocess/twins.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "preprocess/key_set.h"

namespace promenade {

namespace {

constexpr uint32_t kNone = Twins::kNone;
/// Parts of one class at most, the original among them: what an original loses its copies lose at once, and no more of
/// them than this should overshoot a node's target together.
constexpr uint32_t kMostAlike = 16;
/// Of the largest coordinate: what single precision does to a vertex and to the move, twice over.
constexpr float kRounding = 0x1p-21F;
/// How much coarser extents are told apart by the hash: those of twins rarely fall on either side of a step.
constexpr float kExtentSteps = 256;
/// Classes with the same hash that a part is held against: bounds the time on hostile input.
constexpr uint32_t kMostLooks = 32;
/// Between normals that light alike.
constexpr float kNormalReach = 1e-3F;

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t place) {
  while (parent[place] != place) place = parent[place] = parent[parent[place]];
  return place;
}

class TwinFinder {
 public:
  TwinFinder(WorkMesh& work, const Mesh& source) : work_(work), source_(source) {}

  Twins run(const std::function<bool(uint32_t)>& stays_alone) {
    find_parts(stays_alone);
    leave_unlike_alone();
    number_vertices();
    find_classes();
    twins_.class_of_triangle.assign(work_.triangle_count(), kNone);
    twins_.first_copy.assign(1, 0);
    if (copies_ == 0) return std::move(twins_);
    list_copies();
    reduce();
    return std::move(twins_);
  }

 private:
  struct Part {
    uint32_t triangles_end, vertices_end;  // of those of the part before it
    uint64_t hash = 0;
    uint32_t original = kNone;  // the part that stands for it; kNone: itself
    uint32_t copies = 0;        // that it stands for
    bool alone = false;
  };

  uint32_t first_triangle(uint32_t part) const { return part == 0 ? 0 : parts_[part - 1].triangles_end; }
  uint32_t first_vertex(uint32_t part) const { return part == 0 ? 0 : parts_[part - 1].vertices_end; }

  void find_parts(const std::function<bool(uint32_t)>& stays_alone) {
    const auto triangles = static_cast<uint32_t>(work_.triangle_count());
    std::vector<uint32_t> parent(work_.place_count());
    std::iota(parent.begin(), parent.end(), 0U);
    for (uint32_t t = 0; t < triangles; ++t)
      for (uint32_t c = 1; c < 3; ++c) {
        const uint32_t a = root_of(parent, work_.place[t * 3]), b = root_of(parent, work_.place[t * 3 + c]);
        parent[std::max(a, b)] = std::min(a, b);
      }
    std::vector<uint32_t> part_of_root(work_.place_count(), kNone);
    part_of_triangle_.resize(triangles);
    for (uint32_t t = 0; t < triangles; ++t) {
      uint32_t& part = part_of_root[root_of(parent, work_.place[t * 3])];
      if (part == kNone) part = static_cast<uint32_t>(parts_.size()), parts_.push_back({0, 0});
      part_of_triangle_[t] = part;
      ++parts_[part].triangles_end;
    }
    part_of_place_.resize(work_.place_count());
    for (uint32_t p = 0; p < work_.place_count(); ++p) {
      const uint32_t part = part_of_place_[p] = part_of_root[root_of(parent, p)];
      if (part != kNone && stays_alone(p)) parts_[part].alone = true;
    }
    std::vector<uint32_t> end(parts_.size());  // so far
    uint32_t before = 0;
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      end[part] = before;
      parts_[part].triangles_end = before += parts_[part].triangles_end;
    }
    triangles_.resize(triangles);
    for (uint32_t t = 0; t < triangles; ++t) triangles_[end[part_of_triangle_[t]]++] = t;
  }

  /// Parts that are like no other in size stay alone: most triangles are in some.
  void leave_unlike_alone() {
    float farthest = 0;
    for (const glm::vec3& p : work_.model_positions)
      farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    reach_m_ = std::max(farthest * kRounding, std::numeric_limits<float>::min());
    const float step_m = reach_m_ * kExtentSteps;
    std::vector<Box> boxes(parts_.size());
    for (uint32_t p = 0; p < work_.place_count(); ++p)
      if (part_of_place_[p] != kNone) boxes[part_of_place_[p]].add(work_.model_positions[p]);
    const size_t slots = std::bit_ceil(parts_.size() * 2 + 1);
    std::vector<uint32_t> table(slots, kNone);  // open addressing: the first part of each size
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      if (parts_[part].alone) continue;
      uint64_t& hash = parts_[part].hash;
      hash = parts_[part].triangles_end - first_triangle(part);
      const glm::vec3 size = boxes[part].size();
      for (int axis = 0; axis < 3; ++axis)
        hash = scramble(hash + static_cast<uint64_t>(std::min(size[axis] / step_m + 0.37F, 0x1p40F)));
      size_t slot = (hash >> 20U) & (slots - 1);
      while (table[slot] != kNone && parts_[table[slot]].hash != hash) slot = (slot + 1) & (slots - 1);
      parts_[part].alone = true;
      if (table[slot] != kNone) parts_[table[slot]].alone = parts_[part].alone = false;
      if (table[slot] == kNone) table[slot] = part;
    }
  }

  /// Vertices of each part in order of appearance, and places; adds to the hashes what twins have in common but for
  /// what rounding changes.
  void number_vertices() {
    twins_.local.assign(source_.vertex_count(), kNone);
    local_of_place_.assign(work_.place_count(), kNone);
    vertices_.reserve(source_.vertex_count());
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      const auto first = static_cast<uint32_t>(vertices_.size());
      parts_[part].vertices_end = first;
      if (parts_[part].alone) continue;
      uint32_t places = 0;
      uint64_t hash = parts_[part].hash;
      for (uint32_t i = first_triangle(part); i < parts_[part].triangles_end; ++i)
        for (uint32_t c = triangles_[i] * 3; c < triangles_[i] * 3 + 3; ++c) {
          const uint32_t v = work_.attributes[c];
          if (twins_.local[v] == kNone) {
            twins_.local[v] = static_cast<uint32_t>(vertices_.size()) - first;
            vertices_.push_back(v);
            if (!source_.colors.empty()) hash = hash * 31 + std::bit_cast<uint32_t>(source_.colors[v]);
          }
          if (uint32_t& place = local_of_place_[work_.place[c]]; place == kNone) place = places++;
          hash = hash * 37 + twins_.local[v];
        }
      parts_[part].hash = scramble(hash);
      parts_[part].vertices_end = static_cast<uint32_t>(vertices_.size());
    }
  }

  void find_classes() {
    const size_t slots = std::bit_ceil(parts_.size() * 2 + 1);
    std::vector<uint32_t> table(slots, kNone);  // open addressing: originals
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      if (parts_[part].alone) continue;
      size_t slot = (parts_[part].hash >> 20U) & (slots - 1);
      for (uint32_t looks = 0;; slot = (slot + 1) & (slots - 1)) {
        if (table[slot] == kNone) {
          table[slot] = part;
          break;
        }
        const uint32_t original = table[slot];
        if (parts_[original].hash != parts_[part].hash) continue;
        if (++looks > kMostLooks) break;
        if (!are_twins(original, part)) continue;
        if (parts_[original].copies == kMostAlike - 1) {
          table[slot] = part;  // the next class
          break;
        }
        parts_[part].original = original;
        ++parts_[original].copies, ++copies_;
        break;
      }
    }
  }

  bool are_twins(uint32_t a, uint32_t b) const {
    const uint32_t triangles = parts_[a].triangles_end - first_triangle(a);
    const uint32_t vertices = parts_[a].vertices_end - first_vertex(a);
    if (triangles != parts_[b].triangles_end - first_triangle(b) ||
        vertices != parts_[b].vertices_end - first_vertex(b))
      return false;
    const uint32_t *of_a = &vertices_[first_vertex(a)], *of_b = &vertices_[first_vertex(b)];
    const glm::vec3 offset = offset_between(a, b);
    for (uint32_t i = 0; i < vertices; ++i) {
      const glm::vec3 off = source_.positions[of_b[i]] - source_.positions[of_a[i]] - offset;
      if (!(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= reach_m_)) return false;
      if (!source_.colors.empty() && source_.colors[of_a[i]] != source_.colors[of_b[i]]) return false;
      if (!source_.texcoords.empty() && source_.texcoords[of_a[i]] != source_.texcoords[of_b[i]]) return false;
      if (source_.normals.empty()) continue;
      const glm::vec3 turn = source_.normals[of_b[i]] - source_.normals[of_a[i]];
      if (!(glm::dot(turn, turn) <= kNormalReach * kNormalReach)) return false;
    }
    for (uint32_t i = 0; i < triangles; ++i) {
      const uint32_t ta = triangles_[first_triangle(a) + i], tb = triangles_[first_triangle(b) + i];
      if (source_.material_of(work_.source_triangle[ta]) != source_.material_of(work_.source_triangle[tb]))
        return false;
      for (uint32_t c = 0; c < 3; ++c)
        if (twins_.local[work_.attributes[ta * 3 + c]] != twins_.local[work_.attributes[tb * 3 + c]] ||
            local_of_place_[work_.place[ta * 3 + c]] != local_of_place_[work_.place[tb * 3 + c]])
          return false;
    }
    return true;
  }

  glm::vec3 offset_between(uint32_t a, uint32_t b) const {
    return source_.positions[vertices_[first_vertex(b)]] - source_.positions[vertices_[first_vertex(a)]];
  }

  void list_copies() {
    std::vector<uint32_t> class_of_part(parts_.size(), kNone);
    uint32_t copies = 0;
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      if (parts_[part].copies == 0) continue;
      class_of_part[part] = static_cast<uint32_t>(twins_.first_copy.size() - 1);
      twins_.first_copy.push_back(copies += parts_[part].copies);
    }
    std::vector<uint32_t> next(twins_.first_copy.begin(), twins_.first_copy.end() - 1);
    twins_.copies.resize(copies);
    for (uint32_t part = 0; part < parts_.size(); ++part)
      if (const uint32_t original = parts_[part].original; original != kNone)
        twins_.copies[next[class_of_part[original]]++] = {offset_between(original, part), first_vertex(part)};
    for (uint32_t t = 0; t < work_.triangle_count(); ++t)
      twins_.class_of_triangle[t] = class_of_part[part_of_triangle_[t]];
    twins_.vertices = std::move(vertices_);
  }

  bool is_copy(uint32_t part) const { return part != kNone && parts_[part].original != kNone; }

  /// Leaves copies out of the work mesh: what remains moves up.
  void reduce() {
    std::vector<uint32_t> place_in_rest(work_.place_count(), kNone);
    uint32_t places = 0;
    for (uint32_t p = 0; p < work_.place_count(); ++p) {
      if (is_copy(part_of_place_[p])) continue;
      work_.positions[places] = work_.positions[p], work_.model_positions[places] = work_.model_positions[p];
      place_in_rest[p] = places++;
    }
    work_.positions.resize(places), work_.model_positions.resize(places);
    work_.first_corner.assign(places, kNone);
    work_.merged_into.resize(places);
    uint32_t triangles = 0;
    for (uint32_t t = 0; t < work_.triangle_count(); ++t) {
      const uint32_t part = part_of_triangle_[t];
      if (is_copy(part)) continue;
      twins_.class_of_triangle[triangles] = twins_.class_of_triangle[t];
      work_.source_triangle[triangles] = work_.source_triangle[t];
      work_.alive[triangles] = static_cast<uint8_t>(1 + parts_[part].copies);
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t place = place_in_rest[work_.place[t * 3 + c]], corner = triangles * 3 + c;
        work_.place[corner] = place, work_.attributes[corner] = work_.attributes[t * 3 + c];
        work_.next_corner[corner] = work_.first_corner[place];
        work_.first_corner[place] = corner;
      }
      ++triangles;
    }
    work_.place.resize(size_t(triangles) * 3), work_.attributes.resize(size_t(triangles) * 3);
    work_.next_corner.resize(size_t(triangles) * 3);
    work_.source_triangle.resize(triangles), work_.alive.resize(triangles);
    work_.alive_count = triangles;  // and they stand for as many as before
    twins_.class_of_triangle.resize(triangles);
  }

  WorkMesh& work_;
  const Mesh& source_;
  float reach_m_ = 0;  // along each axis
  std::vector<Part> parts_;
  std::vector<uint32_t> part_of_triangle_, part_of_place_;
  std::vector<uint32_t> triangles_;  // by part
  std::vector<uint32_t> vertices_;   // by part
  std::vector<uint32_t> local_of_place_;
  uint32_t copies_ = 0;
  Twins twins_;
};

}  // namespace

Twins take_twins(WorkMesh& work, const Mesh& source, const std::function<bool(uint32_t place)>& stays_alone) {
  return TwinFinder(work, source).run(stays_alone);
}

}  // namespace promenade
