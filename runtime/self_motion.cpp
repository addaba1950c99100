#include "runtime/self_motion.h"

#include <cmath>
#include <utility>

namespace promenade {

void SelfMotion::glide(const Pose& from, const Pose& to) {
  stop();
  from_ = from, target_ = to;
}

void SelfMotion::replay(CameraPath path) {
  stop();
  if (!path.keys.empty()) path_ = std::move(path);
}

void SelfMotion::stop() {
  target_.reset(), path_.reset();
  t_s_ = 0;
}

std::optional<Pose> SelfMotion::next(double dt_s) {
  t_s_ += dt_s;
  if (path_) {
    const Pose pose = pose_at(*path_, path_->keys.front().t_s + t_s_);
    if (t_s_ >= path_->duration_s()) stop();
    return pose;
  }
  if (!target_) return std::nullopt;
  if (t_s_ >= kGlideS) {
    const Pose end = *target_;
    stop();
    return end;
  }
  const double s = t_s_ / kGlideS, eased = s * s * (3 - 2 * s);
  const auto turned = [eased](double from, double to) { return from + std::remainder(to - from, 360.0) * eased; };
  Pose pose;
  pose.eye = from_.eye + (target_->eye - from_.eye) * eased;
  pose.yaw_deg = turned(from_.yaw_deg, target_->yaw_deg);
  pose.pitch_deg = from_.pitch_deg + (target_->pitch_deg - from_.pitch_deg) * eased;
  pose.roll_deg = turned(from_.roll_deg, target_->roll_deg);
  return pose;
}

}  // namespace promenade
