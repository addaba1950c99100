#pragma once
// A mesh on its way down: triangles between places, each corner with the attributes that it shows.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Corners are numbered 3 * triangle + 0..2. Positions are relative to `origin`, so that quadrics keep their precision.
struct WorkMesh {
  static constexpr uint32_t kNone = 0xffffffffU;

  glm::vec3 origin{0};
  float diagonal_m = 0;                    ///< of the whole surface's box
  std::vector<glm::vec3> positions;        ///< of each place
  std::vector<glm::vec3> model_positions;  ///< of each place, as the source has them, bit by bit
  std::vector<uint32_t> place;             ///< of each corner
  std::vector<uint32_t> attributes;        ///< of each corner: the source vertex whose attributes it shows
  std::vector<uint32_t> source_triangle;   ///< of each triangle
  std::vector<uint8_t> alive;              ///< of each triangle: how many it stands for, itself and copies; 0: gone
  std::vector<uint32_t> first_corner;      ///< of each place: a chain of corners, dead triangles' among them
  std::vector<uint32_t> next_corner;       ///< of each corner
  std::vector<uint32_t> merged_into;       ///< of each place: where it went, or itself
  uint32_t alive_count = 0;                ///< triangles that are
  uint32_t shown_count = 0;                ///< triangles that they stand for

  size_t triangle_count() const { return alive.size(); }
  size_t place_count() const { return positions.size(); }
  glm::vec3 at(uint32_t corner) const { return positions[place[corner]]; }

  /// Where a place has gone in the end.
  uint32_t current(uint32_t p) {
    while (merged_into[p] != p) p = merged_into[p] = merged_into[merged_into[p]];
    return p;
  }

  void kill(uint32_t triangle) {
    alive_count -= alive[triangle] != 0 ? 1U : 0U;
    shown_count -= alive[triangle];
    alive[triangle] = 0;
  }
  /// A triangle that is alive stands for one less.
  void drop_copy(uint32_t triangle) {
    if (alive[triangle] == 1) return kill(triangle);
    --alive[triangle], --shown_count;
  }
};

/// Places for positions; triangles with two corners in one place and repeated triangles left out.
WorkMesh make_work_mesh(const Mesh& mesh);

/// The triangles still alive, in source order, as a mesh again. Normals that point away from the front of what their
/// triangle has become are replaced by its own.
Mesh finish(const WorkMesh& work, const Mesh& source);

/// How differently two sRGB colours look: 0 the same, 1 black and white.
float color_contrast(const glm::u8vec4& a, const glm::u8vec4& b);

}  // namespace promenade
