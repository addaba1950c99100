// Source: [chhugani2003] section 5.3: hierarchies of normal cones, asked for a cell instead of a point.

#include "preprocess/visibility/hiders/backface.h"

#include <algorithm>

namespace promenade {
namespace {

class BackfaceHider : public Hider {
 public:
  BackfaceHider(const Model& model, const NodeParts& parts) : model_(model), parts_(parts) {}

  std::string_view name() const override { return "backface"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    for (size_t i = 0; i < question.front.size(); ++i) {
      if (hidden[i] != 0) continue;
      const NodeRecord& node = model_.tables.nodes[index_of(question.front[i])];
      const auto away = [&](const auto& of) { return faces_away_from_cell(of.cone, of.box, question.cell); };
      const std::span<const NodePart> parts = held->of(i);
      if (away(node) || std::all_of(parts.begin(), parts.end(), away)) hidden[i] = 1;
    }
    return Done{};
  }

 private:
  const Model& model_;
  const NodeParts& parts_;
};

}  // namespace

std::unique_ptr<Hider> make_backface_hider(const Model& model, const NodeParts& parts) {
  return std::make_unique<BackfaceHider>(model, parts);
}

}  // namespace promenade
