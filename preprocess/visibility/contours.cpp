#include "preprocess/visibility/contours.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace promenade {
namespace {

/// One line of the transform: the lower envelope of parabolas rooted at the samples.
class LineTransform {
 public:
  explicit LineTransform(size_t length) : roots_(length), starts_(length + 1) {}

  /// values[i * stride], i < length, in place.
  void run(float* values, size_t length, size_t stride) {
    line_.resize(length);
    for (size_t i = 0; i < length; ++i) line_[i] = double(values[i * stride]);
    size_t k = 0;
    roots_[0] = 0, starts_[0] = -kFar, starts_[1] = kFar;
    for (size_t q = 1; q < length; ++q) {
      double at = meet(q, roots_[k]);
      while (at <= starts_[k]) at = meet(q, roots_[--k]);
      roots_[++k] = q;
      starts_[k] = at, starts_[k + 1] = kFar;
    }
    k = 0;
    for (size_t q = 0; q < length; ++q) {
      while (starts_[k + 1] < double(q)) ++k;
      const double d = double(q) - double(roots_[k]);
      values[q * stride] = static_cast<float>(d * d + line_[roots_[k]]);
    }
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  double meet(size_t q, size_t p) const {
    const double dq = double(q), dp = double(p);
    return ((line_[q] + dq * dq) - (line_[p] + dp * dp)) / (2 * dq - 2 * dp);
  }
  std::vector<double> line_;
  std::vector<size_t> roots_;
  std::vector<double> starts_;
};

/// Marching squares over the middles of cells. Squares are named by their lower left cell; an edge of the grid by its
/// first cell and its direction.
class Tracer {
 public:
  Tracer(const Mask& mask, std::span<const float> depths, float level)
      : mask_(mask), depths_(depths), level_(level), next_(size_t(mask.nx) * mask.ny * 2, kNone) {}

  std::vector<Loop> run() {
    for (uint32_t y = 0; y + 1 < mask_.ny; ++y)
      for (uint32_t x = 0; x + 1 < mask_.nx; ++x) square(x, y);
    std::vector<Loop> loops;
    for (size_t edge = 0; edge < next_.size(); ++edge)
      if (next_[edge] != kNone) loops.push_back(follow(edge));
    return loops;
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  bool high(uint32_t x, uint32_t y) const { return value(x, y) >= level_; }
  float value(uint32_t x, uint32_t y) const { return depths_[size_t(y) * mask_.nx + x]; }
  size_t across(uint32_t x, uint32_t y) const { return (size_t(y) * mask_.nx + x) * 2; }       // to (x + 1, y)
  size_t upwards(uint32_t x, uint32_t y) const { return (size_t(y) * mask_.nx + x) * 2 + 1; }  // to (x, y + 1)

  /// Links edges so that the deep side lies on the left. Saddles keep the two deep corners apart.
  void square(uint32_t x, uint32_t y) {
    const bool a = high(x, y), b = high(x + 1, y), c = high(x + 1, y + 1), d = high(x, y + 1);
    const size_t bottom = across(x, y), right = upwards(x + 1, y), top = across(x, y + 1), left = upwards(x, y);
    if (a == b && b == c && c == d) return;
    if (a && c && !b && !d) return link(bottom, left), link(top, right);
    if (b && d && !a && !c) return link(right, bottom), link(left, top);
    // The line enters where, walking around counter-clockwise, deep turns to shallow.
    const bool corners[5] = {a, b, c, d, a};
    const size_t edges[4] = {bottom, right, top, left};
    size_t from = 0, to = 0;
    for (size_t i = 0; i < 4; ++i) {
      if (corners[i] && !corners[i + 1]) from = edges[i];
      if (!corners[i] && corners[i + 1]) to = edges[i];
    }
    link(from, to);
  }
  void link(size_t from, size_t to) { next_[from] = static_cast<uint32_t>(to); }

  Loop follow(size_t start) {
    Loop loop;
    for (size_t edge = start; next_[edge] != kNone;) {
      loop.push_back(point(edge));
      const size_t next = next_[edge];
      next_[edge] = kNone;
      edge = next;
    }
    return loop;
  }

  glm::vec2 point(size_t edge) const {
    const auto cell = static_cast<uint32_t>(edge / 2);
    const uint32_t x = cell % mask_.nx, y = cell / mask_.nx;
    const bool up = edge % 2 == 1;
    const float v0 = value(x, y), v1 = up ? value(x, y + 1) : value(x + 1, y);
    const float t = (level_ - v0) / (v1 - v0);
    return glm::vec2(float(x) + 0.5F, float(y) + 0.5F) + (up ? glm::vec2(0, t) : glm::vec2(t, 0));
  }

  const Mask& mask_;
  std::span<const float> depths_;
  float level_;
  std::vector<uint32_t> next_;
};

float distance_to_segment(const glm::vec2& p, const glm::vec2& a, const glm::vec2& b) {
  const glm::vec2 ab = b - a;
  const float length2 = glm::dot(ab, ab);
  const float t = length2 > 0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0F, 1.0F) : 0.0F;
  return glm::distance(p, a + ab * t);
}

/// Replaces runs of a loop by chords that stay as deep.
class Shortener {
 public:
  Shortener(const Mask& mask, std::span<const float> depths, double least_squared, double loss)
      : mask_(mask), depths_(depths), least_squared_(least_squared), loss_(static_cast<float>(loss)) {}

