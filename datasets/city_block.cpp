#include "datasets/city_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "datasets/city_ground.h"
#include "datasets/city_kerb.h"
#include "datasets/city_lots.h"

namespace promenade {
namespace {

using Quad = std::array<glm::vec2, 4>;

std::vector<glm::vec2> circle_in(const Quad& q, float bay_m) {
  const glm::vec2 center = (q[0] + q[1] + q[2] + q[3]) * 0.25F;
  float radius = 1e9F;
  for (size_t i = 0; i < 4; ++i) {
    const WallFrame f = WallFrame::between(q[i], q[(i + 1) % 4]);
    radius = std::min(radius, glm::dot(f.origin - center, f.out));
  }
  const int sides = std::clamp(static_cast<int>(2 * std::numbers::pi_v<float> * radius / bay_m), 12, 40);
  std::vector<glm::vec2> circle;
  for (int i = 0; i < sides; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * (static_cast<float>(i) + 0.5F) / static_cast<float>(sides);
    circle.push_back(center + radius * glm::vec2(std::cos(angle), std::sin(angle)));
  }
  return circle;
}

/// The lot's quadrilateral without its corner `i`.
std::vector<glm::vec2> l_shape(const Quad& q, size_t i, float along, float across) {
  const auto point = [&](float s, float t) {
    return glm::mix(glm::mix(q[i], q[(i + 1) % 4], s), glm::mix(q[(i + 3) % 4], q[(i + 2) % 4], s), t);
  };
  return {point(along, 0), q[(i + 1) % 4], q[(i + 2) % 4], q[(i + 3) % 4], point(0, across), point(along, across)};
}

class BlockMaker {
 public:
  BlockMaker(const CityPlan& plan, uint32_t x, uint32_t y, const BlockOptions& options, PropLibrary& props)
      : plan_(plan), x_(x), y_(y), options_(options), props_(props), random_(plan.options().seed, {0x5e7, x, y}) {
    const PlanRect block = plan.block(x, y);
    ground_frame_.origin = plan.world((block.low + block.high) * 0.5);
    z_ = plan.options().street_height_m + plan.options().curb_height_m;
  }

  CityBlock make();

 private:
  Quad quad_of(const PlanRect& rect, const LocalFrame& frame) const {
    return {frame.local(plan_.world(rect.low)), frame.local(plan_.world({rect.high.x, rect.low.y})),
            frame.local(plan_.world(rect.high)), frame.local(plan_.world({rect.low.x, rect.high.y}))};
  }
  void add(Shape& shape, std::string_view class_name, const glm::dvec3& origin,
           std::optional<FacadeSketch> facade = {});
  void add_building(const Lot& lot);
  HousePlan house_of(const Lot& lot, const LocalFrame& frame, Random random) const;
  void add_park(const PlanRect& rect, bool fountain, Random random);
  void add_fountain(const PlanRect& rect, Random random);
  void add_ground(Color inner);
  void add_prop(PropClass prop, uint32_t variant, const glm::dvec2& at, double yaw_rad, double scale = 1);
  int level(PropClass prop, Random& random) const;

