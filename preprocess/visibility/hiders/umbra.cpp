// What a cell sees of a thing outside it, its boundary sees: the line of sight leaves the cell through a face that the
// thing is beyond. So each face of the cell is decided by itself, as a flat rectangle of eyes.
//
// From the middle of a rectangle, solid boxes that are smaller by its halves (along each axis) and by the error of what
// is drawn hide what the boxes hide from all of it, however many of them work together: a line from another point of
// the rectangle to the same target runs within those halves of the middle's line, so where that one meets the smaller
// box, this one is in the box. Seen past the boxes as they are: seen. Neither: the rectangle is halved.
// Source: [chhugani2003] section 5.2 shrinks occluders likewise (its [WWS00]), about a point that it optimises; halving
// makes that choice needless.

#include "preprocess/visibility/hiders/umbra.h"

#include <algorithm>

#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/error_map.h"

namespace promenade {
namespace {

constexpr double kSmallestPartM = 0.1;  // of a face: smaller ones are not halved
constexpr float kRoundM = 1e-4F;        // boxes shrink by this more: roundings to float

/// One cell's question in work.
class CellWork {
 public:
  CellWork(const Model& model, const HeldParts& parts, const std::vector<Box>& boxes, const UmbraOptions& options,
           const HiderQuestion& question, std::span<uint8_t> hidden)
      : model_(model),
        parts_(parts),
        boxes_(boxes),
        options_(options),
        cell_(question.cell),
        front_(question.front),
        hidden_(hidden),
        views_left_(options.most_views) {}

  void run() {
    gather_targets();
    if (targets_.empty()) return;
    gather_boxes();
    if (usable_.empty()) return;
    for (uint32_t face = 0; face < BoxView::kFaces; ++face) prove_face(face);
    for (size_t i = 0; i < front_.size(); ++i)
      if (state_[i] == State::open) hidden_[i] = 1;
  }

 private:
  enum class State : uint8_t { open, seen };
  using Targets = std::vector<uint32_t>;
  struct Target {
    Box box;
    uint32_t node;  ///< into the front
  };
  struct Usable {
    Box box;  ///< smaller by the error of what is drawn
    float weight;
  };

  void gather_targets();
  void gather_boxes();
  void prove_face(uint32_t face);
  void prove(const Box& part, uint32_t face, Targets targets);
  void fill_view(const glm::dvec3& eye, const Box& part, const Targets& targets, const glm::vec3& shrink);
  /// Nodes first, their parts only where that does not do.
  Targets not_hidden(const Targets& targets) const;
  Targets still_open(const Targets& targets) const {
    Targets open;
    open.reserve(targets.size());
    for (const uint32_t t : targets)
      if (state_[targets_[t].node] == State::open) open.push_back(t);
    return open;
  }
  void keep(const Targets& targets) {
    for (const uint32_t t : targets) state_[targets_[t].node] = State::seen;
  }

