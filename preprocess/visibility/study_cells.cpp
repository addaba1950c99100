#include "preprocess/visibility/study_cells.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace promenade {
namespace {

constexpr uint32_t kPlanPx = 1024;

/// Heights seen from straight above.
class HeightPlan {
 public:
  static Result<HeightPlan> draw(const NodeMeshes& meshes, const Box& box) {
    const Model& model = meshes.model().model();
    HeightPlan plan;
    plan.box_ = box;
    plan.px_per_m_ = double(kPlanPx) / double(std::max({box.size().x, box.size().y, 1e-3F}));
    std::vector<NodeId> nodes = model.tables.roots, drawn;
    while (!nodes.empty()) {  // as coarse as half a pixel allows
      const NodeId id = nodes.back();
      nodes.pop_back();
      const NodeRecord& node = model.tables.nodes[index_of(id)];
      if (node.child_count == 0 || double(node.error_m) * plan.px_per_m_ < 0.5) {
        drawn.push_back(id);
        continue;
      }
      for (const NodeId child : model.children_of(id)) nodes.push_back(child);
    }
    const Result<HeldNodes> held = hold_nodes(meshes, drawn);
    if (!held) return held.error();
    RasterView view;
    view.eye = glm::dvec3(glm::dvec2(box.center()), double(box.max.z) + 1);
    view.right = {1, 0, 0}, view.up = {0, 1, 0}, view.forward = {0, 0, -1};
    view.width_px = view.height_px = kPlanPx;
    view.scale_px = plan.px_per_m_, view.near_m = 0, view.orthographic = true;
    VisibilityBuffer buffer;
    PROMENADE_TRY(buffer.draw(view, held->items));
    plan.heights_.resize(size_t(kPlanPx) * kPlanPx);
    buffer.read_depth_m(plan.heights_);
    for (float& h : plan.heights_) h = static_cast<float>(view.eye.z) - h;
    return plan;
  }

  /// Lowest and highest within a rectangle of the plan; -infinity where nothing is.
  std::pair<float, float> range(const glm::vec2& low, const glm::vec2& high) const {
    const auto pixel = [&](float at, int axis) {
      const double off = (double(at) - double(box_.center()[axis])) * px_per_m_ + kPlanPx / 2.0;
      return static_cast<uint32_t>(std::clamp(off, 0.0, kPlanPx - 1.0));
    };
    float least = std::numeric_limits<float>::infinity(), most = -least;
    for (uint32_t y = pixel(low.y, 1); y <= pixel(high.y, 1); ++y)
      for (uint32_t x = pixel(low.x, 0); x <= pixel(high.x, 0); ++x) {
        const float h = heights_[size_t(kPlanPx - 1 - y) * kPlanPx + x];
        least = std::min(least, h), most = std::max(most, h);
      }
    return {least, most};
  }

 private:
  Box box_;
  double px_per_m_ = 1;
  std::vector<float> heights_;
};

bool between_houses(const HeightPlan& plan, const glm::vec2& low, float side, float street_m) {
  constexpr float kReachM = 40, kHouseM = 3;
  const glm::vec2 high = low + side;
  const auto is_high = [&](const glm::vec2& from, const glm::vec2& to) {
    return plan.range(from, to).second - street_m > kHouseM;
  };
  return is_high({low.x - kReachM, low.y}, {low.x, high.y}) && is_high({high.x, low.y}, {high.x + kReachM, high.y}) &&
         is_high({low.x, low.y - kReachM}, {high.x, low.y}) && is_high({low.x, high.y}, {high.x, high.y + kReachM});
}

}  // namespace

Result<std::vector<Box>> study_cells(const NodeMeshes& meshes, const StudyCellOptions& options) {
  const Model& model = meshes.model().model();
  Box box;
  for (const NodeId root : model.tables.roots) box.add(model.tables.nodes[index_of(root)].box);
  std::vector<Box> cells;
  if (box.empty()) return cells;
  const Result<HeightPlan> plan = HeightPlan::draw(meshes, box);
  if (!plan) return plan.error();
  std::mt19937_64 random(options.seed);
  const auto unit = [&] { return static_cast<float>(double(random() >> 11U) * 0x1p-53); };
  const float side = std::min({options.side_m, box.size().x, box.size().y});
  const uint32_t most_tries = options.cells * 400;
  for (uint32_t i = 0; i < most_tries && cells.size() < options.cells; ++i) {
    const glm::vec2 low = glm::vec2(box.min) + glm::vec2(unit(), unit()) * (glm::vec2(box.size()) - side);
    const float lift = unit();
    const auto [least, most] = plan->range(low, low + side);
    if (!std::isfinite(least)) continue;
    float z = most + 0.1F, height = options.height_m;
    if (options.place == StudyPlace::street) {
      // A street is flat, and on each side of it something is much higher.
      if (most - least > 0.5F || !between_houses(*plan, low, side, most)) continue;
    } else {
      height = side;
      z = most + 0.5F + lift * std::max(1.0F, box.max.z + box.size().z / 3 - most);
    }
    cells.push_back({{low, z}, {low + side, z + height}});
  }
  return cells;
}

}  // namespace promenade
