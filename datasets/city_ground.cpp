// Source: [xiong1996] appendix A: curbs, parks of four L-shaped strips, fountains of nested layers.

#include "datasets/city_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace promenade {
namespace {

constexpr Color kAsphalt = rgb(74, 75, 78);
constexpr Color kMarking = rgb(214, 212, 204);
constexpr Color kKerb = rgb(176, 172, 164);
constexpr Color kPavement = rgb(158, 152, 144);
constexpr Color kGrass = rgb(104, 136, 68);
constexpr float kMarkingHeightM = 0.02F;
constexpr int kArc = 4;  // segments around a block's corner

/// A rounded rectangle of the plan, side by side: each from the middle of one corner's arc to the middle of the next.
/// Rings of the same block with other insets have the same counts.
struct Ring {
  std::array<std::vector<glm::dvec2>, 4> sides;  ///< plan; south, east, north, west

  Ring(const PlanRect& block, double inset, double corner_m, double step_m) {
    const PlanRect rect = block.inset(inset);
    const double radius = std::max(corner_m - inset, 0.05);
    const std::array<glm::dvec2, 4> corners = {
        rect.low, {rect.high.x, rect.low.y}, rect.high, {rect.low.x, rect.high.y}};
    const std::array<glm::dvec2, 4> ways = {glm::dvec2(1, 0), {0, 1}, {-1, 0}, {0, -1}};
    for (size_t s = 0; s < 4; ++s) {
      const double length = s % 2 == 0 ? block.size().x : block.size().y;
      const int steps = std::max(2, static_cast<int>(std::ceil(length / step_m)));
      const glm::dvec2 way = ways[s], in(-way.y, way.x);
      const auto arc = [&](const glm::dvec2& corner, const glm::dvec2& center_way, double angle) {
        const glm::dvec2 center = corner + (center_way + in) * radius;
        return center - in * (radius * std::cos(angle)) + way * (radius * std::sin(angle));
      };
      for (int k = kArc / 2; k >= 1; --k) sides[s].push_back(arc(corners[s], way, -std::numbers::pi / 2 * k / kArc));
      const glm::dvec2 from = corners[s] + way * radius, to = corners[(s + 1) % 4] - way * radius;
      for (int k = 0; k <= steps; ++k) sides[s].push_back(glm::mix(from, to, static_cast<double>(k) / steps));
      for (int k = 1; k <= kArc / 2; ++k)
        sides[s].push_back(arc(corners[(s + 1) % 4], -way, std::numbers::pi / 2 * k / kArc));
    }
  }
};

class GroundBuilder {
 public:
  GroundBuilder(Shape& shape, const CityPlan& plan, uint32_t x, uint32_t y, const LocalFrame& frame)
      : shape_(shape),
        plan_(plan),
        options_(plan.options()),
        x_(x),
        y_(y),
        frame_(frame),
        cell_(plan.cell(x, y)),
        block_(plan.block(x, y)) {}

  void street();
  void pavement(Color inner_color);
  void markings();
  void underlay();

 private:
  float street_z() const { return static_cast<float>(options_.street_height_m); }
  float kerb_z() const { return static_cast<float>(options_.street_height_m + options_.curb_height_m); }
  glm::vec3 at(const glm::dvec2& world, float z) const { return {frame_.local(world), z}; }
  std::vector<glm::vec3> lifted(const std::vector<glm::dvec2>& plan_points, float z) const {
    std::vector<glm::vec3> points;
    points.reserve(plan_points.size());
    for (const glm::dvec2& p : plan_points) points.push_back(at(plan_.world(p), z));
    return points;
  }
  std::vector<glm::vec3> ring(double inset, float z) const {
    std::vector<glm::vec3> points;
    const Ring r(block_, inset, corner_m(), step_m());
    for (const auto& side : r.sides) {
      const std::vector<glm::vec3> part = lifted(side, z);
      points.insert(points.end(), part.begin(), part.end());
    }
    return points;
  }
  double corner_m() const { return std::min({3.0, block_.size().x / 4, block_.size().y / 4}); }
  /// Along straight kerbs, at most.
  double step_m() const { return options_.plain && options_.style == StreetStyle::grid ? 60 : 6; }
  void band(const std::vector<glm::vec3>& outer, const std::vector<glm::vec3>& inner);
  void mark(const glm::dvec2& low, const glm::dvec2& high);

