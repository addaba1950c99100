// The bytes are described in FORMAT.md. Source of growing across edges: J. Rossignac, Edgebreaker: Connectivity
// Compression for Triangle Meshes, 1999; here without its topology's demands, for any triangles in any number of parts.
#include "codec/grown_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "codec/attribute_coder.h"
#include "codec/open_edges.h"
#include "codec/place_coder.h"

namespace promenade {
namespace {

constexpr uint32_t kNone = 0xffffffffU;

// What lies beyond an edge: nothing; a triangle with a new corner; with one that closes a gap to the edge from its end,
// to its begin; with any other that is known.
constexpr uint32_t kNothing = 0, kNew = 1, kAhead = 2, kBehind = 3, kOther = 4, kWays = 5;
// Added to a way but the first: some corner is another vertex than it is likely to be.
constexpr uint32_t kOtherCorners = 4;

/// Which triangles of the source lie where; a PutSide's alone. Vertices and places are the source's here, unless they
/// are said to be grown.
class Source {
 public:
  explicit Source(const QuantizedMesh& mesh) : mesh_(mesh), place_of_(mesh.positions.size()) {
    find_places();
    grown_place_.assign(places_, kNone);
    grown_vertex_.assign(mesh.positions.size(), kNone);
    is_grown_.assign(mesh.indices.size() / 3, 0);
    link_edges();
  }
  void begin_run(size_t first, size_t count) { first_ = first, end_ = first + count, next_ = first; }
  /// The next triangle of the run that has not grown, a corner first that is known where one is.
  std::array<uint32_t, 3> next_triangle() {
    while (is_grown_[next_] != 0) ++next_;
    is_grown_[next_] = 1;
    std::array<uint32_t, 3> v = corners(next_);
    const auto is_known = [&](uint32_t vertex) { return grown_place_[place_of_[vertex]] != kNone; };
    for (int turn = 0; turn < 2 && !is_known(v[0]); ++turn) std::rotate(v.begin(), v.begin() + 1, v.end());
    return v;
  }
  /// A triangle of the run beyond the edge of a grown one, from its begin to its end: its corners at the edge's end,
  /// its begin, and the third. False: there is none.
  bool beyond(uint32_t grown_from, uint32_t grown_to, std::array<uint32_t, 3>& v) {
    const uint32_t from = place_of_[source_of_[grown_from]], to = place_of_[source_of_[grown_to]];
    for (uint32_t c = edges_[slot_of(to, from)]; c != kNone; c = next_same_[c]) {
      const size_t t = c / 3;
      if (t < first_ || t >= end_ || is_grown_[t] != 0 || place_at(c) != to || place_at(after(c)) != from) continue;
      is_grown_[t] = 1;
      v = {mesh_.indices[c], mesh_.indices[after(c)], mesh_.indices[after(after(c))]};
      return true;
    }
    return false;
  }
  const glm::u32vec3& position(uint32_t vertex) const { return mesh_.positions[vertex]; }
  uint32_t grown_place(uint32_t vertex) const { return grown_place_[place_of_[vertex]]; }
  uint32_t grown_vertex(uint32_t vertex) const { return grown_vertex_[vertex]; }
  void grow_place(uint32_t vertex, uint32_t place) { grown_place_[place_of_[vertex]] = place; }
  void grow_vertex(uint32_t vertex) {
    grown_vertex_[vertex] = static_cast<uint32_t>(source_of_.size());
    source_of_.push_back(vertex);
  }
  /// By grown vertex.
  const std::vector<uint32_t>& sources() const { return source_of_; }

