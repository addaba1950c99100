#include "geometry/animation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

namespace promenade {
namespace {

constexpr double kStraight = 0.9995;  // cosine between rotations so near that a line is as good as an arc

using Values = std::array<double, 4>;

size_t values_of_key(const AnimationTrack& track) {
  return size_t(track.components) * (track.way == AnimationTrack::Way::cubic ? 3 : 1);
}

/// What a key has at `part`: for cubic tracks 0 the tangent towards it, 1 the value, 2 the tangent from it.
Values key_values(const Animation& a, const AnimationTrack& track, uint32_t key, size_t part) {
  const size_t parts = track.way == AnimationTrack::Way::cubic ? 3 : 1;
  const size_t first = track.first_value + (key * parts + (parts == 3 ? part : 0)) * track.components;
  Values values{};
  for (uint32_t i = 0; i < track.components; ++i) values[i] = double(a.values[first + i]);
  return values;
}

double dot(const Values& a, const Values& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

Values mixed(const Values& a, const Values& b, double of_a, double of_b) {
  Values out{};
  for (size_t i = 0; i < out.size(); ++i) out[i] = a[i] * of_a + b[i] * of_b;
  return out;
}

Values arc(const Values& from, Values to, double share) {
  double cosine = dot(from, to);
  if (cosine < 0) {
    to = mixed(to, to, -1, 0);
    cosine = -cosine;
  }
  if (cosine > kStraight) return mixed(from, to, 1 - share, share);
  const double angle = std::acos(std::min(cosine, 1.0));
  return mixed(from, to, std::sin((1 - share) * angle) / std::sin(angle), std::sin(share * angle) / std::sin(angle));
}

Values value_at(const Animation& a, const AnimationTrack& track, double time_s) {
  const std::span<const float> times(a.times.data() + track.first_time, track.keys);
  if (track.period_s > 0) {
    time_s = std::fmod(time_s, double(track.period_s));
    if (time_s < 0) time_s += double(track.period_s);
  }
  const auto after = static_cast<uint32_t>(
      std::upper_bound(times.begin(), times.end(), time_s, [](double t, float key) { return t < double(key); }) -
      times.begin());
  constexpr size_t kValue = 1;
  if (after == 0) return key_values(a, track, 0, kValue);
  if (after == track.keys || track.way == AnimationTrack::Way::step) return key_values(a, track, after - 1, kValue);
  const Values from = key_values(a, track, after - 1, kValue), to = key_values(a, track, after, kValue);
  const double length_s = double(times[after]) - double(times[after - 1]);
  const double s = (time_s - double(times[after - 1])) / length_s;
  if (track.way == AnimationTrack::Way::linear)
    return track.components == 4 ? arc(from, to, s) : mixed(from, to, 1 - s, s);
  const Values out_of = key_values(a, track, after - 1, 2), into = key_values(a, track, after, 0);
  const double s2 = s * s, s3 = s2 * s;
  return mixed(mixed(from, to, 2 * s3 - 3 * s2 + 1, 3 * s2 - 2 * s3),
               mixed(out_of, into, length_s * (s3 - 2 * s2 + s), length_s * (s3 - s2)), 1, 1);
}

glm::dmat3 matrix_of(const Values& rotation) {
  const double length = std::sqrt(dot(rotation, rotation));
  if (!(length > 0)) return glm::dmat3(1);
  return glm::mat3_cast(
      glm::dquat(rotation[3] / length, rotation[0] / length, rotation[1] / length, rotation[2] / length));
}

Values padded(const std::array<double, 3>& v) { return {v[0], v[1], v[2], 0}; }

/// The box of all values that a track takes, component by component.
struct Range {
  Values low, high;
  explicit Range(const Values& value) : low(value), high(value) {}
  void add(const Values& value) {
    for (size_t i = 0; i < value.size(); ++i)
      low[i] = std::min(low[i], value[i]), high[i] = std::max(high[i], value[i]);
  }
};

/// Linear ways stay between their keys; a spline within the corners of its Bezier polygon.
Range range_of(const Animation& a, const AnimationTrack& track) {
  Range range(key_values(a, track, 0, 1));
  for (uint32_t key = 0; key < track.keys; ++key) {
    const Values value = key_values(a, track, key, 1);
    range.add(value);
    if (track.way != AnimationTrack::Way::cubic) continue;
    const float* times = a.times.data() + track.first_time;
    if (key + 1 < track.keys)
      range.add(mixed(value, key_values(a, track, key, 2), 1, (double(times[key + 1]) - double(times[key])) / 3));
    if (key > 0)
      range.add(mixed(value, key_values(a, track, key, 0), 1, (double(times[key - 1]) - double(times[key])) / 3));
  }
  return range;
}

Range range_of(const Animation& a, const AnimationJoint& joint, AnimationJoint::Slot slot) {
  if (joint.tracks[slot] != kNoTrack) return range_of(a, a.tracks[joint.tracks[slot]]);
  return Range(slot == AnimationJoint::rotation_slot
                   ? joint.rotation
                   : padded(slot == AnimationJoint::scale_slot ? joint.scale : joint.translation));
}

DBox scaled(const DBox& box, const Range& scale) {
  DBox out;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<size_t>(i);
    const double products[] = {box.min[i] * scale.low[at], box.min[i] * scale.high[at], box.max[i] * scale.low[at],
                               box.max[i] * scale.high[at]};
    out.min[i] = *std::min_element(std::begin(products), std::end(products));
    out.max[i] = *std::max_element(std::begin(products), std::end(products));
  }
  return out;
}

/// What turns about one axis all the time keeps its place along it.
DBox turned(const DBox& box, const Range& rotation) {
  const auto still = [&rotation](size_t i) { return rotation.low[i] == 0 && rotation.high[i] == 0; };
  int axis = -1;
  for (int i = 0; i < 3; ++i)
    if (still(static_cast<size_t>((i + 1) % 3)) && still(static_cast<size_t>((i + 2) % 3))) axis = i;
  glm::dvec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  if (axis >= 0) farthest[axis] = 0;
  const double radius = glm::length(farthest);
  DBox out{glm::dvec3(-radius), glm::dvec3(radius)};
  if (axis >= 0) out.min[axis] = box.min[axis], out.max[axis] = box.max[axis];
  return out;
}

double most(const Range& range) {
  double out = 0;
  for (size_t i = 0; i < 3; ++i) out = std::max({out, std::abs(range.low[i]), std::abs(range.high[i])});
  return out;
}

/// The most that the matrix lengthens anything: exact where its columns are at right angles, else its Frobenius norm.
double largest_scale(const glm::dmat4& m) {
  const glm::dmat3 linear(m);
  const double x = glm::length(linear[0]), y = glm::length(linear[1]), z = glm::length(linear[2]);
  const auto square = [&linear](int a, int b, double lengths) {
    constexpr double kRounding = 1e-9;
    return std::abs(glm::dot(linear[a], linear[b])) <= kRounding * lengths;
  };
  if (square(0, 1, x * y) && square(1, 2, y * z) && square(2, 0, z * x)) return std::max({x, y, z}) * (1 + 1e-9);
  return std::sqrt(x * x + y * y + z * z);
}

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers), [](auto v) { return std::isfinite(v); });
}

