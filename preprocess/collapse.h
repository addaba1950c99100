#pragma once
// Edge collapse: the cheapest way to move one place onto a neighbouring one, its cost measured.

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle_kernels.h"
#include "preprocess/border_lines.h"
#include "preprocess/work_mesh.h"

namespace promenade {

/// Half-edge collapses on a work mesh: a place goes, its triangles move to a neighbour. What remains are the source's
/// own places, unless they are told to move: so flat walls stay flat, corners sharp and attributes exact.
///
/// Costs are distances in metres, in two steps. The estimate looks at planes: how far the target lies from those of the
/// triangles that move, and from the lines of open edges and of edges where material or colour changes. The measurement
/// looks at points: every place of the source is kept as a point on the triangle nearest to it, so are points along its
/// long creases, and a collapse costs the largest distance at which it leaves a point from the triangles around. So
/// errors never add up unseen, as they do in quadrics, and planes that are gone forbid nothing.
class Collapser {
 public:
  /// borders: outlives the collapser, which changes it; what it passes by is held firmly.
  /// spacing_m: between points on open edges and creases, > 0: a ledge's ends may come to lie on other walls while its
  /// middle hangs in the air. Smaller: errors closer to the costs; slower.
  Collapser(WorkMesh& work, const Mesh& source, BorderLines& borders, float spacing_m);

  /// What places on borders may do: stay, though others may go onto them; go along the border, but for those at its
  /// ends and where several meet; or go anywhere. What has gone elsewhere is no border any more.
  enum class BorderRule : uint8_t { stay, along, free };
  void set_border_rule(BorderRule rule) { border_rule_ = rule; }
  /// Whether triangles may turn over: for when nothing else is left.
  void allow_flips(bool allowed) { flips_allowed_ = allowed; }

  /// Estimate for the cheapest target of a place, in metres; infinite if it cannot go. Looks at planes only.
  float estimate(uint32_t place);

  /// The same as if all triangles had one colour: what it costs where a patch has been lifted off.
  float estimate_colorless(uint32_t place);

  struct Choice {
    uint32_t target = WorkMesh::kNone;  ///< kNone: the place cannot go
    float cost_m = 0;                   ///< measured; at least this, or estimated, where it is over the limit
    float firm_m = 0;                   ///< no more than the cost: less where only triangles that would flip forbid it
  };
  /// The target at which no triangle flips and the measured cost is least. Stops looking closer at costs over
  /// `limit_m`.
  Choice choose(uint32_t place, float limit_m);

  /// Triangles that a collapse would take away.
  uint32_t triangles_between(uint32_t place, uint32_t target) const;

  /// Does what choose() chose last, for the same place.
  void collapse(uint32_t place, uint32_t target);

  /// Places that share a triangle with the place that choose() was last asked about, each once.
  void chosen_ring(std::vector<uint32_t>& ring) const;

  /// Moves places, unless that leaves a point farther than limit_m from the triangle that it is on. Returns the largest
  /// such distance, or less, over the limit, where nothing has moved. places: each once; to: of each of them.
  float move(const std::vector<uint32_t>& places, const std::vector<glm::vec3>& to, float limit_m);

  /// Collapses a place onto another in the same position that it shares a triangle with.
  void merge(uint32_t place, uint32_t target);

  /// For each point the triangle nearest to it around the place of the same index; kNone where there are none. Returns
  /// the largest distance. Quicker where neighbours in the lists have the same place.
  float nearest_around(const std::vector<glm::vec3>& points, const std::vector<uint32_t>& places,
                       std::vector<uint32_t>& triangles);
  /// Gives a point to a triangle. It counts in later costs.
  void add_point(const glm::vec3& point, uint32_t triangle);

  /// The points on a triangle: appended to `points`.
  void points_on(uint32_t triangle, std::vector<glm::vec3>& points) const;

 private:
  static constexpr size_t kAtOnce = 4;  // targets that are estimated
  /// A line that the place had better not leave.
  struct Line {
    glm::vec3 direction;
    float weight;
  };
  struct Neighbour {
    uint32_t place;
    uint32_t corner;  // of the place in the middle, in one triangle with the neighbour
    uint32_t triangles;
    float contrast;
  };

  bool is_crease(uint32_t corner) const;
  void add_points_along(uint32_t corner, float spacing_m);
  void find_ring(uint32_t place);
  void find_lines(uint32_t place);
  bool may_go(uint32_t place);
  bool goes_along_border(uint32_t place) const;
  void estimate_ring(uint32_t place);
  float least_estimate(uint32_t place);
  bool is_sound(uint32_t place, uint32_t target) const;
  uint32_t find_twin(uint32_t corner, uint32_t target) const;
  void move_corner(uint32_t corner, uint32_t target);
  void unlink_dead(uint32_t place);
  void set_normal(uint32_t triangle);

  struct Moved {
    uint32_t point;
    uint32_t triangle;
  };
  /// Largest distance of the points around `place` to what the collapse would leave; stops over the limit.
  float measure(uint32_t place, uint32_t target, float limit_m, std::vector<Moved>& moved);
  void gather_candidates(uint32_t place, uint32_t target);
  void make_frames();
  void add_candidate(uint32_t triangle, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
  void gather_around(uint32_t place);
  uint32_t nearest_candidate(const glm::vec3& point, float& distance2) const;
  float farthest2_on(uint32_t triangle);
  void attach(uint32_t point, uint32_t triangle);

  WorkMesh& work_;
  const Mesh& source_;
  const TriangleKernels& kernels_ = triangle_kernels();
  BorderLines& borders_;
  BorderRule border_rule_ = BorderRule::along;
  std::vector<glm::vec3> normals_;  // of each triangle; 0 where it has none
  std::vector<glm::vec3> points_;
  std::vector<uint32_t> next_point_;
  std::vector<uint32_t> first_point_;  // of each triangle
  bool flips_allowed_ = false;

  // Scratch, kept to spare allocations.
  struct Seen {
    uint32_t walk, index;
  };
  std::vector<Seen> seen_;  // of each place: its index in ring_, if the walk is the current one
  uint32_t walk_ = 0;
  std::vector<Neighbour> ring_;
  std::vector<Line> lines_;
  std::vector<uint32_t> fan_;  // the place's corners in living triangles
  struct alignas(16) Estimates : std::array<float, kAtOnce> {};
  std::vector<Estimates> estimates_;  // for ring_, four by four
  std::vector<Choice> choices_;
  std::vector<TriangleCorners> corners_;
  std::vector<TriangleFrames> frames_;  // of the same triangles
  std::vector<uint32_t> candidates_;
  std::vector<Moved> moved_, best_moved_;
  std::vector<uint32_t> changed_;               // triangles
  std::vector<glm::vec3> from_;                 // where places were before a move
  std::vector<std::array<uint32_t, 2>> leads_;  // attributes of the place, those of the target
  std::vector<std::array<uint32_t, 2>> twins_;  // triangles gone, and those that lie there
};

}  // namespace promenade