 private:
  static uint32_t after(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  std::array<uint32_t, 3> corners(size_t t) const {
    return {mesh_.indices[3 * t], mesh_.indices[3 * t + 1], mesh_.indices[3 * t + 2]};
  }
  uint32_t place_at(uint32_t corner) const { return place_of_[mesh_.indices[corner]]; }
  size_t slot_of(uint32_t from, uint32_t to) const {
    return ((uint64_t(from) << 32U | to) * 0x9e3779b97f4a7c15ULL >> 32U) & (edges_.size() - 1);
  }
  void find_places() {
    const std::vector<glm::u32vec3>& positions = mesh_.positions;
    std::vector<uint32_t> table(std::bit_ceil(positions.size() * 2 + 1), kNone);  // open addressing: a vertex there
    for (uint32_t v = 0; v < positions.size(); ++v) {
      const glm::u32vec3& p = positions[v];
      const uint64_t hash =
          ((uint64_t(p.x) * 0x9e3779b97f4a7c15ULL ^ p.y) * 0xbf58476d1ce4e5b9ULL ^ p.z) * 0x94d049bb133111ebULL;
      size_t slot = (hash >> 32U) & (table.size() - 1);
      while (table[slot] != kNone && positions[table[slot]] != p) slot = (slot + 1) & (table.size() - 1);
      place_of_[v] = table[slot] == kNone ? places_++ : place_of_[table[slot]];
      if (table[slot] == kNone) table[slot] = v;
    }
  }
  void link_edges() {
    edges_.assign(std::bit_ceil(mesh_.indices.size() + 1), kNone);
    next_same_.assign(mesh_.indices.size(), kNone);
    for (auto c = static_cast<uint32_t>(mesh_.indices.size()); c-- > 0;) {  // so that the first comes first
      uint32_t& first = edges_[slot_of(place_at(c), place_at(after(c)))];
      next_same_[c] = first;
      first = c;
    }
  }

  const QuantizedMesh& mesh_;
  uint32_t places_ = 0;
  std::vector<uint32_t> place_of_;
  std::vector<uint32_t> edges_, next_same_;  ///< corners that edges begin at: the first by hash, and the next
  std::vector<uint32_t> grown_place_, grown_vertex_, source_of_;
  std::vector<uint8_t> is_grown_;
  size_t first_ = 0, end_ = 0, next_ = 0;
};

/// The triangles and places of a mesh, grown on both sides alike.
template <class Side>
class Grower {
 public:
  /// mesh: with the fields that are no arrays. source: a PutSide's, else null.
  Grower(Side& side, const QuantizedMesh& mesh, size_t most_vertices, Source* source)
      : side_(side),
        source_(source),
        most_vertices_(most_vertices),
        places_(side, mesh.on_grid, mesh.fine_bits, most_vertices),
        edges_(place_of_) {}

  /// False: what is told cannot be.
  bool grow_run(size_t triangles) {
    edges_.close_all();
    ways_before_ = had_others_ = 0;
    const size_t end = indices.size() + 3 * triangles;
    while (indices.size() < end) {
      OpenEdge edge;
      if (!(edges_.take(edge) ? grow_beyond(edge) : begin_part())) return false;
      if (side_.is_broken() || place_of_.size() > most_vertices_) return false;
    }
    return true;
  }

  std::vector<uint32_t> indices;
  std::vector<VertexKin> kin;
  std::vector<glm::u32vec3> positions() const {
    std::vector<glm::u32vec3> all;
    all.reserve(place_of_.size());
    for (const uint32_t place : place_of_) all.push_back(places_.places()[place]);
    return all;
  }

 private:
  using Corners = std::array<uint32_t, 3>;

  uint32_t add_place(const PlaceKin& of, uint32_t source_vertex) {
    const auto place = static_cast<uint32_t>(places_.count());
    if (!places_.add(of, source_ != nullptr ? source_->position(source_vertex) : glm::u32vec3(0))) return kNone;
    edges_.add_place();
    latest_vertex_.push_back(kNone);
    if (source_ != nullptr) source_->grow_place(source_vertex, place);
    return place;
  }
  uint32_t add_vertex(uint32_t place, const Guess& guess, uint32_t twin, uint32_t source_vertex) {
    const auto vertex = static_cast<uint32_t>(place_of_.size());
    place_of_.push_back(place);
    before_there_.push_back(latest_vertex_[place]);
    latest_vertex_[place] = vertex;
    kin.push_back({guess, twin});
    if (source_ != nullptr) source_->grow_vertex(source_vertex);
    return vertex;
  }
  static Guess one_guess(uint32_t vertex) { return {vertex, 0, 0, uint8_t(vertex == kNone ? 0 : 1)}; }

