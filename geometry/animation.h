#pragma once
// Things that move by recorded keys, as glTF has them: joints with tracks for translation, rotation and scale, hung
// below each other.

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "geometry/box.h"

namespace promenade {

constexpr uint32_t kNoTrack = 0xffffffffU, kNoJoint = 0xffffffffU;

/// Values at times. Beyond the first and the last key the nearest one's holds; with a period it begins anew.
struct AnimationTrack {
  enum class Way : uint8_t {
    linear,  ///< rotations: along the shorter arc
    step,    ///< a key's value until the next
    cubic,   ///< Hermite splines: each key has a tangent towards it, a value and a tangent from it
  };
  Way way = Way::linear;
  uint32_t components = 3;   ///< 3: translation, scale; 4: rotation, x y z w
  uint32_t first_time = 0;   ///< into Animation::times
  uint32_t first_value = 0;  ///< into Animation::values; a key has `components` of them, cubic three times as many
  uint32_t keys = 0;         ///< at least one
  float period_s = 0;        ///< of the animation that it is of; 0: it does not begin anew
  bool operator==(const AnimationTrack&) const = default;
};

/// A joint's place: parent_from_rest, then translation, rotation and scale, from the tracks where there are any.
struct AnimationJoint {
  uint32_t parent = kNoJoint;        ///< stands before its children; kNoJoint: the world
  glm::dmat4 parent_from_rest{1.0};  ///< affine
  std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< x y z w, unit
  enum Slot : uint8_t { translation_slot, rotation_slot, scale_slot };
  std::array<uint32_t, 3> tracks{kNoTrack, kNoTrack, kNoTrack};  ///< by Slot
  bool operator==(const AnimationJoint&) const = default;
};

struct Animation {
  std::vector<float> times, values;
  std::vector<AnimationTrack> tracks;
  std::vector<AnimationJoint> joints;
  bool empty() const { return joints.empty(); }
  bool operator==(const Animation&) const = default;
};

/// Empty when every index is in range, every number finite, times ascend strictly and parents stand before their
/// children; else what is wrong. The functions below expect that.
std::string find_defect(const Animation& animation);

/// World from joint, for all joints. Pure; any thread. Source: Khronos, glTF 2.0, appendix C.
std::vector<glm::dmat4> poses_at(const Animation& animation, double time_s);

/// A box in the world that holds whatever is in `box` (the joint's own space) at any time. Conservative: what turns
/// about an axis of its own is held by the cylinder that its box sweeps, by its sphere when the axis changes. Source:
/// [funkhouser1993] section 3.1.2 keeps moving objects by the volume that they sweep.
DBox swept_box(const Animation& animation, uint32_t joint, const DBox& box);

/// The most that the joint lengthens anything at any time, over all directions; an upper bound.
double largest_scale(const Animation& animation, uint32_t joint);

/// Adds the joints that are used, and what they hang on, with their tracks; returns each joint's new number.
std::vector<uint32_t> append_used(Animation& animation, const Animation& more, std::vector<bool> used);

/// The box around a transformed box.
DBox transformed_box(const DBox& box, const glm::dmat4& matrix);
DBox transformed_box(const Box& box, const glm::dmat4& matrix);

}  // namespace promenade
