#include "preprocess/simplify.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "preprocess/collapse.h"
#include "preprocess/cost_queue.h"
#include "preprocess/parts.h"
#include "preprocess/patches.h"
#include "preprocess/relief_press.h"
#include "preprocess/work_mesh.h"

namespace promenade {

namespace {

/// Borders stay as they are while they have at most this share of the target's edges: a patch has twice as many
/// triangles as places.
constexpr double kMostLockedShare = 0.25;

/// Measured costs may exceed the cheapest in the queue by this factor before something else is tried first. Measured on
/// a city: at 1.2 fronts are 2 % larger, at 1.5 10 %; at 1.05 a build takes a twentieth longer.
constexpr float kPatience = 1.1F;

/// A place that costs more only because triangles would flip is looked at anew after a change beside it, if it might
/// cost less than this share. Measured on a city: to look at all takes a fortieth of simplification, for the same
/// fronts.
constexpr float kWorthFall = 0.5F;

/// Colours that differ by less pass for the same paint, in parts of black and white.
constexpr float kPaintContrast = 0.065F;
/// What a metre of a painted part's width is worth: it vanishes at about three pixels. Measured on a city: at 1 the
/// front is 6 % larger and hardly a pixel's colour is nearer; at 0.25 crosswalks vanish from the air.
constexpr float kPaintWeight = 0.35F;

/// How far paint lies above what it is painted on in the end, in shares of the largest cost, rounded to a power of two:
/// about as wide as the grid will be.
constexpr float kSheetHeight = 1.15F / 8;
/// How far above paint the surface may have come to lie that is to be beneath it, in shares of the largest cost.
constexpr float kSheetReach = 1.5F;

/// Of the surface's diagonal: deeper reliefs are not pressed flat.
constexpr float kDeepestRelief = 1.0F / 64;

/// Between points along creases, in shares of the side of a square as large as a triangle of the result. Measured: see
/// bench_simplify.
constexpr double kSpacing = 0.15;
constexpr int kMostRounds = 8;  // until the target holds with what comes besides

float point_spacing_m(const WorkMesh& work, uint32_t target) {
  double area_m2 = 0;
  for (uint32_t c = 0; c < work.place.size(); c += 3)
    area_m2 += 0.5 * double(glm::length(glm::cross(work.at(c + 1) - work.at(c), work.at(c + 2) - work.at(c))));
  const auto spacing_m = static_cast<float>(kSpacing * std::sqrt(area_m2 / target));
  return std::max(spacing_m, std::numeric_limits<float>::min());
}

/// Collapses, removals of parts, liftings of patches and pressings of reliefs in one queue, cheapest first: items are
/// numbered in this order.
class Simplifier {
 public:
  Simplifier(WorkMesh& work, const Mesh& source, const SimplifyOptions& options, const Border& border)
      : work_(work),
        source_(source),
        borders_(work, border),
        patches_(add_patches(work, source)),
        parts_(work),
        wanted_(std::max(options.target_triangles, 1U)),
        target_(wanted_),
        collapser_(work, source, borders_, point_spacing_m(work, target_)),
        press_(work, collapser_, borders_, find_reliefs(work, kDeepestRelief * bounds(source).diagonal()), patches_),
        queue_(static_cast<uint32_t>(work.place_count() + parts_.count() + patches_.size() + press_.count())),
        alive_in_part_(parts_.count()),
        paint_m_(parts_.count(), -1.0F),
        may_fall_to_m_(work.place_count(), kNowhere) {
    for (uint32_t part = 0; part < parts_.count(); ++part)
      if (work.alive[parts_.triangles(part).front()] != 0)
        alive_in_part_[part] = static_cast<uint32_t>(parts_.triangles(part).size());
    if (double(borders_.edge_count()) <= kMostLockedShare * target_) collapser_.set_border_rule(Rule::stay);
  }

  /// besides: as in SimplifyOptions.
  SimplifyFigures run(const std::function<size_t(const Mesh&, const Border&)>& besides) {
    queue_parts();
    for (uint32_t i = 0; i < patches_.size(); ++i) queue_.set(places() + parts_.count() + i, 0);
    for (uint32_t i = 0; i < press_.count(); ++i) queue_.set(first_relief() + i, press_.first_cost(i));
    queue_places();
    reduce();
    for (int round = 0; besides && round < kMostRounds; ++round) {
      const size_t more = besides(finish(work_, source_), border());
      if (work_.alive_count + more <= wanted_ || target_ == 1) break;
      // What comes besides rarely grows as the border loses edges.
      target_ = more + 1 < wanted_ ? std::min(target_ - 1, wanted_ - static_cast<uint32_t>(more)) : target_ / 2;
      reduce();
    }
    return {raise(), reached_m_};
  }
  Border border() const { return borders_.border(work_); }