  Shape& shape_;
  const CityPlan& plan_;
  const CityOptions& options_;
  uint32_t x_, y_;
  const LocalFrame& frame_;
  PlanRect cell_, block_;
};

/// Between two closed lines of as many points.
void GroundBuilder::band(const std::vector<glm::vec3>& outer, const std::vector<glm::vec3>& inner) {
  const auto n = static_cast<uint32_t>(outer.size());
  const uint32_t first = shape_.vertex(outer[0]);
  for (uint32_t i = 1; i < n; ++i) shape_.vertex(outer[i]);
  for (const glm::vec3& p : inner) shape_.vertex(p);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = (i + 1) % n;
    // The arcs' ends meet: no quad between equal points.
    if (outer[i] == outer[j]) continue;
    shape_.quad(first + i, first + j, first + n + j, first + n + i);
  }
}

void GroundBuilder::street() {
  shape_.color(kAsphalt);
  const Ring kerb(block_, 0, corner_m(), step_m());
  const std::array<glm::dvec2, 4> corners = {
      cell_.low, {cell_.high.x, cell_.low.y}, cell_.high, {cell_.low.x, cell_.high.y}};
  for (size_t s = 0; s < 4; ++s) {
    std::vector<glm::vec3> outer;
    for (const glm::dvec2& p : plan_.joint(corners[s], corners[(s + 1) % 4])) outer.push_back(at(p, street_z()));
    shape_.stitch(outer, lifted(kerb.sides[s], street_z()));
  }
}

/// A rectangle below everything, wider than the cell: whatever rounding leaves open between cells shows asphalt.
void GroundBuilder::underlay() {
  glm::vec2 low(1e9F), high(-1e9F);
  const std::array<glm::dvec2, 4> corners = {
      cell_.low, {cell_.high.x, cell_.low.y}, cell_.high, {cell_.low.x, cell_.high.y}};
  for (size_t s = 0; s < 4; ++s)
    for (const glm::dvec2& p : plan_.joint(corners[s], corners[(s + 1) % 4]))
      low = glm::min(low, frame_.local(p)), high = glm::max(high, frame_.local(p));
  // The city ends in a margin of grass.
  const bool edge = x_ == 0 || y_ == 0 || x_ + 1 == plan_.blocks_x() || y_ + 1 == plan_.blocks_y();
  const auto margin = static_cast<float>(options_.street_width_m * 0.75 + 25);
  const float z = street_z() - 0.25F;
  shape_.color(edge ? shade(kGrass, 0.9F) : kAsphalt);
  if (x_ == 0) low.x -= margin;
  if (y_ == 0) low.y -= margin;
  if (x_ + 1 == plan_.blocks_x()) high.x += margin;
  if (y_ + 1 == plan_.blocks_y()) high.y += margin;
  shape_.face({low, z}, {high.x, low.y, z}, {high, z}, {low.x, high.y, z});
}

void GroundBuilder::pavement(Color inner_color) {
  const std::vector<glm::vec3> foot = ring(0, street_z()), edge = ring(0, kerb_z()),
                               stone = ring(std::min(0.18, options_.curb_width_m / 2), kerb_z());
  const std::vector<glm::vec3> inside = ring(options_.curb_width_m, kerb_z());
  shape_.color(kKerb);
  if (kerb_z() > street_z()) band(foot, edge);
  band(edge, stone);
  shape_.color(kPavement);
  band(stone, inside);
  shape_.color(inner_color);
  const auto n = static_cast<uint32_t>(inside.size());
  const uint32_t middle = shape_.vertex(at(plan_.world((block_.low + block_.high) * 0.5), kerb_z()));
  for (const glm::vec3& p : inside) shape_.vertex(p);
  for (uint32_t i = 0; i < n; ++i)
    if (inside[i] != inside[(i + 1) % n]) shape_.triangle(middle, middle + 1 + i, middle + 1 + (i + 1) % n);
}

void GroundBuilder::mark(const glm::dvec2& low, const glm::dvec2& high) {
  const float z = street_z() + kMarkingHeightM;
  shape_.face(at(plan_.world(low), z), at(plan_.world({high.x, low.y}), z), at(plan_.world(high), z),
              at(plan_.world({low.x, high.y}), z));
}

