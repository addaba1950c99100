// The shadow of a solid box, seen from a cell, is bounded by planes that touch both. From a point within those planes
// the box stands for what it hides from the cell when planes through the point, along them, shrink it: those bound a
// part of the shadow. One point must do for all boxes of a picture; where it lies decides by how much they shrink.
// Boxes go to clusters by their direction from the cell, each with a point and a picture of its own; what one hides
// need not be asked of the next.
// Source: [chhugani2003] section 5.2.

#include "preprocess/visibility/hiders/shrunk.h"

#include <algorithm>

#include "preprocess/visibility/hiders/solid_occlusion.h"
#include "preprocess/visibility/projection_point.h"

namespace promenade {
namespace {

class CellWork {
 public:
  CellWork(const HiderQuestion& question, const HeldParts& parts, const ShrunkOptions& options, const Box& world,
           std::span<const uint8_t> hidden)
      : cell_(question.cell), world_(world), options_(options), targets_(question, parts, hidden) {}

  void run(std::span<const Box> boxes, std::span<uint8_t> hidden) {
    if (targets_.boxes().empty()) return;
    gather(boxes);
    HiddenTargets::Targets left = targets_.all();
    for (const Cluster& cluster : clusters_) {
      if (cluster.empty() || left.empty()) continue;
      view_.reset(projection_point(cell_, world_, cluster));
      for (const uint32_t t : left) view_.want(targets_.boxes()[t]);
      for (const ShrunkOccluder& occluder : occluders_)
        if (occluder.shadow.may_be_seen_from(view_.eye())) view_.add(occluder.shadow);
      left = targets_.not_hidden_in(view_, left);
    }
    targets_.set_seen(left);
    targets_.hide_open(hidden);
  }

 private:
  using Cluster = std::vector<const ShrunkOccluder*>;

  void gather(std::span<const Box> boxes);

  const Box cell_, world_;
  const ShrunkOptions& options_;
  HiddenTargets targets_;
  std::vector<ShrunkOccluder> occluders_;
  std::vector<Cluster> clusters_;
  BoxView view_;
};

void CellWork::gather(std::span<const Box> boxes) {
  occluders_ = shrunk_occluders(cell_, boxes);
  const uint32_t side = options_.clusters_a_side;
  clusters_.resize(size_t(BoxView::kFaces) * side * side);
  const auto square = [&](double at) {
    return static_cast<uint32_t>(std::clamp((at + 1) / 2 * side, 0.0, double(side - 1)));
  };
  for (const ShrunkOccluder& occluder : occluders_) {
    const uint32_t row = occluder.face * side + square(occluder.u);
    clusters_[row * side + square(occluder.v)].push_back(&occluder);
  }
}

class ShrunkHider : public Hider {
 public:
  ShrunkHider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes, const ShrunkOptions& options)
      : model_(model), parts_(parts), boxes_(boxes), options_(options), world_(world_of(model)) {}

  std::string_view name() const override { return "shrunk"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    const std::vector<Box> boxes = occluding_boxes(model_, question, boxes_, options_.most_boxes);
    CellWork(question, *held, options_, world_, hidden).run(boxes, hidden);
    return Done{};
  }

 private:
  const Model& model_;
  const NodeParts& parts_;
  const std::vector<Box>& boxes_;
  ShrunkOptions options_;
  Box world_;
};

}  // namespace

std::unique_ptr<Hider> make_shrunk_hider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes,
                                         const ShrunkOptions& options) {
  return std::make_unique<ShrunkHider>(model, parts, boxes, options);
}

}  // namespace promenade
