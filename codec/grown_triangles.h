#pragma once
// Which triangle lies beyond which edge of one that is known, in places; and which of the vertices there are its
// corners. FORMAT.md says how. Source of growing across edges: J. Rossignac, Edgebreaker: Connectivity Compression for
// Triangle Meshes, 1999; here without its topology's demands, for any triangles in any number of parts.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/grown_border.h"
#include "codec/grown_kin.h"
#include "codec/grown_source.h"
#include "codec/told_number.h"

namespace promenade {

/// The triangles of a mesh, grown on both sides alike.
template <class Side>
class TriangleGrower {
 public:
  /// most_vertices: more are refused. source: a PutSide's, else null.
  TriangleGrower(Side& side, size_t most_vertices, size_t triangles, GrownSource* source)
      : side_(side),
        source_(source),
        indices_(3 * triangles),
        place_of_(most_vertices),
        before_there_(most_vertices),
        vertex_kin_(most_vertices),
        latest_vertex_(most_vertices),
        latest_edge_(most_vertices),
        place_kin_(most_vertices) {}
  /// All triangles of a run. False: what is told cannot be.
  bool grow_run(size_t triangles);

  std::vector<uint32_t> take_indices() { return std::move(indices_); }
  uint32_t vertices() const { return vertices_; }
  uint32_t places() const { return places_; }
  /// By vertex.
  const std::vector<uint32_t>& place_of() const { return place_of_; }
  const std::vector<VertexKin>& vertex_kin() const { return vertex_kin_; }
  /// By place.
  const std::vector<PlaceKin>& place_kin() const { return place_kin_; }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  static constexpr uint32_t kNoEdge = GrownBorder::kNoEdge;
  using Corners = std::array<uint32_t, 3>;

  // What lies beyond an edge: nothing; a triangle with a new corner; with one that closes a gap to the edge from its
  // end, to its begin; with any other that is known.
  static constexpr uint32_t kNothing = 0, kNew = 1, kAhead = 2, kBehind = 3, kOther = 4, kWays = 5;
  // Added to a way but the first: some corner is another vertex than it is likely to be.
  static constexpr uint32_t kOtherCorners = 4;

  /// What is known around an edge: where those linked to it end, and which of these are there: 1 the next one's end, 2
  /// the begin of the one before; 4: both, in one place.
  struct Gap {
    uint32_t ahead = 0, behind = 0;  ///< places
    uint32_t kind = 0;
  };
  static constexpr uint32_t kAheadGap = 1, kBehindGap = 2, kBothGap = 4, kGaps = 5;
  /// Which ways there are, by the gap's kind: a bit for each.
  static constexpr std::array<uint32_t, kGaps> kPossible = {0b10011, 0b10111, 0b11011, 0b11111, 0b11111};
  /// What lies beyond an edge; a PutSide's alone.
  struct Wish {
    uint32_t way = kNothing;
    uint32_t third = kNone;  ///< place
    uint32_t others = 0;     ///< which of the known corners are not the likely vertices
    Corners sources{};
  };

  uint32_t add_place(const PlaceKin& kin, uint32_t source_vertex);
  uint32_t add_vertex(uint32_t place, const Guess& guess, uint32_t twin, uint32_t source_vertex);
  static Guess one_guess(uint32_t vertex) { return {vertex, 0, 0, uint8_t(vertex == kNone ? 0 : 1)}; }
  uint32_t tell_vertex(uint32_t likely, uint32_t& like, uint32_t source_vertex);
  uint32_t tell_far_vertex(uint32_t place, uint32_t wanted);
  uint32_t rank_there(uint32_t likely, uint32_t wanted) const;
  uint32_t ranked_there(uint32_t likely, uint32_t rank) const;
  bool tell_begin(size_t corner, uint32_t source_vertex, uint32_t& like, Corners& v);
  bool begin_part();
  Gap gap_of(const OpenEdge& edge) const;
  uint32_t likely_third(const OpenEdge& edge, uint32_t way, uint32_t place) const;
  Wish wish_beyond(const OpenEdge& edge, const Gap& gap);
  bool tell_third(AtHand<Side>& hand, const OpenEdge& edge, const Gap& gap, uint32_t wanted, uint32_t& place);
  bool tell_others(const Wish& wish, size_t known, uint32_t others, Corners& v, uint32_t& like);
  bool tell_corners(AtHand<Side>& hand, const Wish& wish, size_t known, Corners& v, uint32_t& like);
  uint32_t add_edge(const Corners& v, size_t first, uint32_t from_place, uint32_t to_place);
  void add_triangle(const Corners& v);
  void add_gap(const OpenEdge& edge, uint32_t place, const Corners& v);
  void close_gap(const OpenEdge& edge, const Gap& gap, uint32_t way, const Corners& v);
  void split(const OpenEdge& edge, uint32_t place, const Corners& v);
  bool grow_beyond(AtHand<Side>& hand, const OpenEdge& edge);

