#pragma once
// What solid boxes hide from an eye: pictures of boxes along the axes on the faces of a cube about it.
//
// Seen on a face whose axis is x, a box is all (u, v) with y0 s <= u <= y1 s, z0 s <= v <= z1 s for some s = 1 / depth
// between 1 / x1 and 1 / x0: everything about it is linear, nothing needs to be clipped, and each row of pixels has the
// pixels that lie wholly in the box's picture, or those that it touches, as an interval.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/box.h"
#include "preprocess/visibility/box_shadow.h"

namespace promenade {

/// One thread at a time; hides() any number.
class BoxView {
 public:
  static constexpr uint32_t kSidePx = 128;  // of a face of the cube
  /// Nearer things are seen.
  static constexpr double kNearM = 1e-3;
  static constexpr uint32_t kFaces = 6;

  BoxView();

  /// Begins a picture; want() all that will be asked about, then add() what hides, then ask.
  void reset(const glm::dvec3& eye);
  const glm::dvec3& eye() const { return eye_; }
  void want(const Box& box);
  /// A solid box that does not hold the eye.
  void add(const Box& box);
  /// The shadow of a solid box, of which the eye may_be_seen_from: what is hidden from the whole cell beyond it, along
  /// planes through the eye. Then what hides() a box hides it from the cell.
  void add(const BoxShadow& shadow);
  /// True only if every ray from the eye to any point of a wanted box goes through a solid box before.
  bool hides(const Box& box) const;

 private:
  /// A box as a face of the cube has it: depths, and offsets along the two other axes.
  struct Placed {
    double near_s = 0, far_s = 0;  ///< 1 / depth
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  };
  bool place(const Box& box, uint32_t face, Placed& placed) const;
  void draw(const Placed& box, std::vector<float>& nearness) const;
  void draw(const BoxShadow& shadow, uint32_t face);
  bool blocks(const Placed& box, const std::vector<float>& nearness) const;

  glm::dvec3 eye_{0};
  uint32_t wanted_ = 0;                              ///< faces, bit 2 * axis + (1 towards smaller coordinates)
  std::array<std::vector<float>, kFaces> nearness_;  ///< by pixel: within 1 / this every ray of the pixel is blocked
};

}  // namespace promenade
