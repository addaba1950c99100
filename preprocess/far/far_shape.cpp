#include "preprocess/far/far_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <unordered_map>

#include "codec/far_coverage.h"
#include "codec/far_mesh.h"
#include "geometry/cube_side.h"
#include "geometry/parallax.h"

namespace promenade {
namespace {

constexpr float kAny = std::numeric_limits<float>::max();
/// Parts of the bound. What depths may be off; how far a triangle's texture may stand aside of its rays. The rest is
/// for rounding depths and interpolating them.
constexpr double kDepthPart = 0.78, kAsidePart = 0.2;

/// A pixel's ray from the centre of the cell.
struct Ray {
  EyeReach reach;
  glm::dvec3 direction{1, 0, 0};  ///< a metre along the side's axis
  double length = 1;              ///< of the direction
};

class RayTable {
 public:
  RayTable(const HalvedGrid& grid, uint32_t side, double cell_m)
      : grid_(grid), axes_(cube_side(side)), half_m_(cell_m / 2) {}
  Ray operator()(uint32_t x, uint32_t y) const {
    const double middle = std::max(grid_.cells() / 2.0, 0.5);
    const glm::dvec3 direction = axes_.forward + (x - middle) / middle * axes_.right + (middle - y) / middle * axes_.up;
    const double length = glm::length(direction);
    return {eye_reach(glm::dvec3(half_m_), direction / length), direction, length};
  }

 private:
  HalvedGrid grid_;
  CubeSide axes_;
  double half_m_;
};

/// One side under way.
struct Shape {
  FarFace face;
  std::vector<float> value, low, high;  ///< box over depth, in steps of FarFace::kNearest; what triangles may show
};

uint16_t code_of(double half_box_m, double depth_m) {
  const double code = std::round(half_box_m / depth_m * FarFace::kNearest);
  return static_cast<uint16_t>(std::clamp(code, 1.0, double(FarFace::kNearest)));
}

/// Depths where nothing is: those of the nearest in the column, or else in the row, so that triangles need not bend.
void fill_depths(const HalvedGrid& grid, std::vector<uint16_t>& depth) {
  const uint32_t side = grid.side();
  const auto take = [&](uint32_t to, uint32_t from) {
    if (depth[to] == 0) depth[to] = depth[from];
  };
  for (uint32_t y = side; y-- > 1;)
    for (uint32_t x = 0; x < side; ++x) take(grid.index(x, y - 1), grid.index(x, y));
  for (uint32_t y = 1; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) take(grid.index(x, y), grid.index(x, y - 1));
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 1; x < side; ++x) take(grid.index(x, y), grid.index(x - 1, y));
    for (uint32_t x = side; x-- > 1;) take(grid.index(x - 1, y), grid.index(x, y));
  }
}

class FarShaper {
 public:
  FarShaper(const FarTables& tables, std::array<std::optional<DrawnSide>, 6>& sides)
      : tables_(tables), grid_{tables.face_levels} {
    for (uint32_t s = 0; s < 6; ++s)
      if (sides[s]) begin(s, *sides[s]);
  }

  ShapedFar run() {
    if (tables_.has_depth) {
      join_borders();
      for (uint32_t s = 0; s < 6; ++s)
        if (shapes_[s]) refine(s);
      settle([this](uint32_t s) { return straighten(s); });
      settle([this](uint32_t s) { return halve_what_is_off(s); });
    } else {
      for (std::optional<Shape>& shape : shapes_)
        if (shape) close_halvings(grid_, shape->face.kept);
    }
    ShapedFar made;
    for (uint32_t s = 0; s < 6; ++s) {
      if (!shapes_[s]) continue;
      made.parallax_rad = std::max(made.parallax_rad, measure(s));
      FarFace& face = shapes_[s]->face;
      for (uint32_t i = 0; i < grid_.vertices(); ++i)
        if (face.kept[i] == 0) face.depth[i] = 0;
      made.faces[s] = std::move(face);
    }
    return made;
  }

