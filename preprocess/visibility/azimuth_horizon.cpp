#include "preprocess/visibility/azimuth_horizon.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace promenade {
namespace {

constexpr double kAround = 4;       // a full turn in the angle used here
constexpr double kRounding = 1e-6;  // relative; floats of distances and slopes
constexpr double kLeastM = 1e-3;    // nearer to the eye than this nothing is trusted

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Grows with the angle from +x counter-clockwise, [0, 4): where the direction meets the square |x| + |y| = 1.
double turn_of(const glm::dvec2& d) {
  const double t = d.y / (std::abs(d.x) + std::abs(d.y));
  const double turn = d.x >= 0 ? (d.y >= 0 ? t : 4 + t) : 2 - t;
  return turn < kAround ? turn : 0;
}

/// A point of that square.
glm::dvec2 direction_at(double turn) {
  if (turn < 1) return {1 - turn, turn};
  if (turn < 2) return {1 - turn, 2 - turn};
  if (turn < 3) return {turn - 3, 2 - turn};
  return {turn - 3, turn - 4};
}

constexpr double kBinsATurn = AzimuthHorizon::kBins / kAround;
constexpr uint32_t kBinMask = AzimuthHorizon::kBins - 1;
static_assert((AzimuthHorizon::kBins & kBinMask) == 0);

/// Boundaries of bins as directions.
const std::vector<glm::dvec2>& boundaries() {
  static const std::vector<glm::dvec2> directions = [] {
    std::vector<glm::dvec2> d(AzimuthHorizon::kBins);
    for (uint32_t i = 0; i < AzimuthHorizon::kBins; ++i) d[i] = direction_at(double(i) / kBinsATurn);
    return d;
  }();
  return directions;
}

bool overlaps(const Box& clear, const glm::vec2& a, const glm::vec2& b) {
  return std::min(a.x, b.x) <= clear.max.x && std::max(a.x, b.x) >= clear.min.x && std::min(a.y, b.y) <= clear.max.y &&
         std::max(a.y, b.y) >= clear.min.y;
}

/// Whether the segment comes within the rectangle: the rectangle's corners on both sides of its line, or boxes apart.
bool meets(const Box& clear, const glm::vec2& a, const glm::vec2& b) {
  if (!overlaps(clear, a, b)) return false;
  const glm::dvec2 from(a), along = glm::dvec2(b) - from;
  bool left = false, right = false;
  for (unsigned i = 0; i < 4; ++i) {
    const glm::dvec2 corner((i & 1U) != 0 ? clear.max.x : clear.min.x, (i & 2U) != 0 ? clear.max.y : clear.min.y);
    const double side = cross(along, corner - from);
    left |= side >= 0, right |= side <= 0;
  }
  return left && right;
}

}  // namespace

/// Follows a polygon around the eye and hands over each bin that it crosses from one boundary to the other, on whatever
/// way, to and fro: only such a bin is covered as a whole.
struct AzimuthHorizon::Walk {
  enum class From : uint8_t { unknown, clockwise_end, counter_clockwise_end };
  AzimuthHorizon& horizon;
  From from = From::unknown;  ///< the boundary over which the bin was entered
  uint32_t bin = 0;
  double nearest_m = 0, farthest_m = 0;  ///< since then
  uint32_t events = 0;                   ///< boundaries crossed and new starts made
  glm::dvec2 last{0};                    ///< the end of the last side, and its place around the eye
  double last_turn = 0;

  void restart() { from = From::unknown, ++events; }