bool all_finite(const glm::dmat4& m) {
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      if (!std::isfinite(m[i][k])) return false;
  return true;
}

std::string find_track_defect(const Animation& a, const AnimationTrack& track) {
  if (track.components != 3 && track.components != 4) return "neither 3 nor 4 components";
  if (track.way > AnimationTrack::Way::cubic) return "unknown interpolation";
  if (!std::isfinite(track.period_s) || track.period_s < 0) return "no sound period";
  const auto in_range = [](uint64_t first, uint64_t count, size_t size) {
    return first <= size && count <= size - first;
  };
  if (track.keys == 0 || !in_range(track.first_time, track.keys, a.times.size()) ||
      !in_range(track.first_value, track.keys * values_of_key(track), a.values.size()))
    return "keys beyond the end";
  for (uint32_t i = 1; i < track.keys; ++i)
    if (!(a.times[track.first_time + i] > a.times[track.first_time + i - 1])) return "times that do not ascend";
  return {};
}

}  // namespace

std::string find_defect(const Animation& a) {
  if (!all_finite(a.times) || !all_finite(a.values)) return "a key's number is not finite";
  for (size_t i = 0; i < a.tracks.size(); ++i)
    if (const std::string defect = find_track_defect(a, a.tracks[i]); !defect.empty())
      return "track " + std::to_string(i) + ": " + defect;
  for (size_t i = 0; i < a.joints.size(); ++i) {
    const AnimationJoint& joint = a.joints[i];
    const std::string where = "joint " + std::to_string(i) + ": ";
    if (joint.parent != kNoJoint && joint.parent >= i) return where + "its parent does not stand before it";
    if (!all_finite(joint.parent_from_rest) || !all_finite(joint.translation) || !all_finite(joint.rotation) ||
        !all_finite(joint.scale))
      return where + "its place is not finite";
    for (size_t slot = 0; slot < joint.tracks.size(); ++slot) {
      if (joint.tracks[slot] == kNoTrack) continue;
      if (joint.tracks[slot] >= a.tracks.size() ||
          a.tracks[joint.tracks[slot]].components != (slot == AnimationJoint::rotation_slot ? 4U : 3U))
        return where + "a track is not there, or of another kind";
    }
  }
  return {};
}

