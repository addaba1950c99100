#pragma once
// What hiders by solid boxes begin a cell with: what is to be proven hidden, and which boxes may hide it.

#include <cstdint>
#include <span>
#include <vector>

#include "layout/model_io.h"
#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

/// The parts of a cell's nodes, node after node: a node is hidden when all of them are.
class HiddenTargets {
 public:
  using Targets = std::vector<uint32_t>;  // into boxes(), rising

  /// `hidden`: as the hider was given it. A node with a part in the cell is seen; one that is hidden stays so.
  HiddenTargets(const HiderQuestion& question, const HeldParts& parts, std::span<const uint8_t> hidden);

  std::span<const Box> boxes() const { return boxes_; }
  Targets all() const;
  /// Those of nodes that are not seen yet.
  Targets still_open(const Targets& targets) const;
  /// Those that a picture does not hide. Asks nodes first, their parts only where that does not do.
  Targets not_hidden_in(const BoxView& view, const Targets& targets) const;
  void set_seen(const Targets& targets);
  /// Hides the nodes that were not set seen.
  void hide_open(std::span<uint8_t> hidden) const;

 private:
  enum class State : uint8_t { open, seen };
  std::vector<State> state_;       ///< by node
  std::vector<Box> boxes_;         ///< by target
  std::vector<uint32_t> node_of_;  ///< by target: into the front
  std::vector<Box> node_boxes_;    ///< of a node's targets together
};

/// Of the boxes, smaller by the error of what is drawn, those that cover most of the sphere about the cell's middle;
/// the one that covers most first.
std::vector<Box> occluding_boxes(const Model& model, const HiderQuestion& question, std::span<const Box> solids,
                                 size_t most);

/// Holds all nodes.
Box world_of(const Model& model);

}  // namespace promenade