  /// Along one side, relative to the eye.
  void side(const glm::dvec2& a, const glm::dvec2& b) {
    const double turning = cross(a, b);
    const glm::dvec2 along = b - a;
    const double length = glm::length(along);
    if (length <= 0) return;
    const double off_m = std::abs(turning) / length;  // of the side's line from the eye
    const double turn_a = a == last ? last_turn : turn_of(a) * kBinsATurn, turn_b = turn_of(b) * kBinsATurn;
    last = b, last_turn = turn_b;
    const auto bin_a = static_cast<uint32_t>(turn_a) & kBinMask, bin_b = static_cast<uint32_t>(turn_b) & kBinMask;
    if (events == 0 || bin != bin_a) {
      restart();
      bin = bin_a;
    }
    // Seen edge-on: it stays in its bin, or which way it goes around the eye is uncertain.
    if (off_m < kLeastM && (bin_a != bin_b || glm::dot(a, b) <= 0)) return restart();
    const bool ccw = turning > 0;
    uint32_t steps = ccw ? (bin_b - bin_a) & kBinMask : (bin_a - bin_b) & kBinMask;
    if (steps > kBins / 2 + 1) return restart();  // rounding put an end beyond a boundary: not a real sweep
    if (steps > 0 && !horizon.wanted(ccw ? bin : bin_b, steps + 1)) {
      restart();
      bin = bin_b;
      return;
    }
    const double foot = -glm::dot(a, along) / (length * length);  // where the eye is nearest to the line
    double t = 0, r = glm::length(a);
    const std::vector<glm::dvec2>& ways = boundaries();
    const auto advance = [&](double to, double r_to) {
      const double least = t <= foot && foot <= to ? off_m : std::min(r, r_to);
      nearest_m = std::min(nearest_m, least), farthest_m = std::max({farthest_m, r, r_to});
      t = to, r = r_to;
    };
    const From entry = ccw ? From::clockwise_end : From::counter_clockwise_end;
    for (; steps > 0; --steps) {
      const uint32_t next = (ccw ? bin + 1 : bin - 1) & kBinMask;
      if (!horizon.wanted(bin, 1) && !horizon.wanted(next, 1)) {
        bin = next, from = From::unknown, ++events;
        continue;
      }
      const glm::dvec2& way = ways[ccw ? next : bin];
      // a + s along lies on the way: cross(a, way) + s cross(along, way) = 0
      const double s = std::clamp(-cross(a, way) / cross(along, way), t, 1.0);
      advance(s, glm::length(a + along * s));
      if (from == entry) horizon.commit(bin, nearest_m, farthest_m);
      bin = next;
      from = entry, ++events;
      nearest_m = farthest_m = r;
    }
    advance(1, glm::length(b));
  }
};

void AzimuthHorizon::reset(const glm::dvec3& eye) {
  eye_ = eye;
  for (Bin& bin : bins_) bin.count = 0;
  all_wanted_ = true;
}

void AzimuthHorizon::want_none() {
  std::fill(wanted_.begin(), wanted_.end(), 0U);
  all_wanted_ = false;
}

void AzimuthHorizon::want(const BoxInView& view) {
  // Differences first, sums in wants_complete(): +1 where it begins, -1 behind its end.
  const uint32_t end = view.first_bin + view.bins;
  ++wanted_[view.first_bin];
  --wanted_[std::min(end, kBins)];
  if (end > kBins) ++wanted_[0], --wanted_[end - kBins];
}

void AzimuthHorizon::wants_complete() {
  uint32_t depth = 0, sum = 0;
  for (uint32_t i = 0; i < kBins; ++i) {
    depth += wanted_[i];
    wanted_[i] = sum;
    sum += depth != 0 ? 1 : 0;
  }
  wanted_[kBins] = sum;
}

bool AzimuthHorizon::wanted(uint32_t first_bin, uint32_t bins) const {
  if (all_wanted_) return true;
  const uint32_t end = first_bin + bins;
  if (end <= kBins) return wanted_[end] != wanted_[first_bin];
  return wanted_[kBins] != wanted_[first_bin] || wanted_[end - kBins] != wanted_[0];
}

void AzimuthHorizon::commit(uint32_t bin, double nearest_m, double farthest_m) {
  if (!wanted(bin, 1)) return;
  const double steep = rise_m_ / (rise_m_ > 0 ? farthest_m : nearest_m);
  const auto distance = static_cast<float>(farthest_m * (1 + kRounding));
  const auto slope = static_cast<float>(steep - std::abs(steep) * kRounding);
  Bin& b = bins_[bin];
  uint32_t at = 0;
  while (at < b.count && b.distance_m[at] <= distance) ++at;
  if (at > 0 && b.slope[at - 1] >= slope) return;  // a nearer one is as steep
  uint32_t end = at;
  while (end < b.count && b.slope[end] <= slope) ++end;  // farther ones that are not steeper
  if (end == at && b.count == Bin::kMost) {
    // Full: forgetting is always safe. The one that adds least over its nearer neighbour goes.
    uint32_t least = 1;
    for (uint32_t i = 2; i < b.count; ++i)
      if (b.slope[i] - b.slope[i - 1] < b.slope[least] - b.slope[least - 1]) least = i;
    for (uint32_t i = least; i + 1 < b.count; ++i) b.distance_m[i] = b.distance_m[i + 1], b.slope[i] = b.slope[i + 1];
    --b.count;
    if (least < at) --at;
    end = at;
  }
  if (end == at) {
    for (uint32_t i = b.count; i > at; --i) b.distance_m[i] = b.distance_m[i - 1], b.slope[i] = b.slope[i - 1];
    ++b.count;
  } else {
    const uint32_t gone = end - at - 1;
    for (uint32_t i = at + 1; i + gone < b.count; ++i)
      b.distance_m[i] = b.distance_m[i + gone], b.slope[i] = b.slope[i + gone];
    b.count -= gone;
  }
  b.distance_m[at] = distance, b.slope[at] = slope;
}