  const CityPlan& plan_;
  uint32_t x_, y_;
  const BlockOptions& options_;
  PropLibrary& props_;
  Random random_;
  LocalFrame ground_frame_;
  double z_ = 0;
  CityBlock result_;
};

void BlockMaker::add(Shape& shape, std::string_view class_name, const glm::dvec3& origin,
                     std::optional<FacadeSketch> facade) {
  result_.unique_triangles += shape.triangles(), result_.triangles += shape.triangles();
  if (options_.counting || shape.triangles() == 0) return;
  UniqueObject object;
  object.name = fmt::format("{}_{}_{}_{}", class_name, x_, y_, result_.objects.size());
  object.class_name = class_name;
  object.mesh = shape.take();
  object.origin = origin;
  object.facade = std::move(facade);
  result_.objects.push_back(std::move(object));
}

int BlockMaker::level(PropClass prop, Random& random) const {
  const double d = options_.detail, dice = random.unit();
  // Cars and furniture are fine enough at their lowest level for most cities, trees are not.
  double level = prop == PropClass::car ? (d - 5) / 1.3 : (d - 4) / 1.5;
  if (prop == PropClass::tree || prop == PropClass::bush) level = d < 1 ? d - 0.25 : std::max(1.0, 1 + (d - 5.5) / 1.5);
  const double blended = level == 1 ? 1 : level + dice;
  return std::clamp(static_cast<int>(std::floor(blended)), 0, kPropLevels - 1);
}

void BlockMaker::add_prop(PropClass prop, uint32_t variant, const glm::dvec2& at, double yaw_rad, double scale) {
  if (plan_.options().solids || (plan_.options().plain && prop != PropClass::tree)) return;
  Random random(plan_.options().seed, {0x9409, x_, y_, result_.props.size()});
  const PropKind kind{prop, variant, level(prop, random)};
  result_.triangles += props_.mesh(kind).triangle_count();
  const double z = prop == PropClass::car ? plan_.options().street_height_m : z_;
  result_.props.push_back({kind, {at, z}, yaw_rad, scale});
}

HousePlan BlockMaker::house_of(const Lot& lot, const LocalFrame& frame, Random random) const {
  HousePlan house;
  const Quad q = quad_of(lot.rect, frame);
  house.height_m = static_cast<float>(lot.height_m), house.seed = lot.seed;
  const float w = glm::distance(q[0], q[1]), d = glm::distance(q[1], q[2]);
  const double dice = random.unit(), bent = plan_.options().style == StreetStyle::organic ? 0.28 : 0.16;
  const bool squarish = w < 1.7F * d && d < 1.7F * w;
  if (dice < 0.1 && squarish && lot.height_m > 12) {
    house.cylindrical = true;
    house.footprint = circle_in(q, 3.2F);
    house.street.assign(house.footprint.size(), true);
  } else if (dice < 0.1 + bent && std::min(w, d) > 15 && lot.height_m < 40) {
    const size_t i = random.below(4);
    house.footprint = l_shape(q, i, random.range(0.4F, 0.6F), random.range(0.4F, 0.6F));
    // From the corner that is cut: the rest of side i, the next ones, the rest of the last, and two inner sides.
    house.street = {lot.street[i], lot.street[(i + 1) % 4], lot.street[(i + 2) % 4], lot.street[(i + 3) % 4], false,
                    false};
  } else {
    house.footprint = {q[0], q[1], q[2], q[3]};
    house.street = {lot.street[0], lot.street[1], lot.street[2], lot.street[3]};
  }
  return house;
}

void BlockMaker::add_building(const Lot& lot) {
  Random random(lot.seed);
  LocalFrame frame;
  frame.origin = plan_.world((lot.rect.low + lot.rect.high) * 0.5);
  const HousePlan house = house_of(lot, frame, random.fork(1));
  Shape shape(options_.counting);
  FacadeSketch sketch;
  const HouseOptions house_options{options_.detail, plan_.options().interiors, plan_.options().texture_megapixels > 0,
                                   plan_.options().solids, plan_.options().plain};
  build_house(shape, house, house_options, sketch);
  ++result_.buildings;
  result_.facade_m2 += static_cast<double>(sketch.around_m) * sketch.height_m;
  add(shape, "building", {frame.origin, z_}, house_options.textured ? std::optional(std::move(sketch)) : std::nullopt);
}

void BlockMaker::add_fountain(const PlanRect& rect, Random random) {
  const glm::dvec2 middle = plan_.world((rect.low + rect.high) * 0.5);
  const glm::dvec2 size = rect.size();
  Shape shape(options_.counting);
  const float radius = std::min(static_cast<float>(std::min(size.x, size.y)) * 0.3F, random.range(3.0F, 6.5F));
  const int sides = options_.detail < 1 || plan_.options().plain ? 10 : options_.detail < 4 ? 28 : 64;
  build_fountain(shape, {0, 0}, radius, random.range(1.2F, 3.2F), 0, random.between(3, 5), sides);
  add(shape, "fountain", {middle, z_});
}

void BlockMaker::add_park(const PlanRect& rect, bool fountain, Random random) {
  LocalFrame frame;
  frame.origin = plan_.world((rect.low + rect.high) * 0.5);
  Shape shape(options_.counting);
  build_park(shape, quad_of(rect, frame), 0);
  add(shape, "park", {frame.origin, z_});
  if (fountain) add_fountain({rect.low + rect.size() * 0.3, rect.high - rect.size() * 0.3}, random.fork(1));
  const glm::dvec2 size = rect.size();
  const int wish = static_cast<int>(size.x * size.y / 160 * std::clamp(options_.detail * 0.5, 0.15, 1.6)) + 2;
  for (int k = 0; k < std::min(wish, 80); ++k) {
    // Along the two arms of a strip.
    const double arm = random.range(0.07, 0.42), thick = random.range(0.08, 0.16);
    glm::dvec2 t = random.chance(0.5) ? glm::dvec2(arm, thick) : glm::dvec2(thick, arm);
    if (random.chance(0.5)) t.x = 1 - t.x;
    if (random.chance(0.5)) t.y = 1 - t.y;
    const glm::dvec2 at = plan_.world(rect.low + size * t);
    const bool tree = plan_.options().tree_distance_m > 0 && random.chance(0.75) && std::min(size.x, size.y) > 14;
    const PropClass prop = tree ? PropClass::tree : PropClass::bush;
    add_prop(prop, random.below(variants_of(prop)), at, random.range(0.0, 6.28), random.range(0.8, 1.2));
  }
  if (std::min(size.x, size.y) < 16) return;
  for (int k = 0; k < 4; ++k) {
    const double angle = std::numbers::pi / 2 * k;
    const glm::dvec2 way(std::cos(angle), std::sin(angle)),
        at = glm::dvec2(0.5) + way * 0.26 + glm::dvec2(-way.y, way.x) * 0.07;
    const glm::dvec2 toward = plan_.direction(rect.low + size * at, -way);
    add_prop(PropClass::bench, 0, plan_.world(rect.low + size * at),
             std::atan2(toward.y, toward.x) + std::numbers::pi / 2);
    if (k % 2 == 0) add_prop(PropClass::lamp, 0, plan_.world(rect.low + size * (glm::dvec2(0.5) + way * 0.3)), 0);
  }
}

void BlockMaker::add_ground(Color inner) {
  Shape shape(options_.counting);
  build_ground(shape, plan_, x_, y_, ground_frame_, inner);
  add(shape, "ground", {ground_frame_.origin, 0});
}

CityBlock BlockMaker::make() {
  const BlockLots lots = lots_of_block(plan_, x_, y_);
  constexpr std::array<Color, 4> kYards = {rgb(142, 138, 130), rgb(134, 126, 114), rgb(150, 144, 134),
                                           rgb(126, 134, 104)};
  add_ground(lots.park ? rgb(176, 162, 134) : kYards[random_.below(4)]);
  if (lots.park) add_park(plan_.block(x_, y_).inset(plan_.options().curb_width_m), true, random_.fork(1));
  for (const Lot& lot : lots.lots) {
    Random random(lot.seed, {7});
    switch (lot.use) {
      case LotUse::building:
        add_building(lot);
        break;
      case LotUse::park:
        add_park(lot.rect, random.chance(0.4), random);
        break;
      case LotUse::fountain:
        add_fountain(lot.rect, random);
        break;
      case LotUse::empty:
        if (plan_.options().tree_distance_m > 0 && std::min(lot.rect.size().x, lot.rect.size().y) > 3)
          add_prop(PropClass::tree, random.below(8), plan_.world((lot.rect.low + lot.rect.high) * 0.5), 0);
        break;
    }
  }
  for (const KerbProp& prop : kerb_props(plan_, x_, y_, lots.tree_lined, options_.detail))
    add_prop(prop.prop, prop.variant, prop.at, prop.yaw_rad, prop.scale);
  return std::move(result_);
}

}  // namespace

CityBlock make_block(const CityPlan& plan, uint32_t x, uint32_t y, const BlockOptions& options, PropLibrary& props) {
  return BlockMaker(plan, x, y, options, props).make();
}

}  // namespace promenade