  /// Another vertex than `likely` in its place: one that is known, or a new one, which looks like `like`. kNone:
  /// broken.
  uint32_t tell_vertex(uint32_t likely, uint32_t& like, uint32_t source_vertex) {
    constexpr uint32_t kFar = NibbleModel::kSymbols - 1;
    const uint32_t place = place_of_[likely];
    uint32_t wanted = kNone, told = 0;
    if (source_ != nullptr) wanted = source_->grown_vertex(source_vertex);
    if (latest_vertex_[place] != likely || before_there_[likely] != kNone) {
      if (wanted != kNone) told = std::min(rank_there(likely, wanted), kFar);
      told = side_.tell(rank_model_, told);
    }
    if (told == kFar) {
      const auto count = static_cast<uint32_t>(place_of_.size());
      const uint32_t back = tell_number(side_, back_models_[2], count - 1 - wanted);
      return back < count && place_of_[count - 1 - back] == place ? count - 1 - back : kNone;
    }
    if (told > 0) return ranked_there(likely, told);
    like = add_vertex(place, one_guess(like != kNone ? like : likely), likely, source_vertex);
    return like;
  }
  /// The latest vertex in the place has rank 1, and so on, but for `likely`, which has none.
  uint32_t rank_there(uint32_t likely, uint32_t wanted) const {
    uint32_t rank = 0;
    for (uint32_t v = latest_vertex_[place_of_[likely]]; v != kNone; v = before_there_[v]) {
      rank += v != likely ? 1 : 0;
      if (v == wanted) break;
    }
    return rank;
  }
  uint32_t ranked_there(uint32_t likely, uint32_t rank) const {
    uint32_t v = latest_vertex_[place_of_[likely]];
    for (; v != kNone; v = before_there_[v])
      if (v != likely && --rank == 0) return v;
    return kNone;
  }

  /// What is known around an edge: where an open one goes on from its end to, and where one comes from to its begin.
  struct Gap {
    uint32_t next = kNone, before = kNone;   ///< these edges
    uint32_t ahead = kNone, behind = kNone;  ///< the vertices there; kNone: nothing that a triangle could end at
    uint32_t kind = 0;                       ///< which of them there are: 1 and 2; 4: both, in one place
  };
  static constexpr uint32_t kBothGap = 4, kGaps = 5;
  /// What lies beyond an edge; a PutSide's alone.
  struct Wish {
    uint32_t way = kNothing;
    uint32_t third = kNone;  ///< place
    uint32_t others = 0;     ///< which of the known corners are not the likely vertices
    Corners sources{};
  };
  bool begin_part();
  Gap gap_of(const OpenEdge& edge);
  uint32_t likely_third(const Gap& gap, uint32_t way, uint32_t place) const;
  Wish wish_beyond(const OpenEdge& edge, const Gap& gap);
  void close_gap(const Corners& v, const Gap& gap, uint32_t way);
  bool grow_beyond(const OpenEdge& edge);