 private:
  using Rule = Collapser::BorderRule;
  static constexpr float kNowhere = std::numeric_limits<float>::infinity();

  void reduce() {
    for (drain(); work_.alive_count > target_; drain())
      if (!loosen()) return kill_smallest();
  }

  /// Allows more, once nothing is left to do; false when everything is allowed.
  bool loosen() {
    if (rules_loosened_ == 2) return false;
    collapser_.set_border_rule(++rules_loosened_ == 1 ? Rule::along : Rule::free);
    if (rules_loosened_ == 2) collapser_.allow_flips(true);
    queue_places();
    return true;
  }

  uint32_t first_relief() const { return places() + parts_.count() + static_cast<uint32_t>(patches_.size()); }
  uint32_t places() const { return static_cast<uint32_t>(work_.place_count()); }

  void queue_parts() {
    if (parts_.count() < 2) return;
    for (uint32_t part = 0; part < parts_.count(); ++part)
      if (work_.alive[parts_.triangles(part).front()] != 0) queue_.set(places() + part, 0);
  }

  void queue_places() {
    std::fill(may_fall_to_m_.begin(), may_fall_to_m_.end(), kNowhere);  // what was certain under other rules
    for (uint32_t p = 0; p < places(); ++p) queue_.set(p, collapser_.estimate(p));
  }

  void drain() {
    while (work_.alive_count > target_ && !queue_.empty()) {
      const uint32_t item = queue_.top();
      if (item >= first_relief())
        try_relief(item - first_relief());
      else if (item >= places() + parts_.count())
        try_patch(item - places() - parts_.count());
      else if (item >= places())
        try_part(item - places());
      else
        try_place(item);
    }
  }

  float raise() {
    if (!(reached_m_ > 0)) return 0;
    std::vector<uint8_t> may_rise(work_.triangle_count(), 0);
    for (const Patch& patch : patches_)
      std::fill_n(may_rise.begin() + patch.first_copy, patch.triangles.size(), uint8_t(1));
    for (uint32_t part = 0; part < parts_.count(); ++part)
      if (alive_in_part_[part] > 0 && alive_in_part_[part] <= kMostSheetTriangles) mark_if_on_top(part, may_rise);
    const float height_m = std::exp2(std::floor(std::log2(kSheetHeight * reached_m_)));
    return raise_sheets(work_, source_, may_rise, height_m, kSheetReach * reached_m_) ? height_m : 0;
  }

  /// What was beneath another surface from the beginning stays there.
  void mark_if_on_top(uint32_t part, std::vector<uint8_t>& may_rise) {
    const std::vector<uint32_t>& triangles = parts_.triangles(part);
    const auto alive =
        std::find_if(triangles.begin(), triangles.end(), [&](uint32_t t) { return work_.alive[t] != 0; });
    if (alive == triangles.end() || may_rise[*alive] != 0) return;
    const glm::vec3 a = work_.at(*alive * 3), b = work_.at(*alive * 3 + 1), c = work_.at(*alive * 3 + 2);
    const std::optional<float> height_m = parts_.height_besides(part, (a + b + c) / 3.0F, glm::cross(b - a, c - a));
    if (!height_m || *height_m < 0) return;
    for (const uint32_t t : triangles) may_rise[t] = 1;
  }

  void try_place(uint32_t place) {
    const float queued = queue_.top_cost();
    queue_.remove(place);
    const float limit = patience(queued);
    const Collapser::Choice choice = collapser_.choose(place, limit);
    if (choice.target == WorkMesh::kNone) return;
    may_fall_to_m_[place] = choice.firm_m < kWorthFall * choice.cost_m ? choice.firm_m : kNowhere;
    if (choice.cost_m > limit) return queue_.set(place, choice.cost_m);
    // The last triangles of a part go by its removal, which knows how far that is.
    uint32_t& alive = alive_in_part_[parts_.of_place(place)];
    const uint32_t before = work_.alive_count;
    if (collapser_.triangles_between(place, choice.target) >= alive) return;
    collapser_.chosen_ring(ring_);
    collapser_.collapse(place, choice.target);
    reached_m_ = std::max(reached_m_, choice.cost_m);
    alive -= before - work_.alive_count;
    for (const uint32_t p : ring_) change_beside(p);  // the target among them; nothing else has other triangles now
  }

  /// What waits is looked at anew when its turn comes, for it hardly costs less after a change beside it than before;
  /// but what could not go, or only where nothing flips, may do so now.
  void change_beside(uint32_t place) {
    if (!queue_.has(place)) return queue_again(place);
    float& may_fall_to_m = may_fall_to_m_[place];
    if (may_fall_to_m == kNowhere) return;
    queue_.set(place, std::max(collapser_.estimate(place), may_fall_to_m));
    may_fall_to_m = kNowhere;
  }

