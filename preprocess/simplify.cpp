#include "preprocess/simplify.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "preprocess/collapse.h"
#include "preprocess/cost_queue.h"
#include "preprocess/key_set.h"
#include "preprocess/parts.h"
#include "preprocess/patches.h"
#include "preprocess/relief_press.h"
#include "preprocess/twins.h"
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

/// Of the largest cost, the side of cells that hold one point each of all that parts leave beside what stands for
/// several: their copies leave the same.
constexpr float kPointCell = 0.03F;
constexpr float kLeastPointCell = 1e-6F;  // metres

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
    area_m2 += 0.5 * work.alive[c / 3] *
               double(glm::length(glm::cross(work.at(c + 1) - work.at(c), work.at(c + 2) - work.at(c))));
  const auto spacing_m = static_cast<float>(kSpacing * std::sqrt(area_m2 / target));
  return std::max(spacing_m, std::numeric_limits<float>::min());
}

/// Collapses, removals of parts, liftings of patches and pressings of reliefs in one queue, cheapest first: items are
/// numbered in this order.
///
/// Of parts that are one another moved only one is in the work mesh, and what happens to it happens to all. But each
/// vanishes by itself, for other things are beside each.
class Simplifier {
 public:
  /// twins: taken out of the work mesh.
  Simplifier(WorkMesh& work, const Mesh& source, Twins twins, const SimplifyOptions& options, const Border& border)
      : work_(work),
        source_(source),
        borders_(work, border),
        patches_(add_patches(work, source)),
        twins_(with_patches(std::move(twins), patches_)),
        parts_(work, [this](uint32_t triangle) { return offsets_of_copies(triangle); }),
        wanted_(std::max(options.target_triangles, 1U)),
        target_(wanted_),
        collapser_(work, source, borders_, point_spacing_m(work, target_)),
        press_(work, collapser_, borders_, find_reliefs(work, kDeepestRelief * work.diagonal_m), patches_),
        queue_(static_cast<uint32_t>(work.place_count() + parts_.count() + patches_.size() + press_.count())),
        alive_in_part_(parts_.originals()),
        is_here_(parts_.count()),
        paint_m_(parts_.count(), -1.0F),
        may_fall_to_m_(work.place_count(), kNowhere) {
    for (uint32_t part = 0; part < parts_.originals(); ++part)
      if (work.alive[parts_.triangles(part).front()] != 0)
        alive_in_part_[part] = static_cast<uint32_t>(parts_.triangles(part).size());
    for (uint32_t part = 0; part < parts_.count(); ++part)
      is_here_[part] = alive_in_part_[parts_.original_of(part)] > 0 ? 1 : 0;
    vertex_of_place_.resize(work.place_count());
    for (uint32_t c = 0; c < work.place.size(); ++c) vertex_of_place_[work.place[c]] = work.attributes[c];
    if (double(borders_.edge_count()) <= kMostLockedShare * target_) collapser_.set_border_rule(Rule::stay);
  }

  /// besides: as in SimplifyOptions. border: becomes that of the result.
  Mesh run(const std::function<size_t(const Mesh&, const Border&)>& besides, Border& border, SimplifyFigures& figures) {
    queue_parts();
    for (uint32_t i = 0; i < patches_.size(); ++i) queue_.set(places() + parts_.count() + i, 0);
    for (uint32_t i = 0; i < press_.count(); ++i) queue_.set(first_relief() + i, press_.first_cost(i));
    queue_places();
    reduce();
    for (int round = 0; besides && round < kMostRounds; ++round) {
      const size_t more = besides(finish(work_, source_), borders_.border(work_));
      if (work_.shown_count + more <= wanted_ || target_ == 1) break;
      // What comes besides rarely grows as the border loses edges.
      target_ = more + 1 < wanted_ ? std::min(target_ - 1, wanted_ - static_cast<uint32_t>(more)) : target_ / 2;
      reduce();
    }
    Shown shown = all_shown();
    figures = {raise(shown), reached_m_};
    border = borders_.border(shown.work);
    return finish(shown.work, source_);
  }

 private:
  using Rule = Collapser::BorderRule;
  static constexpr float kNowhere = std::numeric_limits<float>::infinity();

  /// The work mesh with all copies that have not vanished.
  struct Shown {
    WorkMesh work;
    std::vector<uint32_t> part;  ///< of each triangle
  };

  uint32_t class_of_part(uint32_t original) const {
    return twins_.class_of_triangle[parts_.triangles(original).front()];
  }

  /// What a patch is lifted to has its twins where the patch has.
  static Twins with_patches(Twins twins, const std::vector<Patch>& patches) {
    for (const Patch& patch : patches)
      for (const uint32_t t : patch.triangles) twins.class_of_triangle.push_back(uint32_t(twins.class_of_triangle[t]));
    return twins;
  }