  const Model& model_;
  const HeldParts& parts_;
  const std::vector<Box>& boxes_;
  const UmbraOptions& options_;
  const Box cell_;
  std::span<const NodeId> front_;
  std::span<uint8_t> hidden_;
  uint32_t views_left_;
  std::vector<State> state_;
  std::vector<Target> targets_;  ///< by node
  std::vector<Box> node_boxes_;  ///< of a node's targets together
  std::vector<Usable> usable_;
  BoxView view_;
};

/// The parts of each node that must be hidden for it to be. A node with a part in the cell is seen.
void CellWork::gather_targets() {
  state_.assign(front_.size(), State::open);
  node_boxes_.assign(front_.size(), Box());
  for (uint32_t i = 0; i < front_.size(); ++i) {
    if (hidden_[i] != 0) {
      state_[i] = State::seen;  // nothing to prove; what is set already stays
      continue;
    }
    const size_t first = targets_.size();
    for (const NodePart& part : parts_.of(i)) {
      if (faces_away_from_cell(part.cone, part.box, cell_)) continue;
      if (part.box.overlaps(cell_)) {
        state_[i] = State::seen;
        targets_.resize(first);
        break;
      }
      targets_.push_back({part.box, i}), node_boxes_[i].add(part.box);
    }
  }
}

/// Those that cover most of the sphere about the cell's middle.
void CellWork::gather_boxes() {
  ErrorMap errors(model_, front_);
  const glm::vec3 middle = cell_.center();
  usable_.reserve(boxes_.size());
  for (const Box& solid : boxes_) {
    const Box box = solid.grown(-errors.around(solid) - kRoundM);
    if (box.empty()) continue;
    const glm::vec3 size = box.size(), way = glm::abs(box.center() - middle) + 1e-3F;
    const float distance = std::max(glm::length(way), 1e-3F);
    const float area = (size.y * size.z * way.x + size.x * size.z * way.y + size.x * size.y * way.z) / distance;
    usable_.push_back({box, area / std::max(box.distance(middle) * box.distance(middle), 1e-2F)});
  }
  std::stable_sort(usable_.begin(), usable_.end(),
                   [](const Usable& a, const Usable& b) { return a.weight > b.weight; });
  if (usable_.size() > options_.most_boxes) usable_.resize(options_.most_boxes);
}

/// A face and the targets that are beyond its plane.
void CellWork::prove_face(uint32_t face) {
  const int axis = static_cast<int>(face / 2);
  const bool down = face % 2 != 0;
  Box part = cell_;
  part.min[axis] = part.max[axis] = down ? cell_.min[axis] : cell_.max[axis];
  Targets beyond;
  beyond.reserve(targets_.size());
  for (uint32_t t = 0; t < targets_.size(); ++t) {
    const Box& box = targets_[t].box;
    if (down ? box.min[axis] < part.min[axis] : box.max[axis] > part.max[axis]) beyond.push_back(t);
  }
  prove(part, face, std::move(beyond));
}

void CellWork::prove(const Box& part, uint32_t face, Targets targets) {
  targets = still_open(targets);
  if (targets.empty()) return;
  if (views_left_ < 2) return keep(targets);
  const glm::dvec3 middle(part.center());
  fill_view(middle, part, targets, glm::vec3(0));
  keep(not_hidden(targets));
  targets = still_open(targets);
  if (targets.empty()) return;
  const glm::vec3 halves = part.size() * 0.5F;
  fill_view(middle, part, targets, halves + kRoundM);
  targets = not_hidden(targets);
  if (targets.empty()) return;
  const int longest = part.longest_axis();
  if (double(part.size()[longest]) < 2 * kSmallestPartM) return keep(targets);
  Box low = part, high = part;
  low.max[longest] = high.min[longest] = part.center()[longest];
  prove(low, face, targets);
  prove(high, face, targets);
}

void CellWork::fill_view(const glm::dvec3& eye, const Box& part, const Targets& targets, const glm::vec3& shrink) {
  --views_left_;
  view_.reset(eye);
  for (const uint32_t t : targets) view_.want(targets_[t].box);
  for (const Usable& usable : usable_) {
    if (usable.box.overlaps(part)) continue;  // nobody stands in it
    const Box box{usable.box.min + shrink, usable.box.max - shrink};
    if (!box.empty()) view_.add(box);
  }
}

CellWork::Targets CellWork::not_hidden(const Targets& targets) const {
  Targets left;
  for (size_t i = 0; i < targets.size();) {
    const uint32_t node = targets_[targets[i]].node;
    const bool hidden = view_.hides(node_boxes_[node]);
    for (; i < targets.size() && targets_[targets[i]].node == node; ++i)
      if (!hidden && !view_.hides(targets_[targets[i]].box)) left.push_back(targets[i]);
  }
  return left;
}

class UmbraHider : public Hider {
 public:
  UmbraHider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes, const UmbraOptions& options)
      : model_(model), parts_(parts), boxes_(boxes), options_(options) {}

  std::string_view name() const override { return "umbra"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    CellWork(model_, *held, boxes_, options_, question, hidden).run();
    return Done{};
  }

 private:
  const Model& model_;
  const NodeParts& parts_;
  const std::vector<Box>& boxes_;
  UmbraOptions options_;
};

}  // namespace

std::unique_ptr<Hider> make_umbra_hider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes,
                                        const UmbraOptions& options) {
  return std::make_unique<UmbraHider>(model, parts, boxes, options);
}

}  // namespace promenade
