#include "preprocess/relief.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "geometry/box.h"

namespace promenade {

namespace {

constexpr uint32_t kNone = WorkMesh::kNone;
/// Cosine between the triangles of a face, and between faces that look the same way.
constexpr float kFlatCosine = 0.999F;
/// How far a face's triangles may be from its plane, to the side of a square as large as its largest triangle.
constexpr float kFlatShare = 2e-3F;
/// Steps that differ by less than this factor count as equally high.
constexpr float kStepFactor = 1.2F;

/// Of the surface's diagonal, squared, what a relief's largest face has at least: smaller ones are not worth the time.
constexpr float kLeastFace = 2.5e-4F;

/// A triangle's height over its longest edge: flatter ones lie in no plane to speak of.
constexpr float kThin = 1e-3F;

/// Triangles side by side in one plane.
struct Face {
  glm::vec3 normal;
  glm::vec3 at;
  float area = 0;  // doubled
  uint32_t end;    // of its triangles in triangles_; they begin where those of the face before it end
};

struct Step {
  float height_m;
  uint32_t a, b;  // faces
};

class ReliefFinder {
 public:
  ReliefFinder(const WorkMesh& work, float most_depth_m) : work_(work), most_depth_m_(most_depth_m) {}

  std::vector<Relief> run() {
    find_faces();
    find_steps();
    if (steps_.empty()) return {};
    join_faces();
    return std::move(reliefs_);
  }

 private:
  /// Faces joined so far.
  struct Group {
    uint32_t parent;
    glm::vec3 normal;
    float area;
    float low_m, high_m;
    uint32_t last;        // of its faces, which are chained
    bool is_new = false;  // since reliefs were last taken down
  };

  void find_faces() {
    const auto triangles = static_cast<uint32_t>(work_.triangle_count());
    cross_.resize(triangles);
    area_.assign(triangles, 0);
    std::vector<uint64_t> order;  // the largest first, ties by number: how much smaller than any, number
    order.reserve(triangles);
    for (uint32_t t = 0; t < triangles; ++t) {
      const glm::vec3 a = work_.at(3 * t), b = work_.at(3 * t + 1), c = work_.at(3 * t + 2);
      const glm::vec3 cross = glm::cross(b - a, c - a);
      const float area = glm::length(cross);
      const float edge2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
      if (work_.alive[t] == 0 || !(area > kThin * edge2)) continue;
      cross_[t] = cross / area, area_[t] = area;
      order.push_back(uint64_t(~std::bit_cast<uint32_t>(area)) << 32U | t);  // positive floats sort as their bits do
    }
    std::sort(order.begin(), order.end());
    face_of_.assign(triangles, kNone);
    for (const uint64_t key : order)
      if (const auto seed = static_cast<uint32_t>(key); face_of_[seed] == kNone) grow(seed);
  }

  void grow(uint32_t seed) {
    const auto number = static_cast<uint32_t>(faces_.size());
    Face face{cross_[seed], work_.at(3 * seed), 0, 0};
    const float tolerance_m = kFlatShare * std::sqrt(area_[seed]);
    stack_.assign(1, seed);
    face_of_[seed] = number;
    while (!stack_.empty()) {
      const uint32_t t = stack_.back();
      stack_.pop_back();
      triangles_.push_back(t);
      face.area += area_[t];
      for (uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
        const uint32_t to = work_.place[next_in_triangle(corner)];
        for (uint32_t c = work_.first_corner[work_.place[corner]]; c != kNone; c = work_.next_corner[c]) {
          const uint32_t t2 = c / 3;
          if (face_of_[t2] != kNone || !(area_[t2] > 0)) continue;
          if (work_.place[next_in_triangle(c)] != to && work_.place[previous_in_triangle(c)] != to) continue;
          if (glm::dot(cross_[t2], face.normal) < kFlatCosine) continue;
          float off_m = 0;
          for (uint32_t c2 = 3 * t2; c2 < 3 * t2 + 3; ++c2)
            off_m = std::max(off_m, std::abs(glm::dot(work_.at(c2) - face.at, face.normal)));
          if (off_m > tolerance_m) continue;
          face_of_[t2] = number;
          stack_.push_back(t2);
        }
      }
    }
    face.end = static_cast<uint32_t>(triangles_.size());
    faces_.push_back(face);
  }

