#include "preprocess/visibility/azimuth_horizon.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "preprocess/visibility/plan_segments.h"

namespace promenade {
namespace {

constexpr double kAround = 4;       // a full turn in the angle used here
constexpr double kRounding = 1e-6;  // relative; floats of distances and slopes
constexpr double kLeastM = 1e-3;    // nearer to the eye than this nothing is trusted
/// What of a side lies within a bin is nearer than both its ends by at most this part: bins are at most 8 / kBins rad.
constexpr double kBulge = 32.0 / AzimuthHorizon::kBins / AzimuthHorizon::kBins;

/// Grows with the angle from +x counter-clockwise, [0, 4): where the direction meets the square |x| + |y| = 1.
double turn_of(double x, double y) {
  const double t = y / std::max(std::abs(x) + std::abs(y), std::numeric_limits<double>::min());
  const double right = y >= 0 ? t : 4 + t;
  const double turn = x >= 0 ? right : 2 - t;
  return turn < kAround ? turn : 0;
}
double turn_of(const glm::dvec2& d) { return turn_of(d.x, d.y); }

/// A point of that square.
glm::dvec2 direction_at(double turn) {
  if (turn < 1) return {1 - turn, turn};
  if (turn < 2) return {1 - turn, 2 - turn};
  if (turn < 3) return {turn - 3, 2 - turn};
  return {turn - 3, turn - 4};
}

constexpr double kBinsATurn = AzimuthHorizon::kBins / kAround;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kNoBin = 0xffffffffU;
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
  void side(size_t a, size_t b) {
    const unsigned beside_a = horizon.beside_[a], beside_b = horizon.beside_[b];
    if ((beside_a & beside_b) != 0) {
      restart();
      bin = kNoBin;
      return;
    }
    if (beside_a != 0) horizon.place(a);
    if (beside_b != 0) horizon.place(b);
    const uint32_t bin_a = horizon.bin_of(a), bin_b = horizon.bin_of(b);
    if (events == 0 || bin != bin_a) {
      restart();
      bin = bin_a;
    }
    if (bin_a != bin_b) return cross_bins(a, b, bin_b);
    // Beside the eye: which way it goes around is uncertain.
    if (horizon.x_[a] * horizon.x_[b] + horizon.y_[a] * horizon.y_[b] <= 0) return restart();
    widen(horizon.inverse_[a]), widen(horizon.inverse_[b]);
  }

  void widen(double inverse) { farthest = std::min(farthest, inverse), nearest = std::max(nearest, inverse); }

  void cross_bins(size_t a, size_t b, uint32_t bin_b) {
    const glm::dvec2 begin(horizon.x_[a], horizon.y_[a]), end(horizon.x_[b], horizon.y_[b]), along = end - begin;
    const double turning = cross(begin, end);
    // Seen edge-on: likewise.
    if (turning * turning < kLeastM * kLeastM * glm::dot(along, along)) return restart();
    const bool ccw = turning > 0;
    uint32_t steps = ccw ? (bin_b - bin) & kBinMask : (bin - bin_b) & kBinMask;
    if (steps > kBins / 2 + 1) return restart();  // rounding put an end beyond a boundary: not a real sweep
    if (!horizon.is_open(ccw ? bin : bin_b, steps + 1)) {
      restart();
      bin = bin_b;
      return;
    }
    const glm::dvec2 inverse_by_way = glm::dvec2(along.y, -along.x) / turning;
    // Rounding may put a boundary a hair beyond an end.
    const double foot = std::sqrt(glm::dot(inverse_by_way, inverse_by_way));
    const From entry = ccw ? From::clockwise_end : From::counter_clockwise_end;
    const double ends = std::min(horizon.inverse_[a], horizon.inverse_[b]);
    widen(horizon.inverse_[a]);
    for (; steps > 0; --steps) {
      const uint32_t next = (ccw ? bin + 1 : bin - 1) & kBinMask;
      if (!horizon.is_open(bin) && !horizon.is_open(next)) {
        bin = next, from = From::unknown, ++events;
        continue;
      }
      const double at_boundary = glm::dot(ways[ccw ? next : bin], inverse_by_way);
      const double inverse = std::max(std::min(at_boundary, foot), ends);
      widen(inverse);
      if (from == entry) horizon.commit(bin, nearest, farthest);
      bin = next;
      from = entry, ++events;
      farthest = nearest = inverse;
    }
    widen(horizon.inverse_[b]);
  }
};

void AzimuthHorizon::reset(const glm::dvec3& eye) {
  eye_ = eye;
  for (Bin& bin : bins_) bin.count = 0;
  wanted_nearness_.fill(kInfinity), wanted_slope_.fill(kInfinity);
  open_.fill(~uint64_t(0));
  sector_ = {};
}

void AzimuthHorizon::want_none() {
  wanted_nearness_.fill(0), wanted_slope_.fill(-kInfinity);
  open_.fill(0);
}

void AzimuthHorizon::want(const BoxInView& view) {
  const auto raise = [&](uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; ++i) wanted_nearness_[i] = std::max(wanted_nearness_[i], view.nearness);
    for (uint32_t i = first; i < end; ++i) wanted_slope_[i] = std::max(wanted_slope_[i], view.slope);
  };
  const uint32_t end = view.first_bin + view.bins;
  raise(view.first_bin, std::min(end, kBins));
  if (end > kBins) raise(0, end - kBins);
}

