#pragma once
// Edge collapse: the cheapest way to move one place onto a neighbouring one.

#include <array>
#include <cstdint>
#include <vector>

#include "preprocess/quadric.h"
#include "preprocess/work_mesh.h"

namespace promenade {

/// Half-edge collapses on a work mesh: a place goes, its triangles move to a neighbour. What remains are the source's
/// own places, so flat walls stay flat, corners sharp and attributes exact. Costs are in metres: the root of the mean
/// squared distance from the target to the planes that the two places stand for. Planes across open edges, and across
/// edges where material or colour changes, keep outlines in place.
class Collapser {
 public:
  /// locked: of each place; those never go, but others may go onto them. cell_faces: of each place, bits of the cell's
  /// faces that it lies on (see simplify.cpp): edges along a face are held in it firmly.
  Collapser(WorkMesh& work, const Mesh& source, const std::vector<uint8_t>& cell_faces);

  void set_locked(std::vector<uint8_t> locked) { locked_ = std::move(locked); }
  /// Whether triangles may turn over: for when nothing else is left.
  void allow_flips(bool allowed) { flips_allowed_ = allowed; }

  struct Choice {
    uint32_t target = WorkMesh::kNone;  ///< kNone: the place cannot go
    float cost_m = 0;
  };
  /// The cheapest target, not looking whether triangles would flip.
  Choice cheapest(uint32_t place);
  /// The cheapest target at which none does.
  Choice cheapest_sound(uint32_t place);
  bool is_sound(uint32_t place, uint32_t target);

  /// Triangles that a collapse would take away.
  uint32_t triangles_between(uint32_t place, uint32_t target) const;

  void collapse(uint32_t place, uint32_t target);

  /// Places that share a triangle with this one, each once. Valid until the next call.
  const std::vector<uint32_t>& neighbours(uint32_t place);

 private:
  void add_triangle_planes();
  void add_edge_planes(const std::vector<uint8_t>& cell_faces);
  float cost(uint32_t place, uint32_t target) const;
  void unlink_dead(uint32_t place);
  bool has_twin(uint32_t corner, uint32_t target) const;

  WorkMesh& work_;
  const Mesh& source_;
  std::vector<Quadric> quadrics_;
  std::vector<uint8_t> locked_;
  std::vector<uint32_t> seen_in_;  // of each place: the walk that met it last
  uint32_t walk_ = 0;
  std::vector<uint32_t> ring_;
  std::vector<Choice> choices_;
  bool flips_allowed_ = false;
};

}  // namespace promenade