 private:
  void begin(uint32_t s, DrawnSide& drawn) {
    Shape shape;
    shape.face.grid = grid_;
    shape.face.colors = std::move(drawn.colors);
    shape.face.kept.assign(grid_.vertices(), 0);
    shape.face.depth.assign(grid_.vertices(), FarFace::kNearest);
    if (tables_.has_depth) {
      for (uint32_t i = 0; i < grid_.vertices(); ++i)
        shape.face.depth[i] = there(shape, i) ? code_of(tables_.box_m / 2, double(drawn.depth_m[i])) : 0;
      fill_depths(grid_, shape.face.depth);
    }
    depth_m_[s] = std::move(drawn.depth_m);
    shapes_[s] = std::move(shape);
  }

  static bool there(const Shape& shape, uint32_t i) { return shape.face.colors.pixels[i].a != 0; }

  /// Vertices that sides have in common, as a place on the cube in whole numbers.
  template <class Visit>
  void for_each_border(uint32_t s, Visit&& visit) const {
    const CubeSide axes = cube_side(s);
    const int64_t n = grid_.cells();
    for (int64_t y = 0; y <= n; ++y)
      for (int64_t x = 0; x <= n; x += y == 0 || y == n ? 1 : n) {
        const glm::dvec3 at = double(n) * axes.forward + double(2 * x - n) * axes.right + double(n - 2 * y) * axes.up;
        const auto key = static_cast<uint64_t>(((int64_t(at.x) + n) * (2 * n + 1) + int64_t(at.y) + n) * (2 * n + 1) +
                                               int64_t(at.z) + n);
        visit(key, grid_.index(static_cast<uint32_t>(x), static_cast<uint32_t>(y)));
      }
  }

  /// A vertex of two or three sides is one ray. Where rounding lets them see different things along it, as at what the
  /// box cuts, all get the nearest that one of them saw, its depth and its colour.
  void join_borders() {
    struct Seen {
      uint16_t depth = 0;
      bool there = false;
      float depth_m = 0;
      glm::u8vec4 color{0};
    };
    std::unordered_map<uint64_t, Seen> joined;
    for (uint32_t s = 0; s < 6; ++s)
      if (shapes_[s])
        for_each_border(s, [&](uint64_t key, uint32_t i) {
          Seen& seen = joined[key];
          const bool is_there = there(*shapes_[s], i);
          const uint16_t depth = shapes_[s]->face.depth[i];
          if (is_there && (!seen.there || depth_m_[s][i] < seen.depth_m))
            seen = {depth, true, depth_m_[s][i], shapes_[s]->face.colors.pixels[i]};
          else if (!is_there && !seen.there)
            seen.depth = std::max(seen.depth, depth);
        });
    for (uint32_t s = 0; s < 6; ++s)
      if (shapes_[s])
        for_each_border(s, [&](uint64_t key, uint32_t i) {
          const Seen& seen = joined[key];
          shapes_[s]->face.depth[i] = seen.depth;
          if (!there(*shapes_[s], i)) return;
          depth_m_[s][i] = seen.depth_m;
          shapes_[s]->face.colors.pixels[i] = seen.color;
        });
  }

  /// Keeps a border's vertices on all sides that have them; true: some were not.
  bool share_borders() {
    std::unordered_map<uint64_t, uint8_t> shared;
    for (uint32_t s = 0; s < 6; ++s)
      if (shapes_[s]) for_each_border(s, [&](uint64_t key, uint32_t i) { shared[key] |= shapes_[s]->face.kept[i]; });
    bool added = false;
    for (uint32_t s = 0; s < 6; ++s) {
      if (!shapes_[s]) continue;
      std::vector<uint8_t>& kept = shapes_[s]->face.kept;
      bool here = false;
      for_each_border(s, [&](uint64_t key, uint32_t i) {
        here = here || kept[i] != shared[key];
        kept[i] = shared[key];
      });
      if (here) close_halvings(grid_, kept);
      added = added || here;
    }
    return added;
  }