void AzimuthHorizon::wants_complete() {
  for (uint32_t i = 0; i < kBins; ++i)
    if (wanted_nearness_[i] > 0) open_[i / kWord] |= uint64_t(1) << (i % kWord);
  find_sector();
}

bool AzimuthHorizon::is_open(uint32_t first_bin, uint32_t bins) const {
  const auto any = [&](uint32_t first, uint32_t end) {  // first < end
    const uint32_t word = first / kWord, last_word = (end - 1) / kWord;
    const uint64_t from = ~uint64_t(0) << (first % kWord), to = ~uint64_t(0) >> (kWord - 1 - (end - 1) % kWord);
    if (word == last_word) return (open_[word] & from & to) != 0;
    if ((open_[word] & from) != 0 || (open_[last_word] & to) != 0) return true;
    for (uint32_t i = word + 1; i < last_word; ++i)
      if (open_[i] != 0) return true;
    return false;
  };
  const uint32_t end = first_bin + bins;
  return any(first_bin, std::min(end, kBins)) || (end > kBins && any(0, end - kBins));
}

/// What the longest run of unwanted bins leaves, if that is less than half a turn.
void AzimuthHorizon::find_sector() {
  uint32_t longest = 0, end_of_longest = 0, run = 0;
  for (uint32_t i = 0; i < 2 * kBins && run < kBins; ++i) {  // around twice: a run may go on over the first bin
    run = is_open(i & kBinMask) ? 0 : run + 1;
    if (run > longest) longest = run, end_of_longest = i + 1;
  }
  if (longest <= kBins / 2 + 2) return;
  sector_ = {boundaries()[end_of_longest & kBinMask], boundaries()[(end_of_longest - longest) & kBinMask]};
}

void AzimuthHorizon::commit(uint32_t bin, double nearest, double farthest) {
  if (!is_open(bin)) return;
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
  if (b.hides(wanted_nearness_[bin], wanted_slope_[bin])) open_[bin / kWord] &= ~(uint64_t(1) << (bin % kWord));
}

void AzimuthHorizon::place(size_t corner) {
  const double x = x_[corner], y = y_[corner];
  turn_[corner] = turn_of(x, y) * kBinsATurn;
  inverse_[corner] = 1 / std::sqrt(x * x + y * y);
}

void AzimuthHorizon::place_corners(std::span<const glm::vec2> polygon) {
  const size_t n = polygon.size();
  if (x_.size() < n) x_.resize(n), y_.resize(n), turn_.resize(n), inverse_.resize(n), beside_.resize(n);
  const glm::dvec2 eye(eye_), first = sector_[0], last = sector_[1];
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec2 off = glm::dvec2(polygon[i]) - eye;
    x_[i] = off.x, y_[i] = off.y;
    beside_[i] = static_cast<uint8_t>((cross(first, off) < 0 ? 1U : 0U) | (cross(off, last) < 0 ? 2U : 0U));
    if (beside_[i] == 0) place(i);
  }
}

void AzimuthHorizon::add(std::span<const glm::vec2> polygon, float top_m, const Box& clear) {
  rise_m_ = double(top_m) - eye_.z;
  place_corners(polygon);
  const size_t n = polygon.size();
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (const glm::vec2& p : polygon) low = glm::min(low, p), high = glm::max(high, p);
  const bool near = overlaps(clear, low, high);
  Walk walk{*this};
  for (size_t i = 0, k = 0, next = 0; i < 2 * n; ++i, k = next) {
    next = k + 1 == n ? 0 : k + 1;
    const uint32_t events = walk.events;
    if (near && meets(clear, polygon[k], polygon[next]))
      walk.restart();
    else
      walk.side(k, next);
    // Once around, and on until the bin that the walk began in is done.
    if (i + 1 >= n && walk.events != events) break;
  }
}

BoxInView AzimuthHorizon::view_of(const Box& box) const {
  const glm::dvec2 low = glm::dvec2(box.min) - glm::dvec2(eye_), high = glm::dvec2(box.max) - glm::dvec2(eye_);
  const glm::dvec2 gap = glm::max(glm::max(low, -high), glm::dvec2(0));
  const double nearest = glm::length(gap);
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
  const double steep = rise / (rise > 0 ? nearest : glm::length(glm::max(glm::abs(low), glm::abs(high))));
  return {bin_from, ((bin_to - bin_from) & kBinMask) + 1, static_cast<float>((1 + kRounding) / nearest),
          static_cast<float>(steep + std::abs(steep) * kRounding)};
}

bool AzimuthHorizon::hides(const BoxInView& view) const {
  for (uint32_t i = 0; i < view.bins; ++i)
    if (!bins_[(view.first_bin + i) & kBinMask].hides(view.nearness, view.slope)) return false;
  return true;
}

bool AzimuthHorizon::worth_adding(const Box& box) const {
  BoxInView view = view_of(box);
  if (std::isinf(view.nearness)) return true;
  if (!is_open(view.first_bin, view.bins)) return false;
  // Steeper than all its walls, and nothing counts that is farther than its nearest wall.
  return !hides(view);
}

}  // namespace promenade