void AzimuthHorizon::add(std::span<const glm::vec2> polygon, float top_m, const Box& clear) {
  rise_m_ = double(top_m) - eye_.z;
  Walk walk{*this};
  const glm::dvec2 eye(eye_);
  const size_t n = polygon.size();
  for (size_t i = 0; i < 2 * n; ++i) {
    const glm::vec2 &a = polygon[i % n], &b = polygon[(i + 1) % n];
    const uint32_t events = walk.events;
    if (meets(clear, a, b))
      walk.restart();
    else
      walk.side(glm::dvec2(a) - eye, glm::dvec2(b) - eye);
    // Once around, and on until the bin that the walk began in is done.
    if (i + 1 >= n && walk.events != events) break;
  }
}

BoxInView AzimuthHorizon::view_of(const Box& box) const {
  const glm::dvec2 low = glm::dvec2(box.min) - glm::dvec2(eye_), high = glm::dvec2(box.max) - glm::dvec2(eye_);
  const glm::dvec2 gap = glm::max(glm::max(low, -high), glm::dvec2(0));
  const double nearest = glm::length(gap);
  if (nearest < kLeastM) return {0, kBins, 0, std::numeric_limits<float>::infinity()};
  // The corners that lie farthest clockwise and counter-clockwise, by where the eye is seen from the box.
  glm::dvec2 first, last;
  if (low.x > 0)
    first = {low.y > 0 ? high.x : low.x, low.y}, last = {high.y < 0 ? high.x : low.x, high.y};
  else if (high.x < 0)
    first = {high.y < 0 ? low.x : high.x, high.y}, last = {low.y > 0 ? low.x : high.x, low.y};
  else if (low.y > 0)
    first = {high.x, low.y}, last = {low.x, low.y};
  else
    first = {low.x, high.y}, last = {high.x, high.y};
  constexpr double kWider = 1e-9 * kBinsATurn;
  const double from = turn_of(first) * kBinsATurn - kWider, to = turn_of(last) * kBinsATurn + kWider;
  const auto bin_from = static_cast<uint32_t>(static_cast<int32_t>(std::floor(from))) & kBinMask;
  const auto bin_to = static_cast<uint32_t>(static_cast<int32_t>(std::floor(to))) & kBinMask;
  const double rise = double(box.max.z) - eye_.z;
  const double farthest = glm::length(glm::max(glm::abs(low), glm::abs(high)));
  const double steep = rise / (rise > 0 ? nearest : farthest);
  return {bin_from, ((bin_to - bin_from) & kBinMask) + 1, static_cast<float>(nearest * (1 - kRounding)),
          static_cast<float>(steep + std::abs(steep) * kRounding)};
}

bool AzimuthHorizon::hides(const BoxInView& view) const {
  for (uint32_t i = 0; i < view.bins; ++i) {
    const Bin& b = bins_[(view.first_bin + i) & kBinMask];
    uint32_t k = b.count;
    while (k > 0 && b.distance_m[k - 1] > view.nearest_m) --k;
    if (k == 0 || b.slope[k - 1] < view.slope) return false;
  }
  return true;
}

bool AzimuthHorizon::worth_adding(const Box& box) const {
  BoxInView view = view_of(box);
  if (view.nearest_m <= 0) return true;
  if (!wanted(view.first_bin, view.bins)) return false;
  // Steeper than all its walls, and nothing counts that is farther than its nearest wall.
  return !hides(view);
}

}  // namespace promenade
