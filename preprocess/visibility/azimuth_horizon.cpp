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
/// What of a side lies within a bin is nearer than both its ends by at most this part: bins are at most 8 / kBins rad.
constexpr double kBulge = 32.0 / AzimuthHorizon::kBins / AzimuthHorizon::kBins;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Grows with the angle from +x counter-clockwise, [0, 4): where the direction meets the square |x| + |y| = 1.
double turn_of(const glm::dvec2& d) {
  const double t = d.y / std::max(std::abs(d.x) + std::abs(d.y), std::numeric_limits<double>::min());
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

/// Boundaries of bins as directions, unit.
const std::vector<glm::dvec2>& boundaries() {
  static const std::vector<glm::dvec2> directions = [] {
    std::vector<glm::dvec2> d(AzimuthHorizon::kBins);
    for (uint32_t i = 0; i < AzimuthHorizon::kBins; ++i) d[i] = glm::normalize(direction_at(double(i) / kBinsATurn));
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
/// way, to and fro: only such a bin is covered as a whole. Along a side, the inverse of the distance is linear in the
/// (unit) direction: so inverses are what is reckoned with.
struct AzimuthHorizon::Walk {
  enum class From : uint8_t { unknown, clockwise_end, counter_clockwise_end };
  AzimuthHorizon& horizon;
  const std::vector<glm::dvec2>& ways = boundaries();
  From from = From::unknown;  ///< the boundary over which the bin was entered
  uint32_t bin = 0;
  double farthest = 0, nearest = 0;  ///< least and greatest inverse distance since then
  uint32_t events = 0;               ///< boundaries crossed and new starts made

  void restart() { from = From::unknown, ++events; }

  /// Along one side between corners a and b.
  void side(const Corner& a, const Corner& b) {
    const uint32_t bin_a = a.bin(), bin_b = b.bin();
    if (events == 0 || bin != bin_a) {
      restart();
      bin = bin_a;
    }
    if (bin_a == bin_b) {
      if (glm::dot(a.off, b.off) <= 0) return restart();  // beside the eye: which way it goes around is uncertain
      farthest = std::min({farthest, a.inverse, b.inverse}), nearest = std::max({nearest, a.inverse, b.inverse});
      return;
    }
    cross_bins(a, b);
  }

  void cross_bins(const Corner& a, const Corner& b) {
    const uint32_t bin_b = b.bin();
    const glm::dvec2 along = b.off - a.off;
    const double turning = cross(a.off, b.off);
    // Seen edge-on: likewise.
    if (turning * turning < kLeastM * kLeastM * glm::dot(along, along)) return restart();
    const bool ccw = turning > 0;
    uint32_t steps = ccw ? (bin_b - bin) & kBinMask : (bin - bin_b) & kBinMask;
    if (steps > kBins / 2 + 1) return restart();  // rounding put an end beyond a boundary: not a real sweep
    if (!horizon.wanted(ccw ? bin : bin_b, steps + 1)) {
      restart();
      bin = bin_b;
      return;
    }
    const glm::dvec2 inverse_by_way = glm::dvec2(along.y, -along.x) / turning;
    // Rounding may put a boundary a hair beyond an end.
    const double foot = std::sqrt(glm::dot(inverse_by_way, inverse_by_way));
    const From entry = ccw ? From::clockwise_end : From::counter_clockwise_end;
    farthest = std::min(farthest, a.inverse), nearest = std::max(nearest, a.inverse);
    for (; steps > 0; --steps) {
      const uint32_t next = (ccw ? bin + 1 : bin - 1) & kBinMask;
      if (!horizon.wanted(bin, 1) && !horizon.wanted(next, 1)) {
        bin = next, from = From::unknown, ++events;
        continue;
      }
      const double at_boundary = glm::dot(ways[ccw ? next : bin], inverse_by_way);
      const double inverse = std::max(std::min(at_boundary, foot), std::min(a.inverse, b.inverse));
      farthest = std::min(farthest, inverse), nearest = std::max(nearest, inverse);
      if (from == entry) horizon.commit(bin, nearest, farthest);
      bin = next;
      from = entry, ++events;
      farthest = nearest = inverse;
    }
    farthest = std::min(farthest, b.inverse), nearest = std::max(nearest, b.inverse);
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

void AzimuthHorizon::commit(uint32_t bin, double nearest, double farthest) {
  if (!wanted(bin, 1)) return;
  const double steep = rise_m_ * (rise_m_ > 0 ? farthest : nearest * (1 + kBulge));
  const auto nearness = static_cast<float>(farthest * (1 - kRounding));
  const auto slope = static_cast<float>(steep - std::abs(steep) * kRounding);
  Bin& b = bins_[bin];
  uint32_t at = 0;
  while (at < b.count && b.nearness[at] >= nearness) ++at;
  if (at > 0 && b.slope[at - 1] >= slope) return;  // a nearer one is as steep
  uint32_t end = at;
  while (end < b.count && b.slope[end] <= slope) ++end;  // farther ones that are not steeper
  if (end == at && b.count == Bin::kMost) {
    // Full: forgetting is always safe. The one that adds least over its nearer neighbour goes.
    uint32_t least = 1;
    for (uint32_t i = 2; i < b.count; ++i)
      if (b.slope[i] - b.slope[i - 1] < b.slope[least] - b.slope[least - 1]) least = i;
    for (uint32_t i = least; i + 1 < b.count; ++i) b.nearness[i] = b.nearness[i + 1], b.slope[i] = b.slope[i + 1];
    --b.count;
    if (least < at) --at;
    end = at;
  }
  if (end == at) {
    for (uint32_t i = b.count; i > at; --i) b.nearness[i] = b.nearness[i - 1], b.slope[i] = b.slope[i - 1];
    ++b.count;
  } else {
    const uint32_t gone = end - at - 1;
    for (uint32_t i = at + 1; i + gone < b.count; ++i)
      b.nearness[i] = b.nearness[i + gone], b.slope[i] = b.slope[i + gone];
    b.count -= gone;
  }
  b.nearness[at] = nearness, b.slope[at] = slope;
}

void AzimuthHorizon::add(std::span<const glm::vec2> polygon, float top_m, const Box& clear) {
  rise_m_ = double(top_m) - eye_.z;
  const glm::dvec2 eye(eye_);
  const size_t n = polygon.size();
  corners_.resize(n);
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (size_t i = 0; i < n; ++i) {
    Corner& corner = corners_[i];
    corner.off = glm::dvec2(polygon[i]) - eye;
    corner.turn = turn_of(corner.off) * kBinsATurn;
    corner.inverse = 1 / glm::length(corner.off);
    low = glm::min(low, polygon[i]), high = glm::max(high, polygon[i]);
  }
  const bool near = overlaps(clear, low, high);
  Walk walk{*this};
  for (size_t i = 0, k = 0, next = 0; i < 2 * n; ++i, k = next) {
    next = k + 1 == n ? 0 : k + 1;
    const uint32_t events = walk.events;
    if (near && meets(clear, polygon[k], polygon[next]))
      walk.restart();
    else
      walk.side(corners_[k], corners_[next]);
    // Once around, and on until the bin that the walk began in is done.
    if (i + 1 >= n && walk.events != events) break;
  }
}

BoxInView AzimuthHorizon::view_of(const Box& box) const {
  const glm::dvec2 low = glm::dvec2(box.min) - glm::dvec2(eye_), high = glm::dvec2(box.max) - glm::dvec2(eye_);
  const glm::dvec2 gap = glm::max(glm::max(low, -high), glm::dvec2(0));
  const double nearest = glm::length(gap);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (nearest < kLeastM) return {0, kBins, kInfinity, kInfinity};
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
  return {bin_from, ((bin_to - bin_from) & kBinMask) + 1, static_cast<float>((1 + kRounding) / nearest),
          static_cast<float>(steep + std::abs(steep) * kRounding)};
}

bool AzimuthHorizon::hides(const BoxInView& view) const {
  for (uint32_t i = 0; i < view.bins; ++i) {
    const Bin& b = bins_[(view.first_bin + i) & kBinMask];
    uint32_t k = b.count;
    while (k > 0 && b.nearness[k - 1] < view.nearness) --k;
    if (k == 0 || b.slope[k - 1] < view.slope) return false;
  }
  return true;
}

bool AzimuthHorizon::worth_adding(const Box& box) const {
  BoxInView view = view_of(box);
  if (std::isinf(view.nearness)) return true;
  if (!wanted(view.first_bin, view.bins)) return false;
  // Steeper than all its walls, and nothing counts that is farther than its nearest wall.
  return !hides(view);
}

}  // namespace promenade
