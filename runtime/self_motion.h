#pragma once
// Where the eye goes by itself: gliding to a place, or along a recorded path. Pure.

#include <optional>

#include "geometry/path.h"

namespace promenade {

class SelfMotion {
 public:
  static constexpr double kGlideS = 0.8;

  /// Smoothly from one pose to another, the shorter way round.
  void glide(const Pose& from, const Pose& to);
  /// Along a path from its first key. A path without keys is none.
  void replay(CameraPath path);
  void stop();
  bool moving() const { return target_ || path_; }
  bool replaying() const { return path_.has_value(); }

  /// The pose dt_s later; nullopt: nothing moves. The last pose is reached exactly, then nothing moves any more.
  std::optional<Pose> next(double dt_s);

 private:
  Pose from_;
  std::optional<Pose> target_;
  std::optional<CameraPath> path_;
  double t_s_ = 0;
};

}  // namespace promenade