  /// Between faces that look the same way: edges that lead from one to the other.
  void find_steps() {
    const float least_area = 2 * kLeastFace * work_.diagonal_m * work_.diagonal_m;
    std::vector<uint8_t> at_large(work_.place_count(), 0);  // whether a large face has the place
    for (uint32_t corner = 0; corner < work_.place.size(); ++corner)
      if (const uint32_t face = face_of_[corner / 3]; face != kNone && faces_[face].area >= least_area)
        at_large[work_.place[corner]] = 1;
    std::vector<uint32_t> faces;                                                      // at places, one after the other
    std::vector<std::array<uint32_t, 2>> range(work_.place_count(), {kNone, kNone});  // of a place's, once it was asked
    const auto faces_at = [&](uint32_t place) {
      if (range[place][0] != kNone) return range[place];
      const auto begin = static_cast<uint32_t>(faces.size());
      for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c])
        if (const uint32_t face = face_of_[c / 3];
            face != kNone && std::find(faces.begin() + begin, faces.end(), face) == faces.end())
          faces.push_back(face);
      return range[place] = {begin, static_cast<uint32_t>(faces.size())};
    };
    for (uint32_t corner = 0; corner < work_.place.size(); ++corner) {
      const uint32_t from = work_.place[corner], to = work_.place[next_in_triangle(corner)];
      if (from > to || work_.alive[corner / 3] == 0) continue;  // the same edge has another triangle, or is open
      if (at_large[from] == 0 && at_large[to] == 0) continue;
      const std::array<uint32_t, 2> at_from = faces_at(from), at_to = faces_at(to);
      const glm::vec3 along = work_.positions[to] - work_.positions[from];
      for (uint32_t i = at_from[0]; i < at_from[1]; ++i)
        for (uint32_t j = at_to[0]; j < at_to[1]; ++j) {
          const uint32_t a = faces[i], b = faces[j];
          if (a == b || std::max(faces_[a].area, faces_[b].area) < least_area) continue;
          if (glm::dot(faces_[a].normal, faces_[b].normal) < kFlatCosine) continue;
          const float height_m = std::abs(glm::dot(along, faces_[faces_[a].area >= faces_[b].area ? a : b].normal));
          if (height_m <= most_depth_m_) steps_.push_back({height_m, std::min(a, b), std::max(a, b)});
        }
    }
    std::sort(steps_.begin(), steps_.end(), [](const Step& l, const Step& r) {
      return l.height_m != r.height_m ? l.height_m < r.height_m : l.a != r.a ? l.a < r.a : l.b < r.b;
    });
  }

  uint32_t root_of(uint32_t face) {
    while (groups_[face].parent != face) face = groups_[face].parent = groups_[groups_[face].parent].parent;
    return face;
  }

  void join_faces() {
    groups_.reserve(faces_.size());
    next_face_.assign(faces_.size(), kNone);
    for (uint32_t f = 0; f < faces_.size(); ++f) {
      const float off_m = glm::dot(faces_[f].at, faces_[f].normal);
      groups_.push_back({f, faces_[f].normal, faces_[f].area, off_m, off_m, f});
    }
    float lowest_m = steps_.front().height_m;
    for (const Step& step : steps_) {
      if (step.height_m > kStepFactor * lowest_m) take_down(), lowest_m = step.height_m;
      const uint32_t a = root_of(step.a), b = root_of(step.b);
      if (a == b || glm::dot(groups_[a].normal, groups_[b].normal) < kFlatCosine) continue;
      const bool first = groups_[a].area >= groups_[b].area;
      Group &into = groups_[first ? a : b], &from = groups_[first ? b : a];
      const float off_m = glm::dot(faces_[first ? step.b : step.a].at, into.normal);
      from.parent = first ? a : b;
      into.area += from.area;
      const float shift_m = off_m - glm::dot(faces_[first ? step.b : step.a].at, from.normal);
      into.low_m = std::min(into.low_m, from.low_m + shift_m),
      into.high_m = std::max(into.high_m, from.high_m + shift_m);
      next_face_[into.last] = from.parent == a ? b : a;
      into.last = from.last;
      if (!into.is_new) new_groups_.push_back(from.parent);
      into.is_new = true, from.is_new = false;
    }
    take_down();
  }

  /// The groups that have grown, as reliefs.
  void take_down() {
    std::sort(new_groups_.begin(), new_groups_.end());
    for (const uint32_t f : new_groups_) {
      Group& group = groups_[f];
      if (!group.is_new) continue;
      group.is_new = false;
      if (group.high_m - group.low_m > most_depth_m_) continue;
      reliefs_.push_back({group.normal, group.low_m, group.high_m, {}});
      std::vector<uint32_t>& places = reliefs_.back().places;
      for (uint32_t face = f; face != kNone; face = next_face_[face])
        for (uint32_t i = face == 0 ? 0 : faces_[face - 1].end; i < faces_[face].end; ++i)
          for (uint32_t c = 3 * triangles_[i]; c < 3 * triangles_[i] + 3; ++c) places.push_back(work_.place[c]);
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
    }
    new_groups_.clear();
  }

  const WorkMesh& work_;
  const float most_depth_m_;
  std::vector<glm::vec3> cross_;   // of each triangle: its normal
  std::vector<float> area_;        // doubled; 0: thin or not alive
  std::vector<uint32_t> face_of_;  // of each triangle
  std::vector<Face> faces_;
  std::vector<uint32_t> triangles_;  // by face
  std::vector<Step> steps_;
  std::vector<Group> groups_;         // by face
  std::vector<uint32_t> next_face_;   // in the same group
  std::vector<uint32_t> new_groups_;  // and some that have gone into others since
  std::vector<Relief> reliefs_;
  std::vector<uint32_t> stack_;
};

}  // namespace

std::vector<Relief> find_reliefs(const WorkMesh& work, float most_depth_m) {
  return ReliefFinder(work, most_depth_m).run();
}

}  // namespace promenade