  Side& side_;
  GrownSource* source_;
  std::vector<uint32_t> indices_;
  size_t corners_ = 0;                                 ///< how many indices there are yet
  uint32_t vertices_ = 0, places_ = 0;                 ///< how many there are yet
  std::vector<uint32_t> place_of_, before_there_;      ///< by vertex: its place, another one there
  std::vector<VertexKin> vertex_kin_;                  ///< by vertex
  std::vector<uint32_t> latest_vertex_, latest_edge_;  ///< by place: an edge from there, while it is open
  std::vector<PlaceKin> place_kin_;                    ///< by place: no more than vertices
  GrownBorder border_;
  uint32_t ways_before_ = 0;  ///< the last two
  uint32_t had_others_ = 0;   ///< whether some corner of the last triangle was not the likely vertex
  std::array<NibbleModel, 2 * kGaps * kWays * kWays> way_models_;
  std::array<NibbleModel, 2> corner_models_;  ///< of two known corners, of three
  std::array<BitModel, 3> begin_models_;
  std::array<BitModel, 3> begin_corner_models_;
  NibbleModel rank_model_;
  std::array<NibbleModel, 3> back_models_;  ///< places of a part's first corners, of third corners, vertices
};

template <class Side>
bool TriangleGrower<Side>::grow_run(size_t triangles) {
  border_.clear();
  ways_before_ = had_others_ = 0;
  const size_t end = corners_ + 3 * triangles;
  AtHand<Side> hand(side_);
  while (corners_ < end) {
    OpenEdge edge;
    border_.make_room();
    if (border_.take(edge)) {
      if (!grow_beyond(hand, edge)) return false;
    } else {
      hand.lay_back();
      const bool began = begin_part();
      hand.take_up();
      if (!began) return false;
    }
    if (hand.get().is_broken()) return false;
  }
  return true;
}

/// kNone: there are too many vertices.
template <class Side>
[[gnu::always_inline]] inline uint32_t TriangleGrower<Side>::add_place(const PlaceKin& kin, uint32_t source_vertex) {
  if (vertices_ >= place_of_.size()) return kNone;
  place_kin_[places_] = kin;
  latest_vertex_[places_] = kNone;
  latest_edge_[places_] = kNoEdge;
  if constexpr (Side::kPuts) source_->grow_place(source_vertex);
  return places_++;
}

/// kNone: there are too many.
template <class Side>
[[gnu::always_inline]] inline uint32_t TriangleGrower<Side>::add_vertex(uint32_t place, const Guess& guess,
                                                                        uint32_t twin, uint32_t source_vertex) {
  if (vertices_ >= place_of_.size()) return kNone;
  place_of_[vertices_] = place;
  before_there_[vertices_] = latest_vertex_[place];
  latest_vertex_[place] = vertices_;
  vertex_kin_[vertices_] = {guess, twin};
  if constexpr (Side::kPuts) source_->grow_vertex(source_vertex);
  return vertices_++;
}

template <class Side>
[[gnu::always_inline]] inline void TriangleGrower<Side>::add_triangle(const Corners& v) {
  for (size_t i = 0; i < 3; ++i) indices_[corners_ + i] = v[i];
  corners_ += 3;
}

/// Another vertex than `likely` in its place: one that is known, or a new one, which looks like `like`. kNone: broken.
template <class Side>
uint32_t TriangleGrower<Side>::tell_vertex(uint32_t likely, uint32_t& like, uint32_t source_vertex) {
  constexpr uint32_t kFar = NibbleModel::kSymbols - 1;
  const uint32_t place = place_of_[likely];
  uint32_t wanted = kNone, told = 0;
  if constexpr (Side::kPuts) wanted = source_->grown_vertex(source_vertex);
  if (latest_vertex_[place] != likely || before_there_[likely] != kNone) {
    if (wanted != kNone) told = std::min(rank_there(likely, wanted), kFar);
    told = side_.tell(rank_model_, told);
  }
  if (told == kFar) return tell_far_vertex(place, wanted);
  if (told > 0) return ranked_there(likely, told);
  like = add_vertex(place, one_guess(like != kNone ? like : likely), likely, source_vertex);
  return like;
}

/// One of many in a place.
template <class Side>
uint32_t TriangleGrower<Side>::tell_far_vertex(uint32_t place, uint32_t wanted) {
  const uint32_t back = tell_number(side_, back_models_[2], vertices_ - 1 - wanted);
  return back < vertices_ && place_of_[vertices_ - 1 - back] == place ? vertices_ - 1 - back : kNone;
}

/// The latest vertex in the place has rank 1, and so on, but for `likely`, which has none. At most kSymbols.
template <class Side>
uint32_t TriangleGrower<Side>::rank_there(uint32_t likely, uint32_t wanted) const {
  uint32_t rank = 0;
  for (uint32_t v = latest_vertex_[place_of_[likely]]; v != kNone && rank < NibbleModel::kSymbols;
       v = before_there_[v]) {
    rank += v != likely ? 1 : 0;
    if (v == wanted) break;
  }
  return rank;
}

template <class Side>
uint32_t TriangleGrower<Side>::ranked_there(uint32_t likely, uint32_t rank) const {
  for (uint32_t v = latest_vertex_[place_of_[likely]]; v != kNone; v = before_there_[v])
    if (v != likely && --rank == 0) return v;
  return kNone;
}

/// One corner of a triangle that lies beyond no edge.
template <class Side>
bool TriangleGrower<Side>::tell_begin(size_t corner, uint32_t source_vertex, uint32_t& like, Corners& v) {
  uint32_t wanted = kNone;
  if constexpr (Side::kPuts) wanted = source_->grown_place(source_vertex);
  if (side_.tell(begin_models_[corner], wanted == kNone ? 1 : 0) != 0) {
    const PlaceKin kin = corner == 0 ? kin_of_nothing(places_) : kin_of_one(places_, place_of_[v[corner - 1]]);
    const uint32_t place = add_place(kin, source_vertex);
    if (place == kNone) return false;
    v[corner] = like = add_vertex(place, one_guess(like), kNone, source_vertex);
    return true;
  }
  const uint32_t back = tell_number(side_, back_models_[0], places_ - 1 - wanted);
  if (back >= places_) return false;
  const uint32_t place = places_ - 1 - back;
  for (size_t i = 0; i < corner; ++i)
    if (place_of_[v[i]] == place) return false;
  v[corner] = latest_vertex_[place];
  bool is_other = false;
  if constexpr (Side::kPuts) is_other = source_->grown_vertex(source_vertex) != v[corner];
  if (side_.tell(begin_corner_models_[corner], is_other ? 1 : 0) != 0)
    v[corner] = tell_vertex(v[corner], like, source_vertex);
  return v[corner] != kNone;
}

/// A triangle that lies beyond no edge.
template <class Side>
bool TriangleGrower<Side>::begin_part() {
  Corners wanted{}, v{};
  if constexpr (Side::kPuts) wanted = source_->next_triangle();
  uint32_t like = vertices_ == 0 ? kNone : vertices_ - 1;
  for (size_t i = 0; i < 3; ++i)
    if (!tell_begin(i, wanted[i], like, v)) return false;
  add_triangle(v);
  const Corners at{place_of_[v[0]], place_of_[v[1]], place_of_[v[2]]};
  const uint32_t first = add_edge(v, 0, at[0], at[1]), second = add_edge(v, 1, at[1], at[2]),
                 third = add_edge(v, 2, at[2], at[0]);
  border_.link(first, second), border_.link(second, third), border_.link(third, first);
  return true;
}

template <class Side>
[[gnu::always_inline]] inline typename TriangleGrower<Side>::Gap TriangleGrower<Side>::gap_of(
    const OpenEdge& edge) const {
  Gap gap;
  gap.ahead = border_[edge.next].to_place, gap.behind = border_[edge.before].from_place;
  const bool ahead = gap.ahead != GrownBorder::kNoEnd && gap.ahead != edge.from_place,
             behind = gap.behind != GrownBorder::kNoBegin && gap.behind != edge.to_place;
  gap.kind = (ahead ? kAheadGap : 0U) + (behind ? kBehindGap : 0U);
  if (ahead && gap.ahead == gap.behind) gap.kind = kBothGap;
  return gap;
}

/// The vertex that a known third corner is likely to be. place: of kOther.
template <class Side>
[[gnu::always_inline]] inline uint32_t TriangleGrower<Side>::likely_third(const OpenEdge& edge, uint32_t way,
                                                                          uint32_t place) const {
  if (way == kOther) return latest_vertex_[place];
  return way == kAhead ? border_[edge.next].to : border_[edge.before].from;
}

/// What a PutSide tells of an edge.
template <class Side>
typename TriangleGrower<Side>::Wish TriangleGrower<Side>::wish_beyond(const OpenEdge& edge, const Gap& gap) {
  Wish wish;
  if (!source_->beyond(edge.from, edge.to, wish.sources)) return wish;
  wish.third = source_->grown_place(wish.sources[2]);
  wish.way = wish.third == kNone ? kNew : kOther;
  if (wish.third == gap.behind) wish.way = kBehind;
  if (wish.third == gap.ahead) wish.way = kAhead;
  const Corners likely{edge.to, edge.from, wish.way == kNew ? kNone : likely_third(edge, wish.way, wish.third)};
  for (size_t i = 0; i < (wish.way == kNew ? 2U : 3U); ++i)
    wish.others |= source_->grown_vertex(wish.sources[i]) != likely[i] ? 1U << i : 0U;
  return wish;
}

/// The place of a third corner that is known but not linked to the edge.
template <class Side>
[[gnu::always_inline]] inline bool TriangleGrower<Side>::tell_third(AtHand<Side>& hand, const OpenEdge& edge,
                                                                    const Gap& gap, uint32_t wanted, uint32_t& place) {
  const uint32_t back = tell_number(hand.get(), back_models_[1], places_ - 1 - wanted);
  if (back >= places_) return false;
  place = places_ - 1 - back;
  // Those would be linked to it, or collapse it.
  return place != edge.from_place && place != edge.to_place && place != gap.ahead && place != gap.behind;
}

template <class Side>
bool TriangleGrower<Side>::tell_others(const Wish& wish, size_t known, uint32_t others, Corners& v, uint32_t& like) {
  for (size_t i = 0; i < known; ++i)
    if ((others >> i & 1U) != 0 && (v[i] = tell_vertex(v[i], like, wish.sources[i])) == kNone) return false;
  return true;
}

/// Which of the first `known` corners are other vertices than the likely ones in v, and which.
template <class Side>
[[gnu::always_inline]] inline bool TriangleGrower<Side>::tell_corners(AtHand<Side>& hand, const Wish& wish,
                                                                      size_t known, Corners& v, uint32_t& like) {
  const uint32_t others = hand.get().tell(corner_models_[known - 2], wish.others);
  hand.lay_back();
  const bool told = tell_others(wish, known, others, v, like);
  hand.take_up();
  return told;
}

/// The triangle's edge that begins at its corner `first`, linked to nothing.
template <class Side>
[[gnu::always_inline]] inline uint32_t TriangleGrower<Side>::add_edge(const Corners& v, size_t first,
                                                                      uint32_t from_place, uint32_t to_place) {
  const uint32_t edge = border_.add(v[first], v[(first + 1) % 3], v[(first + 2) % 3], from_place, to_place);
  latest_edge_[from_place] = edge;
  return edge;
}

/// The border around a triangle with a new corner.
template <class Side>
[[gnu::always_inline]] inline void TriangleGrower<Side>::add_gap(const OpenEdge& edge, uint32_t place,
                                                                 const Corners& v) {
  const uint32_t ahead = add_edge(v, 2, place, edge.to_place), behind = add_edge(v, 1, edge.from_place, place);
  border_.link(edge.before, behind), border_.link(behind, ahead), border_.link(ahead, edge.next);
}

/// The border around a triangle that lies between edges linked to each other.
template <class Side>
[[gnu::always_inline]] inline void TriangleGrower<Side>::close_gap(const OpenEdge& edge, const Gap& gap, uint32_t way,
                                                                   const Corners& v) {
  if (gap.kind == kBothGap) {
    border_.close(edge.next), border_.close(edge.before);
    border_.link(border_[edge.before].before, border_[edge.next].next);
    return;
  }
  const bool is_ahead = way == kAhead;
  const uint32_t closed = is_ahead ? edge.next : edge.before;
  const uint32_t next = is_ahead ? border_[closed].next : edge.next,
                 before = is_ahead ? edge.before : border_[closed].before;
  border_.close(closed);
  const uint32_t added =
      is_ahead ? add_edge(v, 1, edge.from_place, gap.ahead) : add_edge(v, 2, gap.behind, edge.to_place);
  border_.link(before, added), border_.link(added, next);
}

/// The border around a triangle whose third corner lies elsewhere on it: it falls into two.
template <class Side>
void TriangleGrower<Side>::split(const OpenEdge& edge, uint32_t place, const Corners& v) {
  uint32_t from_there = latest_edge_[place];
  if (from_there >= border_.size() || border_[from_there].is_open == 0 || border_[from_there].from_place != place)
    from_there = kNoEdge;
  const uint32_t to_there = from_there != kNoEdge ? border_[from_there].before : kNoEdge;
  // The triangle's own edges may close those.
  if (border_[to_there].from_place == edge.to_place) {
    border_.link(border_[to_there].before, edge.next);
    border_.close(to_there);
  } else {
    const uint32_t ahead = add_edge(v, 2, place, edge.to_place);
    border_.link(to_there, ahead), border_.link(ahead, edge.next);
  }
  if (border_[from_there].to_place == edge.from_place) {
    border_.link(edge.before, border_[from_there].next);
    border_.close(from_there);
  } else {
    const uint32_t behind = add_edge(v, 1, edge.from_place, place);
    border_.link(edge.before, behind), border_.link(behind, from_there);
  }
}

template <class Side>
[[gnu::always_inline]] inline bool TriangleGrower<Side>::grow_beyond(AtHand<Side>& hand, const OpenEdge& edge) {
  const Gap gap = gap_of(edge);
  Wish wish;
  if constexpr (Side::kPuts) wish = wish_beyond(edge, gap);
  NibbleModel& model = way_models_[(had_others_ * kGaps + gap.kind) * kWays * kWays + ways_before_];
  const uint32_t told = hand.get().tell(model, wish.others == 0 ? wish.way : wish.way + kOtherCorners);
  had_others_ = told < kWays ? 0 : 1;
  const uint32_t way = told - had_others_ * kOtherCorners;
  if (way >= kWays || (kPossible[gap.kind] >> way & 1U) == 0) return false;
  ways_before_ = ways_before_ % kWays * kWays + way;
  if (way == kNothing) {
    border_.link(edge.before, kNoEdge), border_.link(kNoEdge, edge.next);
    return true;
  }
  uint32_t place = kNone, like = kNone;
  Corners v{edge.to, edge.from, kNone};
  if (way == kNew) {
    if (had_others_ != 0 && !tell_corners(hand, wish, 2, v, like)) return false;
    place = add_place(kin_of_three(edge.from_place, edge.to_place, place_of_[edge.across]), wish.sources[2]);
    if (place == kNone) return false;
    const Guess guess = like != kNone ? one_guess(like) : Guess{v[1], v[0], edge.across, 3};
    v[2] = add_vertex(place, guess, kNone, wish.sources[2]);
    add_gap(edge, place, v);
  } else {
    if (way == kOther && !tell_third(hand, OpenEdge(edge), gap, wish.third, place)) return false;
    v[2] = likely_third(edge, way, place);
    if (had_others_ != 0 && !tell_corners(hand, wish, 3, v, like)) return false;
    if (way == kOther)
      split(OpenEdge(edge), place, v);
    else
      close_gap(edge, gap, way, v);
  }
  add_triangle(v);
  return true;
}

}  // namespace promenade
