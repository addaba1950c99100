#pragma once
// Parametric solids out of which the generators carve their objects.

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// sRGB from 0xrrggbb.
constexpr glm::u8vec4 rgb(uint32_t hex) {
  return {static_cast<uint8_t>(hex >> 16U), static_cast<uint8_t>(hex >> 8U), static_cast<uint8_t>(hex), 255};
}

/// c lightened (amount > 0, towards white) or darkened (< 0, towards black); amount in [-1, 1].
glm::u8vec4 shaded(glm::u8vec4 c, double amount);

glm::dmat4 moved(const glm::dvec3& by);
/// Counter-clockwise about the z axis, seen from above; about x: y turns towards z.
glm::dmat4 turned_z(double degrees);
glm::dmat4 turned_x(double degrees);

/// Triangles (three corners each, counter-clockwise) of a simple polygon with holes, without new points. Corner i <
/// outer.size() is outer[i], those after it are the holes' in order. outer is counter-clockwise, holes clockwise, and
/// no two of them touch. Ear clipping after bridging the holes: cubic, for up to a hundred corners.
std::vector<uint32_t> triangulate(std::span<const glm::dvec2> outer, std::span<const std::vector<glm::dvec2>> holes);

/// Grows one mesh with normals and colours out of parts. Each part is a closed surface, outward wound, whose corners
/// repeat bit by bit where its faces meet. Metres, z up. One thread.
class Sculptor {
 public:
  /// quality multiplies every tessellation; 1 is the designer's choice.
  explicit Sculptor(double quality) : quality_(quality) {}

  /// How many steps to take where at_one would do at quality 1.
  uint32_t steps(double at_one, uint32_t least) const;
  double quality() const { return quality_; }

  /// What colour the parts that follow have.
  Sculptor& paint(glm::u8vec4 color);
  /// Where the parts that follow stand.
  Sculptor& stand(const glm::dmat4& mesh_from_part);
  Sculptor& stand() { return stand(glm::dmat4(1)); }

  void box(const glm::dvec3& min, const glm::dvec3& max);
  /// Edges rounded by radius in arcs of `arc` steps (0: a plain box); radius at most half of the shortest side.
  void rounded_box(const glm::dvec3& min, const glm::dvec3& max, double radius, uint32_t arc);
  /// A frustum of a cone between two points; either radius may be 0.
  void cone(const glm::dvec3& from, const glm::dvec3& to, double radius_from, double radius_to, uint32_t sides);
  void cylinder(const glm::dvec3& from, const glm::dvec3& to, double radius, uint32_t sides) {
    cone(from, to, radius, radius, sides);
  }
  void ellipsoid(const glm::dvec3& center, const glm::dvec3& radii, uint32_t sides, uint32_t rings);
  /// Turns (radius, z) points about the z axis. The profile runs upwards along the outside. Open, from axis to axis (a
  /// solid), or a closed counter-clockwise loop away from the axis (a ring). Smooth where it bends less than 40
  /// degrees.
  void lathe(std::span<const glm::dvec2> profile, bool ring, uint32_t sides);
  /// Sweeps a circle along points; capped flat at both ends. No two successive points are the same.
  void tube(std::span<const glm::dvec3> points, double radius, uint32_t sides);
  /// A polygon (counter-clockwise from above, holes clockwise) between two heights. top, bottom: own colours for these
  /// faces instead of the paint.
  void extrude(std::span<const glm::dvec2> outer, std::span<const std::vector<glm::dvec2>> holes, double z0, double z1,
               const glm::u8vec4* top = nullptr, const glm::u8vec4* bottom = nullptr);
  /// A pointed leaf, `thickness` at its rib, along points; side[i] points from the rib to the right edge (its length is
  /// the half width). The widths at both ends count as 0. At least 3 points.
  void leaf(std::span<const glm::dvec3> points, std::span<const glm::dvec3> side, double thickness);

  /// The mesh so far; the sculptor is empty after it.
  Mesh take();

 private:
  uint32_t vertex(const glm::dvec3& p, const glm::dvec3& n);
  void triangle(uint32_t a, uint32_t b, uint32_t c);
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) { triangle(a, b, c), triangle(a, c, d); }
  void flat_quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

  double quality_;
  glm::u8vec4 color_{255};
  glm::dmat4 frame_{1};
  glm::dmat3 normal_frame_{1};
  bool mirrors_ = false;
  Mesh mesh_;
};

}  // namespace promenade