  Side& side_;
  Source* source_;
  size_t most_vertices_;
  PlaceCoder<Side> places_;
  std::vector<uint32_t> place_of_;                      ///< by vertex
  std::vector<uint32_t> latest_vertex_, before_there_;  ///< in a place; by vertex
  OpenEdges edges_;
  uint32_t ways_before_ = 0;  ///< the last two
  uint32_t had_others_ = 0;   ///< whether some corner of the last triangle was not the likely vertex
  std::array<NibbleModel, 2 * kGaps * kWays * kWays> way_models_;
  std::array<NibbleModel, 2> corner_models_;  ///< of two known corners, of three
  std::array<BitModel, 3> begin_models_;
  std::array<BitModel, 3> begin_corner_models_;
  NibbleModel rank_model_;
  std::array<NibbleModel, 3> back_models_;  ///< places of a part's first corners, of third corners, vertices
};

/// A triangle that lies beyond no edge.
template <class Side>
bool Grower<Side>::begin_part() {
  Corners wanted{}, v{};
  if (source_ != nullptr) wanted = source_->next_triangle();
  uint32_t like = place_of_.empty() ? kNone : static_cast<uint32_t>(place_of_.size()) - 1;
  for (size_t i = 0; i < 3; ++i) {
    uint32_t place = source_ != nullptr ? source_->grown_place(wanted[i]) : kNone;
    const auto count = static_cast<uint32_t>(places_.count());
    if (side_.tell(begin_models_[i], place == kNone ? 1 : 0) != 0) {
      PlaceKin of;
      if (i > 0) of.known = 1, of.a = place_of_[v[i - 1]];
      place = add_place(of, wanted[i]);
      if (place == kNone) return false;
      v[i] = like = add_vertex(place, one_guess(like), kNone, wanted[i]);
      continue;
    }
    const uint32_t back = tell_number(side_, back_models_[0], count - 1 - place);
    if (back >= count) return false;
    v[i] = latest_vertex_[count - 1 - back];
    const bool other = source_ != nullptr && source_->grown_vertex(wanted[i]) != v[i];
    if (side_.tell(begin_corner_models_[i], other ? 1 : 0) != 0) v[i] = tell_vertex(v[i], like, wanted[i]);
    if (v[i] == kNone) return false;
  }
  indices.insert(indices.end(), v.begin(), v.end());
  for (size_t i = 3; i-- > 0;) edges_.add_or_close({v[i], v[(i + 1) % 3], v[(i + 2) % 3]});
  return true;
}

template <class Side>
typename Grower<Side>::Gap Grower<Side>::gap_of(const OpenEdge& edge) {
  const uint32_t from = place_of_[edge.from], to = place_of_[edge.to];
  Gap gap;
  gap.next = edges_.latest_from(to), gap.before = edges_.latest_to(from);
  if (gap.next != kNone && place_of_[edges_[gap.next].to] != from) gap.ahead = edges_[gap.next].to;
  if (gap.before != kNone && place_of_[edges_[gap.before].from] != to) gap.behind = edges_[gap.before].from;
  const bool is_closed = gap.ahead != kNone && gap.behind != kNone && place_of_[gap.ahead] == place_of_[gap.behind];
  gap.kind = is_closed ? kBothGap : (gap.ahead != kNone ? 1U : 0U) + (gap.behind != kNone ? 2U : 0U);
  return gap;
}

/// The vertex that a known third corner is likely to be. place: of kOther.
template <class Side>
uint32_t Grower<Side>::likely_third(const Gap& gap, uint32_t way, uint32_t place) const {
  return way == kAhead ? gap.ahead : way == kBehind ? gap.behind : way == kOther ? latest_vertex_[place] : kNone;
}

/// What a PutSide tells of an edge.
template <class Side>
typename Grower<Side>::Wish Grower<Side>::wish_beyond(const OpenEdge& edge, const Gap& gap) {
  Wish wish;
  if (source_ == nullptr || !source_->beyond(edge.from, edge.to, wish.sources)) return wish;
  wish.third = source_->grown_place(wish.sources[2]);
  wish.way = wish.third == kNone ? kNew : kOther;
  if (gap.behind != kNone && wish.third == place_of_[gap.behind]) wish.way = kBehind;
  if (gap.ahead != kNone && wish.third == place_of_[gap.ahead]) wish.way = kAhead;
  const Corners likely{edge.to, edge.from, likely_third(gap, wish.way, wish.third)};
  for (size_t i = 0; i < (wish.way == kNew ? 2U : 3U); ++i)
    wish.others |= source_->grown_vertex(wish.sources[i]) != likely[i] ? 1U << i : 0U;
  return wish;
}

/// The two edges of a triangle that grew beyond another one.
template <class Side>
void Grower<Side>::close_gap(const Corners& v, const Gap& gap, uint32_t way) {
  const OpenEdge ahead{v[2], v[0], v[1]}, behind{v[1], v[2], v[0]};
  const bool closes_both = gap.kind == kBothGap && (way == kAhead || way == kBehind);
  if (way == kNew)  // no edge leads to it
    edges_.add(ahead);
  else if (way == kAhead || closes_both)
    edges_.close(gap.next);
  else
    edges_.add_or_close(ahead);
  if (way == kNew)
    edges_.add(behind);
  else if (way == kBehind || closes_both)
    edges_.close(gap.before);
  else
    edges_.add_or_close(behind);
}

template <class Side>
bool Grower<Side>::grow_beyond(const OpenEdge& edge) {
  const Gap gap = gap_of(edge);
  const Wish wish = wish_beyond(edge, gap);
  NibbleModel& model = way_models_[(had_others_ * kGaps + gap.kind) * kWays * kWays + ways_before_];
  const uint32_t told = side_.tell(model, wish.others == 0 ? wish.way : wish.way + kOtherCorners);
  const uint32_t way = told < kWays ? told : told - kOtherCorners;
  if (way >= kWays || (way == kAhead && gap.ahead == kNone) || (way == kBehind && gap.behind == kNone)) return false;
  ways_before_ = ways_before_ % kWays * kWays + way;
  had_others_ = told < kWays ? 0 : 1;
  if (way == kNothing) return true;
  uint32_t place = kNone;
  if (way == kOther) {
    const auto count = static_cast<uint32_t>(places_.count());
    const uint32_t back = tell_number(side_, back_models_[1], count - 1 - wish.third);
    if (back >= count) return false;
    place = count - 1 - back;
  }
  Corners v{edge.to, edge.from, likely_third(gap, way, place)};
  uint32_t like = kNone;
  if (had_others_ != 0) {
    const uint32_t others = side_.tell(corner_models_[way == kNew ? 0 : 1], wish.others);
    for (size_t i = 0; i < (way == kNew ? 2U : 3U); ++i)
      if ((others >> i & 1U) != 0 && (v[i] = tell_vertex(v[i], like, wish.sources[i])) == kNone) return false;
  }
  if (way == kNew) {
    place = add_place({3, place_of_[edge.from], place_of_[edge.to], place_of_[edge.across]}, wish.sources[2]);
    if (place == kNone) return false;
    v[2] =
        add_vertex(place, like != kNone ? one_guess(like) : Guess{v[1], v[0], edge.across, 3}, kNone, wish.sources[2]);
  }
  indices.insert(indices.end(), v.begin(), v.end());
  close_gap(v, gap, way);
  return true;
}

template <class T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<uint32_t>& sources) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(sources.size());
  for (const uint32_t source : sources) out.push_back(values[source]);
  return out;
}

}  // namespace