  /// Of the part that a triangle is in.
  std::vector<glm::vec3> offsets_of_copies(uint32_t triangle) const {
    std::vector<glm::vec3> offsets;
    if (const uint32_t its_class = twins_.class_of_triangle[triangle]; its_class != Twins::kNone)
      for (uint32_t i = twins_.first_copy[its_class]; i < twins_.first_copy[its_class + 1]; ++i)
        offsets.push_back(twins_.copies[i].offset);
    return offsets;
  }

  /// In the order of the source's vertices.
  Shown all_shown() const {
    Shown shown;
    WorkMesh& all = shown.work;
    all.origin = work_.origin, all.diagonal_m = work_.diagonal_m;
    all.positions = work_.positions, all.model_positions = work_.model_positions;
    std::vector<Triangle> triangles;
    triangles.reserve(work_.shown_count);
    std::vector<uint32_t> place_in_copy(work_.place_count(), WorkMesh::kNone);
    for (uint32_t part = 0; part < parts_.count(); ++part)
      if (is_here_[part] != 0) add_part(part, all, place_in_copy, triangles);
    std::vector<uint64_t> order;
    order.reserve(triangles.size());
    for (uint32_t i = 0; i < triangles.size(); ++i) order.push_back(uint64_t(triangles[i].attributes[0]) << 32U | i);
    std::sort(order.begin(), order.end());
    all.first_corner.assign(all.place_count(), WorkMesh::kNone);
    for (const uint64_t key : order) {
      const Triangle& triangle = triangles[static_cast<uint32_t>(key)];
      shown.part.push_back(triangle.part);
      all.source_triangle.push_back(triangle.source_triangle);
      for (uint32_t c = 0; c < 3; ++c) {
        const auto corner = static_cast<uint32_t>(all.place.size());
        all.place.push_back(triangle.place[c]), all.attributes.push_back(triangle.attributes[c]);
        all.next_corner.push_back(all.first_corner[triangle.place[c]]);
        all.first_corner[triangle.place[c]] = corner;
      }
    }
    all.alive.assign(triangles.size(), 1);
    all.alive_count = all.shown_count = static_cast<uint32_t>(triangles.size());
    return shown;
  }

  struct Triangle {
    uint32_t part, source_triangle;
    std::array<uint32_t, 3> place, attributes;
  };

