#pragma once
// What drawing a node is worth to the eye.

#include "runtime/sight.h"

namespace promenade {

/// [funkhouser1993] section 4.2.3: size x accuracy x importance x focus x motion x hysteresis, for one view. What is
/// passed must outlive it. Pure; any thread.
class Benefit {
 public:
  Benefit(const Model& model, const Sight& sight, const SelectView& view, const SelectOptions& options);
  /// drawn_before: in the last frame, at this level.
  double of(NodeId node, bool drawn_before) const;

  /// The factors, in [0, 1].
  double accuracy(NodeId node) const;
  double importance(NodeId node) const;
  double focus(NodeId node) const;
  double motion(NodeId node) const;
  /// Pixels that the node's surface covers, seen from all sides on average; no more than the picture has. Children
  /// share their parent's surface, so that a finer level is not worth more for its boxes' sake.
  double size_px(NodeId node) const;

 private:
  const NodeRecord& node(NodeId id) const { return model_.tables.nodes[index_of(id)]; }

  const Model& model_;
  const Sight& sight_;
  const SelectView& view_;
  const SelectOptions& options_;
  glm::dvec3 forward_;
  double picture_px_, corner_cos_;
};

}  // namespace promenade