  void refine(uint32_t s) {
    Shape& shape = *shapes_[s];
    const RayTable rays(grid_, s, tables_.cell_m);
    shape.value.resize(grid_.vertices());
    shape.low.assign(grid_.vertices(), -kAny), shape.high.assign(grid_.vertices(), kAny);
    const double half_box_m = tables_.box_m / 2;
    for (uint32_t y = 0, i = 0; y < grid_.side(); ++y)
      for (uint32_t x = 0; x < grid_.side(); ++x, ++i) {
        const uint16_t code = shape.face.depth[i];
        shape.value[i] = code;
        if (!there(shape, i)) continue;
        const Ray ray = rays(x, y);
        const double true_m = half_box_m / code * FarFace::kNearest * ray.length;
        const DistanceRange range = drawable_range(ray.reach, true_m, tables_.bound_rad * kDepthPart);
        // Drawn kFarPush farther than the triangles say. A vertex's own depth must do.
        const double to_code = half_box_m * ray.length * (1 + kFarPush) * FarFace::kNearest;
        shape.low[i] = std::min(static_cast<float>(to_code / range.to_m), static_cast<float>(code));
        shape.high[i] = std::max(static_cast<float>(to_code / range.from_m), static_cast<float>(code));
      }
    refine_halvings(grid_, shape.value, shape.low, shape.high, shape.face.kept);
    shape.value = {}, shape.low = {}, shape.high = {};
  }

  /// Asks for halvings, side by side, until nobody wants one more.
  template <class Halve>
  void settle(const Halve& halve) {
    bool added = true;
    while (added) {
      added = share_borders();
      for (uint32_t s = 0; s < 6; ++s) added = (shapes_[s] && halve(s)) || added;
    }
  }

  /// Halves triangles whose texture would stand too far aside, by their edges alone: it is drawn straight between
  /// corners, where rays to what is nearer lie closer together. True: some were.
  bool straighten(uint32_t s) {
    Shape& shape = *shapes_[s];
    const FarCoverage coverage(shape.face);
    const int64_t side = grid_.side();
    const double radians_a_pixel = 2.0 / grid_.cells(), reach_m = std::sqrt(3.0) / 2 * tables_.cell_m;
    // An eye may be nearer than the centre. Where the cell fills the box nothing helps.
    const double nearer = std::max(1 - reach_m / (tables_.box_m / 2), 1.0 / 16);
    const double allowed = tables_.bound_rad * kAsidePart * nearer / radians_a_pixel;
    const auto aside = [&](uint32_t p, uint32_t q) {  // pixels, at most
      const double root =
          std::sqrt(std::max<double>(shape.face.depth[p], 1) / std::max<double>(shape.face.depth[q], 1));
      const double part = std::abs(root - 1) / (root + 1);
      return part *
             std::hypot(double(int64_t(p) % side - int64_t(q) % side), double(int64_t(p) / side - int64_t(q) / side));
    };
    std::vector<uint32_t> middles;
    for_each_triangle(grid_, shape.face.kept, [&](uint32_t a, uint32_t b, uint32_t c) {
      const int64_t x = int64_t(a) % side + int64_t(b) % side, y = int64_t(a) / side + int64_t(b) / side;
      if (x % 2 != 0 || y % 2 != 0 || !coverage.any(a, b, c)) return;
      if (std::max({aside(a, b), aside(b, c), aside(c, a)}) > allowed)
        middles.push_back(grid_.index(static_cast<uint32_t>(x / 2), static_cast<uint32_t>(y / 2)));
    });
    for (const uint32_t at : middles) shape.face.kept[at] = 1;
    if (!middles.empty()) close_halvings(grid_, shape.face.kept);
    return !middles.empty();
  }

  /// Halves triangles in which a pixel is drawn too far from its place after all. True: some were.
  bool halve_what_is_off(uint32_t s) {
    std::vector<uint8_t>& kept = shapes_[s]->face.kept;
    std::vector<uint32_t> middles;
    for_each_off(s, [&](uint32_t a, uint32_t b, double off) {
      const uint32_t side = grid_.side(), x = a % side + b % side, y = a / side + b / side;
      if (off > tables_.bound_rad && x % 2 == 0 && y % 2 == 0) middles.push_back(grid_.index(x / 2, y / 2));
    });
    for (const uint32_t at : middles) kept[at] = 1;
    if (!middles.empty()) close_halvings(grid_, kept);
    return !middles.empty();
  }