/// This cell's half of the dashes in the middle of its streets, and of the crossings at its corners.
void GroundBuilder::markings() {
  if (options_.street_width_m < 6) return;
  shape_.color(kMarking);
  constexpr double kDashM = 3, kPeriodM = 9, kHalfM = 0.07;
  const double clear = options_.street_width_m / 2 + 7;
  const auto first = [&](double low) { return std::ceil((low + clear) / kPeriodM) * kPeriodM; };
  for (double u = first(cell_.low.x); u + kDashM < cell_.high.x - clear; u += kPeriodM) {
    if (y_ > 0) mark({u, cell_.low.y}, {u + kDashM, cell_.low.y + kHalfM});
    if (y_ + 1 < plan_.blocks_y()) mark({u, cell_.high.y - kHalfM}, {u + kDashM, cell_.high.y});
  }
  for (double v = first(cell_.low.y); v + kDashM < cell_.high.y - clear; v += kPeriodM) {
    if (x_ > 0) mark({cell_.low.x, v}, {cell_.low.x + kHalfM, v + kDashM});
    if (x_ + 1 < plan_.blocks_x()) mark({cell_.high.x - kHalfM, v}, {cell_.high.x, v + kDashM});
  }
  // Crossings lead from pavement to pavement: stripes along the way of the cars, side by side across the street.
  constexpr double kNearM = 1.0, kLongM = 2.8, kStripeM = 0.5;
  const double half = options_.street_width_m / 2;
  for (double w = 0.25; w + kStripeM < half; w += 2 * kStripeM)
    for (const bool far : {false, true}) {
      const double v = far ? block_.high.y - kNearM - kLongM : block_.low.y + kNearM;
      const double u = far ? block_.high.x - kNearM - kLongM : block_.low.x + kNearM;
      if (x_ > 0) mark({cell_.low.x + w, v}, {cell_.low.x + w + kStripeM, v + kLongM});
      if (x_ + 1 < plan_.blocks_x()) mark({cell_.high.x - w - kStripeM, v}, {cell_.high.x - w, v + kLongM});
      if (options_.style == StreetStyle::organic) continue;  // pavements do not face each other across the long streets
      if (y_ > 0) mark({u, cell_.low.y + w}, {u + kLongM, cell_.low.y + w + kStripeM});
      if (y_ + 1 < plan_.blocks_y()) mark({u, cell_.high.y - w - kStripeM}, {u + kLongM, cell_.high.y - w});
    }
}

}  // namespace

void build_ground(Shape& shape, const CityPlan& plan, uint32_t x, uint32_t y, const LocalFrame& frame,
                  Color inner_color) {
  GroundBuilder ground(shape, plan, x, y, frame);
  ground.underlay();
  ground.street();
  ground.pavement(inner_color);
  if (!plan.options().plain) ground.markings();
}

void build_park(Shape& shape, std::span<const glm::vec2> corners, float z) {
  const std::array<glm::vec2, 3> stone = {glm::vec2(0, z - 0.05F), {0, z + 0.14F}, {-0.14F, z + 0.14F}};
  for (size_t i = 0; i < 4; ++i) {
    const glm::vec2 here = corners[i];
    const auto point = [&](float along, float across) {
      const glm::vec2 next = corners[(i + 1) % 4], before = corners[(i + 3) % 4], opposite = corners[(i + 2) % 4];
      return glm::mix(glm::mix(here, next, along), glm::mix(before, opposite, along), across);
    };
    const std::array<glm::vec2, 6> strip = {point(0.04F, 0.04F), point(0.44F, 0.04F), point(0.44F, 0.2F),
                                            point(0.2F, 0.2F),   point(0.2F, 0.44F),  point(0.04F, 0.44F)};
    shape.color(rgb(168, 162, 150));
    shape.ring(strip, stone);
    shape.color(kGrass);
    shape.cap(outset(strip, -0.14F), z + 0.11F);
  }
}

void build_fountain(Shape& shape, const glm::vec2& center, float radius, float height, float z, int layers, int sides) {
  for (int k = 0; k < layers; ++k) {
    const float share = static_cast<float>(k + 1) / static_cast<float>(layers);
    const float r = radius * (1 - 0.8F * static_cast<float>(k) / static_cast<float>(layers)),
                top = z + height * share * share;
    std::vector<glm::vec2> circle;
    for (int i = 0; i < sides; ++i) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
      circle.push_back(center + r * glm::vec2(std::cos(angle), std::sin(angle)));
    }
    const float wall = std::min(0.3F, r * 0.3F);
    const std::array<glm::vec2, 6> profile = {
        glm::vec2(0.06F, z - 0.1F), {0, z + 0.08F}, {0, top - 0.1F}, {0.07F, top}, {-wall, top}, {-wall, top - 0.2F}};
    shape.color(shade(rgb(178, 170, 156), 1 - 0.05F * static_cast<float>(k)));
    shape.ring(circle, profile);
    shape.color(rgb(96, 148, 168));
    shape.cap(outset(circle, -wall), top - 0.18F);
  }
  shape.color(rgb(214, 232, 238));
  shape.cylinder({center, z + height - 0.2F}, 0.12F, 0.03F, 0.9F + height * 0.4F, std::max(6, sides / 3));
}

}  // namespace promenade
