#pragma once
// Meshes built from simple shapes: what the city's buildings and ground are made of.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

using Color = glm::u8vec4;

/// Materials of every city file, in this order; textured walls come after them.
constexpr uint32_t kOpaque = 0, kGlass = 1;
/// Stands for the building's own material until its picture is there.
constexpr uint32_t kTexturedWall = 0xfffffff0;

/// sRGB, opaque.
constexpr Color rgb(int r, int g, int b) {
  return {static_cast<uint8_t>(r), static_cast<uint8_t>(g), static_cast<uint8_t>(b), 255};
}
/// The colour times a factor, clamped.
Color shade(const Color& color, float factor);
Color blend(const Color& a, const Color& b, float t);

/// A right-handed frame on a wall: x along it, y out of it, z up.
struct WallFrame {
  glm::vec2 origin{0}, along{1, 0}, out{0, -1};
  /// From a to b, the outside to the right of the way (polygons are counter-clockwise).
  static WallFrame between(const glm::vec2& a, const glm::vec2& b);
  glm::vec3 at(float x, float y, float z) const { return {origin + along * x + out * y, z}; }
};

/// A mesh being built, without normals (every face is flat), with a colour per vertex. In counting mode it only counts
/// triangles: the same code that builds then says cheaply how much it would build.
class Shape {
 public:
  explicit Shape(bool counting = false) : counting_(counting) {}

  bool counting() const { return counting_; }
  uint64_t triangles() const { return triangles_; }
  /// What comes next has this colour, material.
  void color(const Color& color) { color_ = color; }
  void material(uint32_t material) { material_ = material; }
  /// From now on vertices carry texture coordinates.
  void enable_texcoords() { with_texcoords_ = true; }

  uint32_t vertex(const glm::vec3& p, const glm::vec2& texcoord = glm::vec2(0));
  void triangle(uint32_t a, uint32_t b, uint32_t c);
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) { triangle(a, b, c), triangle(a, c, d); }
  /// A quad with corners of its own, counter-clockwise seen from its front.
  void face(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);
  void face(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

  /// Box sides that box() leaves out.
  enum Side : uint32_t { none = 0, bottom = 1, top = 2, back = 4 };
  /// An upright box in a wall's frame, [low, high] along x, y, z. back: towards the wall (low y).
  void box(const WallFrame& frame, const glm::vec3& low, const glm::vec3& high, uint32_t without = Side::none);
  /// Axis-aligned.
  void box(const glm::vec3& low, const glm::vec3& high, uint32_t without = Side::none) {
    box(WallFrame{{0, 0}, {1, 0}, {0, 1}}, low, high, without);
  }
  /// A profile of (outset, z) points, bottom to top, swept around a counter-clockwise polygon with mitred corners.
  void ring(std::span<const glm::vec2> polygon, std::span<const glm::vec2> profile);
  /// A horizontal polygon, by ear clipping, facing up.
  void cap(std::span<const glm::vec2> polygon, float z);
  /// A cone or pyramid over a polygon.
  void spire(std::span<const glm::vec2> polygon, float base_z, const glm::vec3& apex);
  /// An upright (truncated) cone, open at the bottom.
  void cylinder(const glm::vec3& center, float radius, float top_radius, float height, int sides);
  /// A surface between two lines of points; on the left of both lies the front when `a` is the outer one of two
  /// counter-clockwise rings.
  void stitch(std::span<const glm::vec3> a, std::span<const glm::vec3> b);

  Mesh take();

 private:
  bool counting_;
  bool with_texcoords_ = false;
  uint64_t triangles_ = 0;
  Color color_{255, 255, 255, 255};
  uint32_t material_ = 0;
  Mesh mesh_;
};

/// Twice the signed area of a triangle; positive: counter-clockwise.
float cross(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);
/// Signed area; positive: counter-clockwise.
float area_of(std::span<const glm::vec2> polygon);
glm::vec2 centroid_of(std::span<const glm::vec2> polygon);
/// The polygon with each edge moved outwards by `by` (inwards when negative), corners mitred.
std::vector<glm::vec2> outset(std::span<const glm::vec2> polygon, float by);
/// Triangles of a simple polygon, by ear clipping.
std::vector<uint32_t> triangulated(std::span<const glm::vec2> polygon);

}  // namespace promenade