std::vector<glm::dmat4> poses_at(const Animation& a, double time_s) {
  std::vector<glm::dmat4> poses;
  poses.reserve(a.joints.size());
  for (const AnimationJoint& joint : a.joints) {
    const auto value = [&](AnimationJoint::Slot slot, const Values& rest) {
      return joint.tracks[slot] == kNoTrack ? rest : value_at(a, a.tracks[joint.tracks[slot]], time_s);
    };
    const Values translation = value(AnimationJoint::translation_slot, padded(joint.translation));
    const Values scale = value(AnimationJoint::scale_slot, padded(joint.scale));
    glm::dmat4 own(matrix_of(value(AnimationJoint::rotation_slot, joint.rotation)));
    for (int i = 0; i < 3; ++i) own[i] *= scale[static_cast<size_t>(i)];
    own[3] = glm::dvec4(translation[0], translation[1], translation[2], 1);
    const glm::dmat4 rest =
        joint.parent == kNoJoint ? joint.parent_from_rest : poses[joint.parent] * joint.parent_from_rest;
    poses.push_back(rest * own);
  }
  return poses;
}

std::vector<uint32_t> append_used(Animation& animation, const Animation& more, std::vector<bool> used) {
  for (size_t i = more.joints.size(); i-- > 0;)
    if (used[i] && more.joints[i].parent != kNoJoint) used[more.joints[i].parent] = true;
  std::vector<uint32_t> track_of(more.tracks.size(), kNoTrack), joint_of(more.joints.size(), kNoJoint);
  const auto add_track = [&](uint32_t index) {
    if (track_of[index] != kNoTrack) return track_of[index];
    AnimationTrack track = more.tracks[index];
    const auto times = more.times.begin() + track.first_time;
    const auto values = more.values.begin() + track.first_value;
    track.first_time = static_cast<uint32_t>(animation.times.size());
    track.first_value = static_cast<uint32_t>(animation.values.size());
    animation.times.insert(animation.times.end(), times, times + track.keys);
    animation.values.insert(animation.values.end(), values,
                            values + static_cast<std::ptrdiff_t>(track.keys * values_of_key(track)));
    animation.tracks.push_back(track);
    return track_of[index] = static_cast<uint32_t>(animation.tracks.size() - 1);
  };
  for (size_t i = 0; i < more.joints.size(); ++i) {
    if (!used[i]) continue;
    AnimationJoint joint = more.joints[i];
    if (joint.parent != kNoJoint) joint.parent = joint_of[joint.parent];
    for (uint32_t& track : joint.tracks)
      if (track != kNoTrack) track = add_track(track);
    joint_of[i] = static_cast<uint32_t>(animation.joints.size());
    animation.joints.push_back(joint);
  }
  return joint_of;
}

DBox transformed_box(const DBox& box, const glm::dmat4& matrix) {
  DBox out;
  if (box.empty()) return out;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1U) != 0 ? box.max.x : box.min.x, (corner & 2U) != 0 ? box.max.y : box.min.y,
                       (corner & 4U) != 0 ? box.max.z : box.min.z);
    out.add(glm::dvec3(matrix * glm::dvec4(p, 1.0)));
  }
  return out;
}

DBox transformed_box(const Box& box, const glm::dmat4& matrix) {
  if (box.empty()) return {};
  return transformed_box(DBox{glm::dvec3(box.min), glm::dvec3(box.max)}, matrix);
}

DBox swept_box(const Animation& a, uint32_t joint, const DBox& box) {
  DBox swept = box;
  for (uint32_t at = joint; at != kNoJoint && !swept.empty(); at = a.joints[at].parent) {
    const AnimationJoint& j = a.joints[at];
    swept = scaled(swept, range_of(a, j, AnimationJoint::scale_slot));
    const Range rotation = range_of(a, j, AnimationJoint::rotation_slot);
    if (rotation.low == rotation.high)
      swept = transformed_box(swept, glm::dmat4(matrix_of(rotation.low)));
    else
      swept = turned(swept, rotation);
    const Range translation = range_of(a, j, AnimationJoint::translation_slot);
    for (int i = 0; i < 3; ++i) {
      swept.min[i] += translation.low[static_cast<size_t>(i)];
      swept.max[i] += translation.high[static_cast<size_t>(i)];
    }
    swept = transformed_box(swept, j.parent_from_rest);
  }
  return swept;
}

double largest_scale(const Animation& a, uint32_t joint) {
  double scale = 1;
  for (uint32_t at = joint; at != kNoJoint; at = a.joints[at].parent)
    scale *= most(range_of(a, a.joints[at], AnimationJoint::scale_slot)) * largest_scale(a.joints[at].parent_from_rest);
  return scale;
}

}  // namespace promenade
