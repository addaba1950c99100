// What a cell sees of a thing outside it, its boundary sees: the line of sight leaves the cell through a face that the
// thing is beyond. So each face of the cell is decided by itself, as a flat rectangle of eyes.
//
// A picture of the boxes' shadows from the whole rectangle, seen from the best point for it, shows what they hide from
// all of it, however many of them work together. Seen past the boxes themselves from the rectangle's middle: seen.
// Neither: the rectangle is halved; first all rectangles of a size, then smaller ones, so that a limit of pictures
// spends them where they prove most.
// Source: [chhugani2003] section 5.2 and its [WWS00], which shrinks by the part's radius: the best point's shadows hide
// more, measured.

#include "preprocess/visibility/hiders/umbra.h"

#include <deque>
#include <utility>

#include "preprocess/visibility/hiders/solid_occlusion.h"
#include "preprocess/visibility/projection_point.h"

namespace promenade {
namespace {

constexpr double kSmallestPartM = 0.1;  // of a face: smaller ones are not halved

/// One cell's question in work.
class CellWork {
 public:
  CellWork(const HiderQuestion& question, const HeldParts& parts, const UmbraOptions& options,
           const std::vector<Box>& boxes, const Box& world, std::span<const uint8_t> hidden)
      : cell_(question.cell),
        world_(world),
        boxes_(boxes),
        targets_(question, parts, hidden),
        views_left_(options.most_views) {}

  void run(std::span<uint8_t> hidden) {
    if (targets_.boxes().empty() || boxes_.empty()) return;
    for (uint32_t face = 0; face < BoxView::kFaces; ++face) add_face(face);
    for (; !undecided_.empty(); undecided_.pop_front()) decide(undecided_.front());
    targets_.hide_open(hidden);
  }

 private:
  using Targets = HiddenTargets::Targets;
  /// Of a face, with what must be hidden from it.
  struct Part {
    Box eyes;
    Targets targets;
  };

  void add_face(uint32_t face);
  void decide(Part& part);
  void draw_boxes(const Part& part);
  void draw_shadows(const Part& part);
  void begin_view(const glm::dvec3& eye, const Targets& targets);

  const Box cell_, world_;
  const std::vector<Box>& boxes_;  ///< smaller by the error of what is drawn
  HiddenTargets targets_;
  uint32_t views_left_;
  std::deque<Part> undecided_;
  BoxView view_;
};

/// A face and the targets that are beyond its plane.
void CellWork::add_face(uint32_t face) {
  const int axis = static_cast<int>(face / 2);
  const bool down = face % 2 != 0;
  Part part{cell_, {}};
  part.eyes.min[axis] = part.eyes.max[axis] = down ? cell_.min[axis] : cell_.max[axis];
  for (uint32_t t = 0; t < targets_.boxes().size(); ++t) {
    const Box& box = targets_.boxes()[t];
    if (down ? box.min[axis] < cell_.min[axis] : box.max[axis] > cell_.max[axis]) part.targets.push_back(t);
  }
  undecided_.push_back(std::move(part));
}

/// Takes the part's targets; what is left undecided goes to its halves.
void CellWork::decide(Part& part) {
  part.targets = targets_.still_open(part.targets);
  if (part.targets.empty()) return;
  if (views_left_ < 2) return targets_.set_seen(part.targets);
  draw_boxes(part);
  targets_.set_seen(targets_.not_hidden_in(view_, part.targets));
  part.targets = targets_.still_open(part.targets);
  if (part.targets.empty()) return;
  draw_shadows(part);
  part.targets = targets_.not_hidden_in(view_, part.targets);
  if (part.targets.empty()) return;
  const int longest = part.eyes.longest_axis();
  if (double(part.eyes.size()[longest]) < 2 * kSmallestPartM) return targets_.set_seen(part.targets);
  Box low = part.eyes, high = part.eyes;
  low.max[longest] = high.min[longest] = part.eyes.center()[longest];
  Targets targets = std::move(part.targets);
  undecided_.push_back({low, targets});
  undecided_.push_back({high, std::move(targets)});
}

void CellWork::begin_view(const glm::dvec3& eye, const Targets& targets) {
  --views_left_;
  view_.reset(eye);
  for (const uint32_t t : targets) view_.want(targets_.boxes()[t]);
}

void CellWork::draw_boxes(const Part& part) {
  begin_view(glm::dvec3(part.eyes.center()), part.targets);
  for (const Box& box : boxes_)
    if (!box.overlaps(part.eyes)) view_.add(box);  // nobody stands in one
}

void CellWork::draw_shadows(const Part& part) {
  const std::vector<ShrunkOccluder> occluders = shrunk_occluders(part.eyes, boxes_);
  std::vector<const ShrunkOccluder*> all;
  all.reserve(occluders.size());
  for (const ShrunkOccluder& occluder : occluders) all.push_back(&occluder);
  begin_view(projection_point(part.eyes, world_, all), part.targets);
  for (const ShrunkOccluder& occluder : occluders) view_.add(occluder.shadow);
}

class UmbraHider : public Hider {
 public:
  UmbraHider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes, const UmbraOptions& options)
      : model_(model), parts_(parts), boxes_(boxes), options_(options), world_(world_of(model)) {}

  std::string_view name() const override { return "umbra"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    const std::vector<Box> boxes = occluding_boxes(model_, question, boxes_, options_.most_boxes);
    CellWork(question, *held, options_, boxes, world_, hidden).run(hidden);
    return Done{};
  }

 private:
  const Model& model_;
  const NodeParts& parts_;
  const std::vector<Box>& boxes_;
  UmbraOptions options_;
  Box world_;
};

}  // namespace

std::unique_ptr<Hider> make_umbra_hider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes,
                                        const UmbraOptions& options) {
  return std::make_unique<UmbraHider>(model, parts, boxes, options);
}

}  // namespace promenade