  void queue_again(uint32_t place) {
    queue_.set(place, collapser_.estimate(place));
    may_fall_to_m_[place] = kNowhere;
  }

  /// A patch is lifted as soon as the wall around it would close at no more than what is in the queue.
  void try_patch(uint32_t index) {
    const uint32_t item = places() + parts_.count() + index;
    const float queued = queue_.top_cost();
    queue_.remove(item);
    const Patch& patch = patches_[index];
    costs_.clear();
    for (const uint32_t p : patch.outline)
      if (const float cost = collapser_.estimate_colorless(work_.current(p)); std::isfinite(cost))
        costs_.push_back(cost);
    if (costs_.empty()) return;
    const auto middle = costs_.begin() + std::ptrdiff_t(costs_.size() / 2);
    std::nth_element(costs_.begin(), middle, costs_.end());
    if (*middle > patience(queued)) return queue_.set(item, *middle);
    lift(patch, work_);
    const uint32_t part = parts_.of_place(work_.place[size_t(patch.first_copy) * 3]);
    alive_in_part_[part] = static_cast<uint32_t>(patch.triangles.size());
    queue_.set(places() + part, 0);
    for (uint32_t t = 0; t < patch.triangles.size(); ++t)
      for (uint32_t c = 0; c < 3; ++c)
        for (const uint32_t of : {work_.place[(patch.first_copy + t) * 3 + c], work_.place[patch.triangles[t] * 3 + c]})
          queue_again(work_.current(of));
  }

  void try_relief(uint32_t index) {
    const float queued = queue_.top_cost();
    queue_.remove(first_relief() + index);
    const float limit = patience(queued);
    const uint32_t before = work_.alive_count;
    const float cost = press_.press(index, limit);
    if (cost > limit) return queue_.set(first_relief() + index, cost);
    reached_m_ = std::max(reached_m_, cost);
    alive_in_part_[parts_.of_place(press_.changed().front())] -= before - work_.alive_count;
    for (const uint32_t place : press_.changed()) queue_again(place);
  }

  /// What costs no more than this may as well be done now: the rest of the queue costs about as much.
  float patience(float queued) const { return std::max(queued, queue_.empty() ? 0 : queue_.top_cost()) * kPatience; }

  void try_part(uint32_t part) {
    const float queued = queue_.top_cost();
    queue_.remove(places() + part);
    const float limit = patience(queued);
    if (!parts_.looked_at(part))  // most are far too dear, as any of their points shows, and never looked at again
      if (const float cost = parts_.first_look(part, limit); cost > limit) return queue_.set(places() + part, cost);
    gather_points(part, limit);
    float& paint = paint_m_[part];  // asked once: its surroundings change little before it goes
    if (paint < 0) paint = paint_cost(part);
    if (paint > limit) return queue_.set(places() + part, paint);
    const float cost = parts_.removal_cost(part, points_, limit, beside_);
    if (cost > limit) return queue_.set(places() + part, std::max(cost, paint));
    const float now = std::max(cost, distance_now());
    if (now > limit) return queue_.set(places() + part, now);
    reached_m_ = std::max(reached_m_, now);
    parts_.remove(part);
    alive_in_part_[part] = 0;
    for (const uint32_t t : parts_.triangles(part)) {
      if (work_.alive[t] == 0) continue;
      for (uint32_t c = 0; c < 3; ++c) queue_.remove(work_.place[t * 3 + c]);
      work_.kill(t);
    }
    for (size_t i = 0; i < points_.size(); ++i)
      if (triangles_[i] != WorkMesh::kNone) collapser_.add_point(points_[i], triangles_[i]);
  }

  /// The points that a part stands for, and some on the inside of what is longer than `spacing_m`: a post touches floor
  /// and ceiling with all its corners.
  void gather_points(uint32_t part, float spacing_m) {
    points_.clear();
    for (const uint32_t t : parts_.triangles(part)) {
      if (work_.alive[t] == 0) continue;
      collapser_.points_on(t, points_);
      const glm::vec3 middle = (work_.at(t * 3) + work_.at(t * 3 + 1) + work_.at(t * 3 + 2)) / 3.0F;
      bool large = false;
      for (uint32_t i = 0; i < 3; ++i) {
        const glm::vec3 a = work_.at(t * 3 + i), b = work_.at(t * 3 + (i + 1) % 3);
        if (glm::dot(b - a, b - a) <= spacing_m * spacing_m) continue;
        large = true;
        if (work_.place[t * 3 + i] < work_.place[t * 3 + (i + 1) % 3]) points_.push_back((a + b) * 0.5F);
      }
      if (large) points_.push_back(middle);
    }
  }

