#include "preprocess/visibility/hiders/solid_occlusion.h"

#include <algorithm>
#include <numeric>

#include "preprocess/visibility/error_map.h"

namespace promenade {
namespace {

constexpr float kRoundM = 1e-4F;  // boxes shrink by this more: roundings to float

}  // namespace

HiddenTargets::HiddenTargets(const HiderQuestion& question, const HeldParts& parts, std::span<const uint8_t> hidden) {
  state_.assign(question.front.size(), State::open);
  node_boxes_.assign(question.front.size(), Box());
  for (uint32_t i = 0; i < question.front.size(); ++i) {
    if (hidden[i] != 0) {
      state_[i] = State::seen;  // nothing to prove; what is set already stays
      continue;
    }
    const size_t first = boxes_.size();
    for (const NodePart& part : parts.of(i)) {
      if (faces_away_from_cell(part.cone, part.box, question.cell)) continue;
      if (part.box.overlaps(question.cell)) {
        state_[i] = State::seen;
        boxes_.resize(first), node_of_.resize(first);
        break;
      }
      boxes_.push_back(part.box), node_of_.push_back(i);
      node_boxes_[i].add(part.box);
    }
  }
}

HiddenTargets::Targets HiddenTargets::all() const {
  Targets all(boxes_.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

HiddenTargets::Targets HiddenTargets::still_open(const Targets& targets) const {
  Targets open;
  open.reserve(targets.size());
  for (const uint32_t t : targets)
    if (state_[node_of_[t]] == State::open) open.push_back(t);
  return open;
}

HiddenTargets::Targets HiddenTargets::not_hidden_in(const BoxView& view, const Targets& targets) const {
  Targets left;
  for (size_t i = 0; i < targets.size();) {
    const uint32_t node = node_of_[targets[i]];
    const bool hidden = view.hides(node_boxes_[node]);
    for (; i < targets.size() && node_of_[targets[i]] == node; ++i)
      if (!hidden && !view.hides(boxes_[targets[i]])) left.push_back(targets[i]);
  }
  return left;
}

void HiddenTargets::set_seen(const Targets& targets) {
  for (const uint32_t t : targets) state_[node_of_[t]] = State::seen;
}

void HiddenTargets::hide_open(std::span<uint8_t> hidden) const {
  for (size_t i = 0; i < state_.size(); ++i)
    if (state_[i] == State::open) hidden[i] = 1;
}

std::vector<Box> occluding_boxes(const Model& model, const HiderQuestion& question, std::span<const Box> solids,
                                 size_t most) {
  struct Weighed {
    Box box;
    float weight;
  };
  std::vector<Weighed> weighed;
  weighed.reserve(solids.size());
  ErrorMap errors(model, question.front);
  const glm::vec3 middle = question.cell.center();
  for (const Box& solid : solids) {
    const Box box = solid.grown(-errors.around(solid) - kRoundM);
    if (box.empty()) continue;
    const glm::vec3 size = box.size(), way = glm::abs(box.center() - middle) + 1e-3F;
    const float distance = std::max(glm::length(way), 1e-3F);
    const float area = (size.y * size.z * way.x + size.x * size.z * way.y + size.x * size.y * way.z) / distance;
    weighed.push_back({box, area / std::max(box.distance(middle) * box.distance(middle), 1e-2F)});
  }
  std::stable_sort(weighed.begin(), weighed.end(),
                   [](const Weighed& a, const Weighed& b) { return a.weight > b.weight; });
  std::vector<Box> boxes;
  boxes.reserve(std::min(most, weighed.size()));
  for (size_t i = 0; i < weighed.size() && i < most; ++i) boxes.push_back(weighed[i].box);
  return boxes;
}

Box world_of(const Model& model) {
  Box world;
  for (const NodeRecord& node : model.tables.nodes) world.add(node.box);
  return world;
}

}  // namespace promenade
