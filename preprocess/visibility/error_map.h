#pragma once
// How far what is drawn may lie from the source, around each place of the plan.

#include <algorithm>
#include <span>
#include <vector>

#include "layout/model_io.h"

namespace promenade {

/// The greatest error of what is drawn around each place of the plan.
class ErrorMap {
 public:
  ErrorMap(const Model& model, std::span<const NodeId> front) : errors_(size_t(kErrorGrid) * kErrorGrid, 0) {
    for (const NodeId id : front) box_.add(model.tables.nodes[index_of(id)].box);
    for (const NodeId id : front) {
      if (model.is_moving(id)) continue;  // it stands for no occluder
      const NodeRecord& node = model.tables.nodes[index_of(id)];
      visit(node.box, [&](float& error) { error = std::max(error, node.error_m); });
    }
  }
  float around(const Box& box) {
    float most = 0;
    visit(box, [&](const float& error) { most = std::max(most, error); });
    return most;
  }

 private:
  static constexpr uint32_t kErrorGrid = 64;  // squares a side
  template <class Visit>
  void visit(const Box& box, const Visit& visit) {
    const glm::vec3 scale = float(kErrorGrid) / glm::max(box_.size(), glm::vec3(1e-6F));
    const auto cell = [&](float at, int axis) {
      return static_cast<uint32_t>(std::clamp((at - box_.min[axis]) * scale[axis], 0.0F, float(kErrorGrid - 1)));
    };
    for (uint32_t y = cell(box.min.y, 1); y <= cell(box.max.y, 1); ++y)
      for (uint32_t x = cell(box.min.x, 0); x <= cell(box.max.x, 0); ++x) visit(errors_[size_t(y) * kErrorGrid + x]);
  }
  Box box_;
  std::vector<float> errors_;
};

}  // namespace promenade