  /// place_in_copy: of each place of the work mesh kNone, in and out.
  void add_part(uint32_t part, WorkMesh& all, std::vector<uint32_t>& place_in_copy,
                std::vector<Triangle>& triangles) const {
    const uint32_t original = parts_.original_of(part);
    const bool is_copy = part != original;
    const uint32_t copy =
        is_copy ? twins_.first_copy[class_of_part(original)] + part - parts_.first_copy(original) : Twins::kNone;
    for (const uint32_t t : parts_.triangles(part)) {
      if (work_.alive[t] == 0) continue;
      Triangle& triangle = triangles.emplace_back();
      triangle.part = part, triangle.source_triangle = work_.source_triangle[t];
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t place = work_.place[t * 3 + c], vertex = work_.attributes[t * 3 + c];
        if (is_copy && place_in_copy[place] == WorkMesh::kNone) {
          place_in_copy[place] = static_cast<uint32_t>(all.place_count());
          const glm::vec3 position = position_in_copy(place, copy);
          all.model_positions.push_back(position), all.positions.push_back(position - all.origin);
        }
        triangle.place[c] = is_copy ? place_in_copy[place] : place;
        triangle.attributes[c] = is_copy ? twins_.vertex_of(copy, vertex) : vertex;
      }
    }
    if (!is_copy) return;
    for (const uint32_t t : parts_.triangles(part))
      for (uint32_t c = t * 3; c < t * 3 + 3; ++c) place_in_copy[work_.place[c]] = WorkMesh::kNone;
  }

  /// The source's, bit by bit, where the place has not moved.
  glm::vec3 position_in_copy(uint32_t place, uint32_t copy) const {
    const glm::vec3 &from = source_.positions[vertex_of_place_[place]], &now = work_.model_positions[place];
    const glm::vec3& its = source_.positions[twins_.vertex_of(copy, vertex_of_place_[place])];
    return now == from ? its : its + (now - from);
  }

  void reduce() {
    for (drain(); work_.shown_count > target_; drain())
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
    for (uint32_t part = 0; part < parts_.originals(); ++part) queue_with_copies(part);
  }

  void queue_places() {
    std::fill(may_fall_to_m_.begin(), may_fall_to_m_.end(), kNowhere);  // what was certain under other rules
    for (uint32_t p = 0; p < places(); ++p) queue_.set(p, collapser_.estimate(p));
  }

  void drain() {
    while (work_.shown_count > target_ && !queue_.empty()) {
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

  float raise(Shown& shown) {
    if (!(reached_m_ > 0)) return 0;
    std::vector<uint8_t> part_may_rise(parts_.count(), 0);
    for (const Patch& patch : patches_) {
      const uint32_t part = parts_.of_place(work_.place[patch.first_copy * 3]);
      part_may_rise[part] = 1;
      std::fill_n(part_may_rise.begin() + parts_.first_copy(part), parts_.copies(part), uint8_t(1));
    }
    for (uint32_t part = 0; part < parts_.count(); ++part)
      if (is_here_[part] != 0 && alive_in_part_[parts_.original_of(part)] <= kMostSheetTriangles &&
          part_may_rise[part] == 0)
        part_may_rise[part] = is_on_top(part) ? 1 : 0;
    std::vector<uint8_t> may_rise(shown.work.triangle_count());
    for (uint32_t t = 0; t < may_rise.size(); ++t) may_rise[t] = part_may_rise[shown.part[t]];
    const float height_m = std::exp2(std::floor(std::log2(kSheetHeight * reached_m_)));
    return raise_sheets(shown.work, source_, may_rise, height_m, kSheetReach * reached_m_) ? height_m : 0;
  }

  /// What was beneath another surface from the beginning stays there.
  bool is_on_top(uint32_t part) {
    const std::vector<uint32_t>& triangles = parts_.triangles(part);
    const auto alive =
        std::find_if(triangles.begin(), triangles.end(), [&](uint32_t t) { return work_.alive[t] != 0; });
    if (alive == triangles.end()) return false;
    const glm::vec3 a = work_.at(*alive * 3), b = work_.at(*alive * 3 + 1), c = work_.at(*alive * 3 + 2);
    const std::optional<float> height_m =
        parts_.height_besides(part, (a + b + c) / 3.0F + parts_.offset(part), glm::cross(b - a, c - a));
    return height_m && *height_m >= 0;
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
    // Of the walls that it is in as many as are there still: at least one, or nothing would close.
    const uint32_t part = parts_.of_place(work_.place[size_t(patch.first_copy) * 3]);
    const uint32_t wall = parts_.of_place(work_.place[patch.triangles.front() * 3]);
    uint8_t walls = is_here_[part] = is_here_[wall];
    for (uint32_t i = 0; i < parts_.copies(part); ++i)
      walls += is_here_[parts_.first_copy(part) + i] = is_here_[parts_.first_copy(wall) + i];
    lift(patch, work_, walls);
    alive_in_part_[part] = static_cast<uint32_t>(patch.triangles.size());
    queue_with_copies(part);
    for (uint32_t t = 0; t < patch.triangles.size(); ++t)
      for (uint32_t c = 0; c < 3; ++c)
        for (const uint32_t of : {work_.place[(patch.first_copy + t) * 3 + c], work_.place[patch.triangles[t] * 3 + c]})
          queue_again(work_.current(of));
  }

  void try_relief(uint32_t index) {
    const float queued = queue_.top_cost();
    queue_.remove(first_relief() + index);
    const float limit = patience(queued);
    const float cost = press_.press(index, limit);
    if (cost > limit) return queue_.set(first_relief() + index, cost);
    reached_m_ = std::max(reached_m_, cost);
    for (const uint32_t place : press_.changed()) queue_again(place);
    count_alive_around(press_.changed());
  }

  /// Of the parts that have the places: a wall's, and those of what is painted on it.
  void count_alive_around(const std::vector<uint32_t>& places) {
    std::vector<uint32_t> parts;
    parts.reserve(places.size());
    for (const uint32_t place : places) parts.push_back(parts_.of_place(place));
    std::sort(parts.begin(), parts.end());
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    for (const uint32_t part : parts) {
      const std::vector<uint32_t>& triangles = parts_.triangles(part);
      alive_in_part_[part] = static_cast<uint32_t>(
          std::count_if(triangles.begin(), triangles.end(), [&](uint32_t t) { return work_.alive[t] != 0; }));
    }
  }

  /// What costs no more than this may as well be done now: the rest of the queue costs about as much.
  float patience(float queued) const { return std::max(queued, queue_.empty() ? 0 : queue_.top_cost()) * kPatience; }

  /// Copies too wait each at its own cost: one in turn for all would keep a cheap one waiting for a dear one.
  void try_part(uint32_t part) {
    const float queued = queue_.top_cost();
    queue_.remove(places() + part);
    if (const float cost = try_removal(part, patience(queued)); is_here_[part] != 0) queue_.set(places() + part, cost);
  }

  /// An original and its copies, as far as they are there: each by itself.
  void queue_with_copies(uint32_t original) {
    if (is_here_[original] != 0) queue_.set(places() + original, 0);
    for (uint32_t i = 0; i < parts_.copies(original); ++i)
      if (const uint32_t copy = parts_.first_copy(original) + i; is_here_[copy] != 0) queue_.set(places() + copy, 0);
  }

  /// Removes a part if that costs no more than the limit. Returns what it costs; over the limit at most that.
  float try_removal(uint32_t part, float limit) {
    if (!parts_.looked_at(part))  // most are far too dear, as any of their points shows, and never looked at again
      if (const float cost = parts_.first_look(part, limit); cost > limit) return cost;
    gather_points(part, limit);
    float& paint = paint_m_[part];  // asked once: its surroundings change little before it goes
    if (paint < 0) paint = paint_cost(part);
    if (paint > limit) return paint;
    const float cost = parts_.removal_cost(part, points_, limit, beside_);
    if (cost > limit) return std::max(cost, paint);
    const float now = std::max(cost, distance_now());
    if (now > limit) return now;
    reached_m_ = std::max(reached_m_, now);
    parts_.remove(part);
    is_here_[part] = 0;
    uint32_t& alive = alive_in_part_[parts_.original_of(part)];
    for (const uint32_t t : parts_.triangles(part)) {
      if (work_.alive[t] == 0) continue;
      work_.drop_copy(t);
      if (work_.alive[t] != 0) continue;
      alive = 0;
      for (uint32_t c = 0; c < 3; ++c) queue_.remove(work_.place[t * 3 + c]);
    }
    for (size_t i = 0; i < points_.size(); ++i)
      if (triangles_[i] != WorkMesh::kNone && is_new_point(points_[i], triangles_[i]))
        collapser_.add_point(points_[i], triangles_[i]);
    return now;
  }

  /// Whether what stands for several has not been given such a point before.
  bool is_new_point(const glm::vec3& point, uint32_t triangle) {
    if (work_.alive[triangle] < 2) return true;
    const float scale = std::exp2(-std::ceil(std::log2(std::max(kPointCell * reached_m_, kLeastPointCell))));
    uint64_t key = parts_.of_place(work_.place[triangle * 3]);
    key = scramble(key ^ std::bit_cast<uint32_t>(scale));
    for (int axis = 0; axis < 3; ++axis)
      key = scramble(key ^ static_cast<uint64_t>(static_cast<int64_t>(std::floor(point[axis] * scale))));
    return given_points_.insert(key);
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
    for (glm::vec3& p : points_) p += parts_.offset(part);
  }

  /// Largest distance of points_ to what has become of the surface beside_ them: a ledge removed after the wall behind
  /// it has gone back to its windows. Finds triangles_, the nearest ones there. Moves points_ to where what is beside
  /// them has its original.
  float distance_now() {
    places_.clear();
    for (size_t i = 0; i < beside_.size(); ++i) {
      places_.push_back(work_.current(work_.place[beside_[i].corner]));
      points_[i] -= parts_.offset(beside_[i].part);
    }
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
    for (size_t i = 0; work_.shown_count > target_; ++i) work_.kill(by_area[i].second);
  }

  WorkMesh& work_;
  const Mesh& source_;
  BorderLines borders_;
  std::vector<Patch> patches_;
  const Twins twins_;
  Parts parts_;
  const uint32_t wanted_;  // with what comes besides
  uint32_t target_;        // without
  int rules_loosened_ = 0;
  Collapser collapser_;
  ReliefPress press_;
  CostQueue queue_;
  std::vector<uint32_t> alive_in_part_;    // of each original: triangles
  std::vector<uint8_t> is_here_;           // of each part: alive in the beginning or lifted, and not gone
  std::vector<uint32_t> vertex_of_place_;  // of the source, where the place was in the beginning
  std::vector<float> paint_m_;             // of each part: paint_cost, once it has been asked; less than 0 before
  std::vector<float> may_fall_to_m_;       // of each place: what it costs for certain, should nothing flip any more
  std::vector<uint32_t> ring_;
  std::vector<glm::vec3> points_;
  float reached_m_ = 0;  // the largest cost that was paid
  std::vector<float> costs_;
  std::vector<Parts::Beside> beside_;  // of each of points_, among what remains
  std::vector<uint32_t> places_, triangles_;
  KeySet given_points_;  // cells of them, by part, to what stands for several
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
  const BorderLines borders(work, border);
  Twins twins = take_twins(work, mesh, [&](uint32_t place) { return borders.has(place); });
  SimplifyFigures reached;
  Mesh result = Simplifier(work, mesh, std::move(twins), options, border).run(options.besides, border, reached);
  if (figures != nullptr) *figures = reached;
  return result;
}

Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, SimplifyFigures* figures) {
  Border none;
  return simplify(mesh, options, none, figures);
}

}  // namespace promenade