  /// The largest angle of all its triangles, as for_each_off has it.
  double measure(uint32_t s) const {
    double largest = 0;
    for_each_off(s, [&](uint32_t, uint32_t, double off) { largest = std::max(largest, off); });
    return largest;
  }

  /// Calls visit(a, b, off) for every triangle with the hypotenuse a, b: the largest angle between the point of one of
  /// its pixels and where that is drawn, by the triangles and their texture as they are.
  template <class Visit>
  void for_each_off(uint32_t s, const Visit& visit) const {
    const Shape& shape = *shapes_[s];
    const RayTable rays(grid_, s, tables_.cell_m);
    const double half_box_m = tables_.box_m / 2, push = tables_.has_depth ? 1 + kFarPush : 1;
    const uint32_t side = grid_.side();
    for_each_triangle(grid_, shape.face.kept, [&](uint32_t a, uint32_t b, uint32_t c) {
      double largest = 0;
      const auto x = [side](uint32_t i) { return int64_t(i % side); };
      const auto y = [side](uint32_t i) { return int64_t(i / side); };
      const auto cross = [&](uint32_t p, uint32_t q, int64_t at_x, int64_t at_y) {
        return (x(q) - x(p)) * (at_y - y(p)) - (y(q) - y(p)) * (at_x - x(p));
      };
      const auto area = double(cross(a, b, x(c), y(c)));
      std::array<glm::dvec3, 3> corner;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t at = std::array{a, b, c}[k];
        const double depth_m = half_box_m / std::max<double>(shape.face.depth[at], 1) * FarFace::kNearest * push;
        corner[k] = depth_m * rays(static_cast<uint32_t>(x(at)), static_cast<uint32_t>(y(at))).direction;
      }
      for (int64_t py = std::min({y(a), y(b), y(c)}); py <= std::max({y(a), y(b), y(c)}); ++py)
        for (int64_t px = std::min({x(a), x(b), x(c)}); px <= std::max({x(a), x(b), x(c)}); ++px) {
          const auto i = static_cast<uint32_t>(py * side + px);
          if (!there(shape, i)) continue;
          const int64_t wa = cross(b, c, px, py), wb = cross(c, a, px, py), wc = cross(a, b, px, py);
          if (wa < 0 || wb < 0 || wc < 0) continue;
          const Ray ray = rays(static_cast<uint32_t>(px), static_cast<uint32_t>(py));
          const glm::dvec3 drawn = (double(wa) * corner[0] + double(wb) * corner[1] + double(wc) * corner[2]) / area;
          const double drawn_m = glm::length(drawn), true_m = double(depth_m_[s][i]) * ray.length;
          const double aside_m = glm::length(drawn - ray.direction * (drawn_m / ray.length));
          const double turned = aside_m / std::max(drawn_m - std::hypot(ray.reach.along_m, ray.reach.aside_m), 1e-9);
          double off = parallax_bound_rad(ray.reach, drawn_m, true_m) + turned;
          // That is a little too much: where it matters, corner by corner.
          if (off > tables_.bound_rad)
            off = std::min(off, turned + parallax_rad(glm::dvec3(tables_.cell_m / 2), ray.direction,
                                                      drawn_m / ray.length, true_m / ray.length));
          largest = std::max(largest, std::min(off, glm::pi<double>()));
        }
      visit(a, b, largest);
    });
  }

  const FarTables& tables_;
  HalvedGrid grid_;
  std::array<std::optional<Shape>, 6> shapes_;
  std::array<std::vector<float>, 6> depth_m_;
};

}  // namespace

ShapedFar shape_far(const FarTables& tables, std::array<std::optional<DrawnSide>, 6> sides) {
  return FarShaper(tables, sides).run();
}

}  // namespace promenade