  /// Largest distance of points_ to what has become of the surface beside_ them: a ledge removed after the wall behind
  /// it has gone back to its windows. Finds triangles_, the nearest ones there.
  float distance_now() {
    places_.clear();
    for (const Parts::Beside& found : beside_) places_.push_back(work_.current(work_.place[found.corner]));
    return collapser_.nearest_around(points_, places_, triangles_);
  }

  /// What a part is worth as paint: a zebra crossing lies on its street at no distance, but its loss shows while its
  /// width does. 0 where what remains beside it has its colour.
  float paint_cost(uint32_t part) {
    if (source_.colors.empty()) return 0;
    uint32_t shown = WorkMesh::kNone;
    glm::vec3 front_m2(0), back_m2(0);  // what is seen of it along each axis, from either end
    Box box;
    for (const uint32_t t : parts_.triangles(part)) {
      if (work_.alive[t] == 0) continue;
      if (shown == WorkMesh::kNone) shown = t * 3;
      const glm::vec3 a = work_.at(t * 3), b = work_.at(t * 3 + 1), c = work_.at(t * 3 + 2);
      const glm::vec3 half_cross = 0.5F * glm::cross(b - a, c - a);
      front_m2 += glm::max(half_cross, glm::vec3(0)), back_m2 += glm::max(-half_cross, glm::vec3(0));
      box.add(a), box.add(b), box.add(c);
    }
    if (shown == WorkMesh::kNone || box.diagonal() <= 0) return 0;
    const glm::vec3 seen_m2 = glm::max(front_m2, back_m2);
    const float width = std::max({seen_m2.x, seen_m2.y, seen_m2.z}) / box.diagonal();
    constexpr size_t kSamples = 8;  // enough to tell paint from a piece of the same wall
    const size_t stride = points_.size() / kSamples + 1;
    float contrast = 0;
    uint32_t near = kNoTriangle;
    for (size_t i = 0; i < points_.size() && contrast < kPaintContrast; i += stride) {
      const uint32_t corner = parts_.nearest_corner_besides(part, points_[i], near);
      if (corner == WorkMesh::kNone) return 0;
      contrast = std::max(
          contrast, color_contrast(source_.colors[work_.attributes[shown]], source_.colors[work_.attributes[corner]]));
    }
    return contrast >= kPaintContrast ? width * kPaintWeight : 0;
  }

  /// What no collapse and no removal can take: single triangles and sheets back to back.
  void kill_smallest() {
    std::vector<std::pair<float, uint32_t>> by_area;
    for (uint32_t t = 0; t < work_.triangle_count(); ++t)
      if (work_.alive[t] != 0)
        by_area.emplace_back(
            glm::length(glm::cross(work_.at(t * 3 + 1) - work_.at(t * 3), work_.at(t * 3 + 2) - work_.at(t * 3))), t);
    std::sort(by_area.begin(), by_area.end());
    for (size_t i = 0; work_.alive_count > target_; ++i) work_.kill(by_area[i].second);
  }

  WorkMesh& work_;
  const Mesh& source_;
  BorderLines borders_;
  std::vector<Patch> patches_;
  Parts parts_;
  const uint32_t wanted_;  // with what comes besides
  uint32_t target_;        // without
  int rules_loosened_ = 0;
  Collapser collapser_;
  ReliefPress press_;
  CostQueue queue_;
  std::vector<uint32_t> alive_in_part_;
  std::vector<float> paint_m_;        // of each part: paint_cost, once it has been asked; less than 0 before
  std::vector<float> may_fall_to_m_;  // of each place: what it costs for certain, should nothing flip any more
  std::vector<uint32_t> ring_;
  std::vector<glm::vec3> points_;
  float reached_m_ = 0;  // the largest cost that was paid
  std::vector<float> costs_;
  std::vector<Parts::Beside> beside_;  // of each of points_, among what remains
  std::vector<uint32_t> places_, triangles_;
};

}  // namespace

Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, Border& border, SimplifyFigures* figures) {
  if (figures != nullptr) *figures = {};
  const auto fits = [&](const Mesh& result, const Border& its_border) {
    const size_t triangles = result.triangle_count();
    return triangles <= options.target_triangles &&
           (!options.besides || triangles + options.besides(result, its_border) <= options.target_triangles);
  };
  if (fits(mesh, border)) return mesh;
  WorkMesh work = make_work_mesh(mesh);
  if (work.alive_count <= options.target_triangles) {
    Border as_it_is = BorderLines(work, border).border(work);
    if (Mesh result = finish(work, mesh); fits(result, as_it_is)) {
      border = std::move(as_it_is);
      return result;
    }
  }
  Simplifier simplifier(work, mesh, options, border);
  const SimplifyFigures reached = simplifier.run(options.besides);
  if (figures != nullptr) *figures = reached;
  border = simplifier.border();
  return finish(work, mesh);
}

Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, SimplifyFigures* figures) {
  Border none;
  return simplify(mesh, options, none, figures);
}

}  // namespace promenade