GrownMesh encode_grown(const QuantizedMesh& mesh) {
  PutSide side;
  Source source(mesh);
  Grower<PutSide> grower(side, mesh, mesh.positions.size(), &source);
  size_t first = 0;
  for (const MaterialRun& run : mesh.runs) {
    source.begin_run(first, run.triangles);
    grower.grow_run(run.triangles);
    first += run.triangles;
  }
  QuantizedMesh grown;
  grown.on_grid = mesh.on_grid;
  grown.indices = std::move(grower.indices);
  grown.positions = grower.positions();
  grown.normals = in_order(mesh.normals, source.sources());
  grown.texcoords = in_order(mesh.texcoords, source.sources());
  grown.colors = in_order(mesh.colors, source.sources());
  if (!grown.normals.empty()) tell_normals(side, grower.kin, grown);
  if (!grown.texcoords.empty()) tell_texcoords(side, grower.kin, grown);
  if (!grown.colors.empty()) tell_colors(side, grower.kin, grown);
  return {side.finish(), static_cast<uint32_t>(grown.positions.size())};
}

Status decode_grown(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                    bool colors, QuantizedMesh& mesh) {
  GetSide side(bytes);
  Grower<GetSide> grower(side, mesh, vertices, nullptr);
  for (const MaterialRun& run : mesh.runs)
    if (!grower.grow_run(run.triangles))
      return Error{fmt::format("mesh: triangle {} of {} does not decode", grower.indices.size() / 3, triangles)};
  if (grower.kin.size() != vertices)
    return Error{fmt::format("mesh: decodes to {} vertices, its header has {}", grower.kin.size(), vertices)};
  mesh.indices = std::move(grower.indices);
  mesh.positions = grower.positions();
  if (normals && !tell_normals(side, grower.kin, mesh)) return Error{"mesh: its normals do not decode"};
  if (texcoords && !tell_texcoords(side, grower.kin, mesh)) return Error{"mesh: its texture coordinates do not decode"};
  if (colors && !tell_colors(side, grower.kin, mesh)) return Error{"mesh: its colours do not decode"};
  if (!side.at_end()) return Error{fmt::format("mesh: its {} bytes do not end with it", bytes.size())};
  return Done{};
}

}  // namespace promenade
