#include "datasets/city_kerb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "datasets/city_block.h"

namespace promenade {
namespace {

constexpr double kParkingSlotM = 6.2;
constexpr double kLongestCarM = 5.4;
constexpr double kFromKerbM = 1.3;     // a parked car's middle
constexpr double kFurnitureM = 0.65;   // from the kerb to the middle of lamps and trees: clear of the walking line
constexpr double kLeastPavementM = 2;  // narrower ones stay empty

/// One side of a block: a line in the plan along its kerb.
class KerbSide {
 public:
  KerbSide(const CityPlan& plan, uint32_t x, uint32_t y, size_t side, double detail, std::vector<KerbProp>& props)
      : plan_(plan), detail_(detail), random_(plan.options().seed, {0x4e4b, x, y, side}), props_(props) {
    const PlanRect block = plan.block(x, y);
    const std::array<glm::dvec2, 4> corners = {
        block.low, {block.high.x, block.low.y}, block.high, {block.low.x, block.high.y}};
    from_ = corners[side], to_ = corners[(side + 1) % 4];
    length_m_ = 0;
    const std::vector<glm::dvec2> points = plan.line(from_, to_, 6);
    for (size_t i = 0; i + 1 < points.size(); ++i) length_m_ += glm::distance(points[i], points[i + 1]);
  }

  void corner();
  void trees();
  void furniture();
  void cars();

 private:
  /// Whether the pavement is free around a place on it; takes it if so.
  bool take(double along_m, double half_m) {
    if (along_m < 4.5 || along_m > length_m_ - 4.5) return false;
    for (const auto& [at, half] : taken_)
      if (std::abs(at - along_m) < half + half_m) return false;
    taken_.emplace_back(along_m, half_m);
    return true;
  }
  /// into_m: from the kerb into the block. turn_rad: 0 faces the street with -y.
  void put(PropClass prop, uint32_t variant, double along_m, double into_m, double turn_rad = 0, double scale = 1) {
    const glm::dvec2 p = glm::mix(from_, to_, along_m / length_m_);
    const glm::dvec2 way = plan_.direction(p, to_ - from_), in(-way.y, way.x);
    props_.push_back({prop, variant, plan_.world(p) + in * into_m, std::atan2(way.y, way.x) + turn_rad, scale});
  }

  const CityPlan& plan_;
  double detail_;
  Random random_;
  std::vector<KerbProp>& props_;
  glm::dvec2 from_{0}, to_{0};
  double length_m_ = 0;
  std::vector<std::pair<double, double>> taken_;
};

void KerbSide::corner() {
  if (plan_.options().curb_width_m < kLeastPavementM || length_m_ < 24) return;
  if (plan_.options().street_width_m >= 10 && detail_ > 0.7 && take(4.8, 0.4))
    put(PropClass::traffic_light, 0, 4.8, 0.45);
  if (random_.chance(0.35) && take(length_m_ - 5, 0.4))
    put(PropClass::sign, random_.below(3), length_m_ - 5, 0.4, -std::numbers::pi / 2);
}

void KerbSide::trees() {
  const double apart = plan_.options().tree_distance_m;
  if (plan_.options().curb_width_m < kLeastPavementM) return;
  const uint32_t kind = random_.below(variants_of(PropClass::tree));
  for (double s = 6 + std::min(apart / 2, 6.0); s < length_m_ - 6; s += apart) {
    // A street's trees are of one kind, mostly.
    const uint32_t variant = random_.chance(0.8) ? kind : random_.below(variants_of(PropClass::tree));
    if (take(s, 0.6)) put(PropClass::tree, variant, s, kFurnitureM, random_.range(0.0, 6.28), random_.range(0.85, 1.1));
  }
}

void KerbSide::furniture() {
  if (plan_.options().curb_width_m < kLeastPavementM) return;
  const uint32_t lamp = Random(plan_.options().seed, {0x1a}).below(2);
  for (double s = 9; s < length_m_ - 8; s += 30)
    if (take(s, 0.5)) put(PropClass::lamp, lamp, s, 0.45, std::numbers::pi);
  const double much = std::clamp(detail_ * 0.5, 0.1, 1.5);
  if (plan_.options().street_width_m >= 10 && random_.chance(0.12 * much)) {
    const double s = length_m_ * random_.range(0.3, 0.7);
    if (take(s, 2.3)) put(PropClass::bus_stop, 0, s, 0.68, 0);
  }
  const std::array<std::pair<PropClass, double>, 4> kinds = {
      std::pair(PropClass::bench, 1.1), {PropClass::hydrant, 0.4}, {PropClass::bin, 0.5}, {PropClass::sign, 0.4}};
  for (const auto& [prop, half] : kinds)
    for (int k = 0; k < 2; ++k) {
      const double s = length_m_ * random_.range(0.06, 0.94);
      const bool wanted = random_.chance(0.4 * much);
      const uint32_t variant = random_.below(variants_of(prop));
      if (wanted && take(s, half))
        put(prop, variant, s, prop == PropClass::bench ? 0.7 : 0.5, prop == PropClass::bench ? std::numbers::pi : 0);
    }
}

void KerbSide::cars() {
  if (plan_.options().street_width_m < 9) return;
  const double share = std::clamp(0.045 * detail_, 0.0, 0.92);
  const auto slots = static_cast<int>((length_m_ - 2 * kClearCornerM) / kParkingSlotM);
  for (int k = 0; k < slots; ++k) {
    Random random = random_.fork(static_cast<uint64_t>(k));
    const double slack = kParkingSlotM - kLongestCarM;
    const double s = kClearCornerM + kParkingSlotM * (k + 0.5) + random.range(-slack, slack) / 2;
    const uint32_t variant = random.below(variants_of(PropClass::car));
    if (!random.chance(share)) continue;
    // Traffic keeps to the right, so that it passes a block clockwise.
    const double turn_rad = std::numbers::pi + random.range(-0.02, 0.02);
    put(PropClass::car, variant, s, -kFromKerbM + random.range(-0.12, 0.06), turn_rad);
  }
}

}  // namespace

double walking_line_m(const CityOptions& options) { return options.curb_width_m * 0.7; }

std::vector<KerbProp> kerb_props(const CityPlan& plan, uint32_t x, uint32_t y, bool tree_lined, double detail) {
  std::vector<KerbProp> props;
  for (size_t side = 0; side < 4; ++side) {
    KerbSide kerb(plan, x, y, side, detail, props);
    kerb.corner();
    if (tree_lined) kerb.trees();
    kerb.furniture();
    kerb.cars();
  }
  return props;
}

}  // namespace promenade