  Loop run(const Loop& loop) const {
    const size_t n = loop.size();
    Loop kept;
    for (size_t at = 0; at < n;) {
      kept.push_back(loop[at]);
      // The longest chord that doubling finds, then steps in between.
      size_t reach = 1;
      while (at + 2 * reach <= n && may_skip(loop, at, at + 2 * reach)) reach *= 2;
      for (size_t step = reach / 2; step > 0; step /= 2)
        if (at + reach + step <= n && may_skip(loop, at, at + reach + step)) reach += step;
      at += reach;
    }
    return kept;
  }

 private:
  bool may_skip(const Loop& loop, size_t first, size_t last) const {
    const glm::vec2 a = loop[first], b = loop[last % loop.size()];
    for (size_t i = first + 1; i < last; ++i)
      if (distance_to_segment(loop[i], a, b) > loss_) return false;
    const glm::dvec2 from(a), along = glm::dvec2(b) - from;
    const auto samples = static_cast<size_t>(std::ceil(glm::length(along) / kStep));
    for (size_t i = 1; i < samples; ++i)
      if (squared_bound(from + along * (double(i) / double(samples))) - kStep * kStep / 4 < least_squared_)
        return false;
    return true;
  }
  /// A lower bound of D^2.
  double squared_bound(const glm::dvec2& p) const {
    const glm::dvec2 q = glm::clamp(p - 0.5, glm::dvec2(0), glm::dvec2(mask_.nx - 2, mask_.ny - 2) + 0.999);
    const auto x = static_cast<size_t>(q.x), y = static_cast<size_t>(q.y);
    const double s = q.x - double(x), t = q.y - double(y);
    const float* low = depths_.data() + y * mask_.nx + x;
    const float* high = low + mask_.nx;
    return (1 - t) * ((1 - s) * double(low[0]) + s * double(low[1])) +
           t * ((1 - s) * double(high[0]) + s * double(high[1])) - s * (1 - s) - t * (1 - t);
  }

  static constexpr double kStep = 0.5;  // cells between samples of a chord
  const Mask& mask_;
  std::span<const float> depths_;
  double least_squared_;
  float loss_;
};

}  // namespace

std::vector<float> squared_depths(const Mask& mask) {
  constexpr float kDeep = 1e12F;
  std::vector<float> depths(mask.inside.size());
  for (size_t i = 0; i < depths.size(); ++i) depths[i] = mask.inside[i] != 0 ? kDeep : 0;
  LineTransform line(std::max(mask.nx, mask.ny));
  for (uint32_t x = 0; x < mask.nx; ++x) line.run(depths.data() + x, mask.ny, mask.nx);
  for (uint32_t y = 0; y < mask.ny; ++y) line.run(depths.data() + size_t(y) * mask.nx, mask.nx, 1);
  return depths;
}

// Let D(p) be the distance from p to the nearest middle of a cell outside. D^2 - |p|^2 is a minimum of linear
// functions, so concave: where weights w average points q to p, D^2(p) >= sum w D^2(q) - (sum w |q|^2 - |p|^2). Between
// two points of a line s apart the last term is at most s^2 / 4; for bilinear weights at (s, t) of a square it is s (1
// - s) + t (1 - t). The traced line's corners are found by interpolating D^2 along the grid's edges, its segments cross
// a square (s^2 <= 2): D^2 >= V - 1/4 - 2/4. Points of a cell are within sqrt(1/2) of its middle.
std::vector<Loop> loops_at_depth(const Mask& mask, std::span<const float> depths, double depth_cells,
                                 double loss_cells) {
  constexpr double kRounding = 1e-3;
  const double deep = depth_cells + std::sqrt(0.5) + kRounding;
  const std::vector<Loop> loops = Tracer(mask, depths, static_cast<float>(deep * deep + 0.75)).run();
  const Shortener shortener(mask, depths, deep * deep, loss_cells);
  std::vector<Loop> straight;
  for (const Loop& loop : loops) {
    Loop simple = shortener.run(loop);
    if (simple.size() >= 3) straight.push_back(std::move(simple));
  }
  return straight;
}

}  // namespace promenade
