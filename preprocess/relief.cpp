#include "preprocess/relief.h"

#include <algorithm>
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
    bool is_new = false;  // since reliefs were last taken down
  };

  void find_faces() {
    const auto triangles = static_cast<uint32_t>(work_.triangle_count());
    cross_.resize(triangles);
    area_.assign(triangles, 0);
    std::vector<uint32_t> order;
    order.reserve(triangles);
    for (uint32_t t = 0; t < triangles; ++t) {
      const glm::vec3 a = work_.at(3 * t), b = work_.at(3 * t + 1), c = work_.at(3 * t + 2);
      const glm::vec3 cross = glm::cross(b - a, c - a);
      const float area = glm::length(cross);
      const float edge2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
      if (work_.alive[t] == 0 || !(area > kThin * edge2)) continue;
      cross_[t] = cross / area, area_[t] = area;
      order.push_back(t);
    }
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return area_[a] != area_[b] ? area_[a] > area_[b] : a < b; });
    face_of_.assign(triangles, kNone);
    for (const uint32_t seed : order)
      if (face_of_[seed] == kNone) grow(seed);
  }

  void grow(uint32_t seed) {
    const auto number = static_cast<uint32_t>(faces_.size());
    Face face{cross_[seed], work_.at(3 * seed)};
    const float tolerance_m = kFlatShare * std::sqrt(area_[seed]);
    stack_.assign(1, seed);
    face_of_[seed] = number;
    while (!stack_.empty()) {
      const uint32_t t = stack_.back();
      stack_.pop_back();
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
    faces_.push_back(face);
  }

  /// Between faces that look the same way: edges that lead from one to the other.
  void find_steps() {
    Box box;
    for (const glm::vec3& p : work_.positions) box.add(p);
    const float least_area = 2 * kLeastFace * box.diagonal() * box.diagonal();
    std::vector<uint8_t> at_large(work_.place_count(), 0);  // whether a large face has the place
    for (uint32_t corner = 0; corner < work_.place.size(); ++corner)
      if (const uint32_t face = face_of_[corner / 3]; face != kNone && faces_[face].area >= least_area)
        at_large[work_.place[corner]] = 1;
    std::vector<uint32_t> at_from, at_to;
    const auto faces_at = [&](uint32_t place, std::vector<uint32_t>& faces) {
      faces.clear();
      for (uint32_t c = work_.first_corner[place]; c != kNone; c = work_.next_corner[c])
        if (const uint32_t face = face_of_[c / 3];
            face != kNone && std::find(faces.begin(), faces.end(), face) == faces.end())
          faces.push_back(face);
    };
    for (uint32_t corner = 0; corner < work_.place.size(); ++corner) {
      const uint32_t from = work_.place[corner], to = work_.place[next_in_triangle(corner)];
      if (from > to || work_.alive[corner / 3] == 0) continue;  // the same edge has another triangle, or is open
      if (at_large[from] == 0 && at_large[to] == 0) continue;
      faces_at(from, at_from);
      faces_at(to, at_to);
      const glm::vec3 along = work_.positions[to] - work_.positions[from];
      for (const uint32_t a : at_from)
        for (const uint32_t b : at_to) {
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
    for (uint32_t f = 0; f < faces_.size(); ++f) {
      const float off_m = glm::dot(faces_[f].at, faces_[f].normal);
      groups_.push_back({f, faces_[f].normal, faces_[f].area, off_m, off_m});
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
      into.is_new = true, from.is_new = false;
    }
    take_down();
  }

  /// The groups that have grown, as reliefs.
  void take_down() {
    std::vector<uint32_t> relief_of(faces_.size(), kNone);
    const size_t first = reliefs_.size();
    for (uint32_t f = 0; f < faces_.size(); ++f) {
      Group& group = groups_[f];
      if (!group.is_new || group.parent != f) continue;
      group.is_new = false;
      if (group.high_m - group.low_m > most_depth_m_) continue;
      relief_of[f] = static_cast<uint32_t>(reliefs_.size());
      reliefs_.push_back({group.normal, group.low_m, group.high_m, {}});
    }
    if (reliefs_.size() == first) return;
    for (uint32_t t = 0; t < face_of_.size(); ++t) {
      if (face_of_[t] == kNone) continue;
      const uint32_t relief = relief_of[root_of(face_of_[t])];
      if (relief == kNone) continue;
      for (uint32_t c = 3 * t; c < 3 * t + 3; ++c) reliefs_[relief].places.push_back(work_.place[c]);
    }
    for (size_t i = first; i < reliefs_.size(); ++i) {
      std::vector<uint32_t>& places = reliefs_[i].places;
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
    }
  }

  const WorkMesh& work_;
  const float most_depth_m_;
  std::vector<glm::vec3> cross_;   // of each triangle: its normal
  std::vector<float> area_;        // doubled; 0: thin or not alive
  std::vector<uint32_t> face_of_;  // of each triangle
  std::vector<Face> faces_;
  std::vector<Step> steps_;
  std::vector<Group> groups_;  // by face
  std::vector<Relief> reliefs_;
  std::vector<uint32_t> stack_;
};

}  // namespace

std::vector<Relief> find_reliefs(const WorkMesh& work, float most_depth_m) {
  return ReliefFinder(work, most_depth_m).run();
}

}  // namespace promenade
