#include "runtime/fades.h"

#include <algorithm>
#include <set>

namespace promenade {

Fades::Fades(const Model& model) : model_(model), place_(model.tables.nodes.size()) {}

bool Fades::was_in_front(NodeId id) const {
  const Place& place = place_[index_of(id)];
  const uint32_t last = place.now == frame_ ? place.before : place.now;
  return last != 0 && last + 1 == frame_;
}

/// The node itself or the ancestor of it that a fade runs from or to; kNoNode: none.
NodeId Fades::fading_top_of(NodeId id) const {
  for (NodeId at = id; at != kNoNode; at = parent_of(at))
    if (fades_.contains(at)) return at;
  return kNoNode;
}

/// Where this front and the last one differ in level: fades that begin, or turn around.
void Fades::begin_new(std::span<const NodeId> front) {
  for (const NodeId id : front) {  // finer than before: an ancestor was drawn
    if (was_in_front(id)) continue;
    NodeId above = parent_of(id);
    while (above != kNoNode && !was_in_front(above)) above = parent_of(above);
    if (above == kNoNode) continue;
    const NodeId running = fading_top_of(above);
    if (running == kNoNode)
      fades_.emplace(above, Fade{1, false, {}, false});
    else if (running == above)
      fades_[above].to_top = false;  // back to what is below
  }
  std::map<NodeId, std::vector<NodeId>> gone;  // coarser than before: what was drawn, by the ancestor that is
  for (const NodeId id : last_front_) {
    if (in_front(id)) continue;
    NodeId above = parent_of(id);
    while (above != kNoNode && !in_front(above)) above = parent_of(above);
    if (above != kNoNode) gone[above].push_back(id);
  }
  for (auto& [top, below] : gone) {
    const NodeId running = fading_top_of(top);
    if (running != kNoNode && running != top) continue;  // within a larger fade: drawn as its part
    const auto found = fades_.find(top);
    const float share = found == fades_.end() ? 0 : found->second.top_share;
    fades_[top] = Fade{share, true, std::move(below), false};
  }
  // A fade above others takes them over.
  for (auto it = fades_.begin(); it != fades_.end();) {
    const NodeId above = parent_of(it->first);
    it = above != kNoNode && fading_top_of(above) != kNoNode ? fades_.erase(it) : std::next(it);
  }
}

/// Whether `below` has a node on every path under `top` that leads to something in view.
bool Fades::covers(NodeId top, const std::vector<NodeId>& below, const Frustum& frustum, const VlodMarks* vlod) const {
  bool all_seen = vlod == nullptr;
  for (NodeId at = top; at != kNoNode && !all_seen; at = parent_of(at)) all_seen = vlod->has(at);
  std::set<NodeId> leads;  // ancestors of what is below
  const std::set<NodeId> there(below.begin(), below.end());
  for (const NodeId id : below)
    for (NodeId at = parent_of(id); at != top && at != kNoNode && leads.insert(at).second;) at = parent_of(at);
  struct Visit {
    NodeId node;
    bool seen_whole;
  };
  std::vector<Visit> stack = {{top, all_seen}};
  while (!stack.empty()) {
    const Visit at = stack.back();
    stack.pop_back();
    for (const NodeId child : model_.children_of(at.node)) {
      if (there.contains(child)) continue;
      const bool hidden = !at.seen_whole && !vlod->leads_to_some(child);
      if (hidden || classify(frustum, model_.tables.nodes[index_of(child)].box) == Overlap::outside) continue;
      if (!leads.contains(child)) return false;
      stack.push_back({child, at.seen_whole || vlod->has(child)});
    }
  }
  return true;
}

/// One frame on; what has ended, or cannot go on, is forgotten.
void Fades::step(std::span<const uint8_t> resident, const Frustum& frustum, const VlodMarks* vlod, uint32_t frames) {
  for (auto it = fades_.begin(); it != fades_.end();) {
    auto& [top, fade] = *it;
    const float change = 1 / float(frames + 1);
    fade.top_share += fade.to_top ? change : -change;
    const auto is_there = [resident](NodeId id) { return resident[index_of(id)] != 0; };
    constexpr float kRounding = 1e-4F;
    bool goes_on = fade.in_view && fade.top_share > kRounding && fade.top_share < 1 - kRounding;
    if (goes_on && fade.to_top)
      goes_on = std::all_of(fade.below.begin(), fade.below.end(), is_there) && covers(top, fade.below, frustum, vlod);
    else if (goes_on)
      goes_on = is_there(top);
    fade.in_view = false;
    it = goes_on ? std::next(it) : fades_.erase(it);
  }
}

void Fades::follow(std::span<const NodeId> front, std::span<const uint8_t> resident, const Frustum& frustum,
                   const VlodMarks* vlod, uint32_t frames, std::vector<FadedNode>& items) {
  items.clear();
  ++frame_;
  for (const NodeId id : front) {
    Place& place = place_[index_of(id)];
    place.before = place.now;
    place.now = frame_;
  }
  if (frames == 0) {
    fades_.clear();
  } else {
    begin_new(front);
    for (const NodeId id : front)
      if (const NodeId top = fading_top_of(id); top != kNoNode) fades_[top].in_view = true;
    step(resident, frustum, vlod, frames);
  }
  for (const NodeId id : front) {
    const NodeId top = fades_.empty() ? kNoNode : fading_top_of(id);
    if (top == kNoNode)
      items.push_back({id, 0, 1, false});
    else if (top == id)
      items.push_back({id, 0, fades_[top].top_share, false});
    else
      items.push_back({id, fades_[top].top_share, 1, false});
  }
  for (const auto& [top, fade] : fades_) {
    if (!fade.to_top) items.push_back({top, 0, fade.top_share, true});
    for (const NodeId id : fade.below)
      if (fade.to_top) items.push_back({id, fade.top_share, 1, true});
  }
  last_front_.assign(front.begin(), front.end());
}

}  // namespace promenade
