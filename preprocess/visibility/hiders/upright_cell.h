#pragma once
// What hiders by upright solids begin a cell with, whatever they do with the solids then.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/occluders.h"
#include "preprocess/visibility/open_parts.h"

namespace promenade {

/// A cell's question in work, or that of an open part of it: what is to be proven hidden, and which solids may hide it.
class UprightCell {
 public:
  UprightCell(const HeldParts& parts, const OccluderSet& set, const HiderQuestion& question, std::span<uint8_t> hidden)
      : parts_(parts), set_(set), cell_(question.cell), front_(question.front), hidden_(hidden) {}

 protected:
  enum class State : uint8_t { open, seen };
  using Targets = std::vector<uint32_t>;  // into targets_, rising
  /// Boxes that must be hidden one by one; several belong to a node.
  struct Target {
    Box box;
    uint32_t node;  ///< into the front
  };

  /// The parts of each node that must be hidden for it to be. A node with a part above, below or around the cell is
  /// seen. Leaves alone what is hidden already.
  void gather_targets();
  /// Those that go down as far as rays may run. After gather_targets().
  void gather_occluders(const std::vector<UsableOccluder>& occluders);
  /// A ray may be under an occluder that goes all the way down when it slipped under the ground before. Asked of those
  /// alone that would hide something: most of a city's never would.
  bool is_slipped_under(size_t usable);
  Targets all_targets() const;
  Targets still_open(const Targets& targets) const;
  void keep(const Targets& targets) {
    for (const uint32_t t : targets) state_[targets_[t].node] = State::seen;
  }
  void hide_open() {
    for (size_t i = 0; i < front_.size(); ++i)
      if (state_[i] == State::open) hidden_[i] = 1;
  }

  const HeldParts& parts_;
  const OccluderSet& set_;
  const Box cell_;
  std::span<const NodeId> front_;
  std::span<uint8_t> hidden_;
  std::vector<State> state_;            ///< by node of the front
  std::vector<Target> targets_;         ///< by node
  std::vector<Box> boxes_;              ///< of a node's targets together
  std::vector<UsableOccluder> usable_;  ///< nearest first

 private:
  using Ground = OccluderSet::Ground;
  enum class Fate : uint8_t { unseen, open, seen };
  enum class Slipped : uint8_t { unknown, no, yes };
  Fate fate_of(const NodePart& part, bool may_slip);

  float eyes_from_m_ = 0;         ///< no eye is lower
  float lowest_m_ = 0;            ///< no ray that matters goes below
  std::vector<Slipped> slipped_;  ///< by usable one: whether rays may run beneath it
};

/// All occluders, as a cell may use them.
std::vector<UsableOccluder> usable_occluders(const Model& model, const OccluderSet& set, const HiderQuestion& question);

/// A hider that works a cell as an UprightCell: CellWork(parts, occluders, question, hidden).run(usable occluders). A
/// cell that reaches into houses is asked as its open parts: what none of them sees is hidden.
template <class CellWork>
class UprightHider : public Hider {
 public:
  UprightHider(std::string_view name, const Model& model, const NodeParts& parts, const OccluderSet& occluders)
      : name_(name), model_(model), parts_(parts), occluders_(occluders) {}

  std::string_view name() const override { return name_; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    const std::vector<UsableOccluder> usable = usable_occluders(model_, occluders_, question);
    std::vector<uint8_t> settled(hidden.begin(), hidden.end()), seen(hidden.size(), 0);
    for (const Box& part : open_parts(question.cell, occluders_, usable)) {
      std::vector<uint8_t> hidden_there = settled;
      CellWork(*held, occluders_, {part, question.front}, hidden_there).run(usable);
      for (size_t i = 0; i < hidden.size(); ++i)
        if (hidden_there[i] == 0) settled[i] = seen[i] = 1;
    }
    for (size_t i = 0; i < hidden.size(); ++i)
      if (seen[i] == 0) hidden[i] = 1;
    return Done{};
  }

 private:
  std::string_view name_;
  const Model& model_;
  const NodeParts& parts_;
  const OccluderSet& occluders_;
};

}  // namespace promenade
