// The tour goes through every kind of column and once through an empty column, which is where the order begins and
// ends: so its length is twice the number of runs.
#include "layout/order_tour.h"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "layout/order_columns.h"
#include "layout/order_rivals.h"

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kNobody = ~0U;
/// Columns that a step of 2-opt may turn round. More make shorter tours in far more time; long turns take apart what
/// bisection keeps together.
constexpr uint64_t kLongestTurn = 25000, kLongestTurnOfBisection = 512;
/// So many times the runs of a greedy tour are worth what is read along a path being near each other.
constexpr double kWorthOfBisection = 1.03;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Kinds of columns as cities. The last city is the empty column.
class Cities {
 public:
  Cities(const Incidence& matrix, std::span<const uint32_t> columns) : matrix_(matrix), columns_(columns) {}
  uint32_t size() const { return static_cast<uint32_t>(columns_.size()) + 1; }
  std::span<const uint32_t> column(uint32_t city) const {
    return city + 1 == size() ? std::span<const uint32_t>() : matrix_.column(columns_[city]);
  }
  int64_t distance(uint32_t a, uint32_t b) const { return hamming_distance(column(a), column(b)); }

 private:
  const Incidence& matrix_;
  std::span<const uint32_t> columns_;
};

/// Paths that grow together into one: each city has up to two neighbours, and no circle closes.
class Paths {
 public:
  explicit Paths(uint32_t cities) : links_(2 * size_t(cities), kNobody), other_end_(cities), left_(cities - 1) {
    std::iota(other_end_.begin(), other_end_.end(), 0U);
  }
  bool is_end(uint32_t city) const { return links_[2 * size_t(city) + 1] == kNobody; }
  /// Of the path that ends with the city.
  uint32_t other_end(uint32_t city) const { return other_end_[city]; }
  bool join(uint32_t a, uint32_t b) {
    if (a == b || !is_end(a) || !is_end(b) || other_end_[a] == b) return false;
    const uint32_t end_a = other_end_[a], end_b = other_end_[b];
    other_end_[end_a] = end_b, other_end_[end_b] = end_a;
    link(a, b), link(b, a);
    --left_;
    return true;
  }
  bool done() const { return left_ == 0; }

  /// The cities along the path from the one given, which is an end of the only path.
  std::vector<uint32_t> walk_from(uint32_t city) const {
    std::vector<uint32_t> tour;
    for (uint32_t before = kNobody; city != kNobody;) {
      tour.push_back(city);
      const uint32_t a = links_[2 * size_t(city)], b = links_[2 * size_t(city) + 1];
      const uint32_t next = a != before ? a : b;
      before = city, city = next;
    }
    return tour;
  }

 private:
  void link(uint32_t from, uint32_t to) {
    const size_t at = 2 * size_t(from);
    links_[links_[at] == kNobody ? at : at + 1] = to;
  }
  std::vector<uint32_t> links_;
  std::vector<uint32_t> other_end_;  ///< of cities that are ends
  uint32_t left_;
};

struct Edge {
  uint32_t distance, a, b;
  auto operator<=>(const Edge&) const = default;
};

void join_shortest_first(std::vector<Edge>& edges, Paths& paths) {
  std::sort(edges.begin(), edges.end());
  for (const Edge& edge : edges) paths.join(edge.a, edge.b);
}

/// Shortest edges first; then the ends of the paths look for other ends near them, farther each time. Ends that find
/// nobody are joined in the order of the input.
std::vector<uint32_t> greedy_tour(const Incidence& matrix, std::span<const uint32_t> columns, const Cities& cities,
                                  const NeighbourLists& near, const NeighbourOptions& options) {
  const auto count = static_cast<uint32_t>(columns.size());
  Paths paths(cities.size());
  std::vector<Edge> edges;
  for (uint32_t i = 0; i < count; ++i)
    for (const Neighbour& n : near.of(i))
      if (i < n.column ||
          !std::binary_search(near.of(n.column).begin(), near.of(n.column).end(), Neighbour{n.distance, i}))
        edges.push_back({n.distance, i, n.column});
  join_shortest_first(edges, paths);
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds && !paths.done(); ++round) {
    std::vector<uint32_t> ends, end_columns;
    for (uint32_t i = 0; i < count; ++i)
      if (paths.is_end(i)) ends.push_back(i), end_columns.push_back(columns[i]);
    NeighbourOptions wider = options;
    wider.refinements = 0;
    const NeighbourLists lists = near_columns(matrix, end_columns, wider);
    edges.clear();
    for (uint32_t i = 0; i < ends.size(); ++i)
      for (const Neighbour& n : lists.of(i)) edges.push_back({n.distance, ends[i], ends[n.column]});
    join_shortest_first(edges, paths);
  }
  // What is left, in the order of the input, behind the empty column.
  const uint32_t empty = cities.size() - 1;
  uint32_t last = empty;
  for (uint32_t i = 0; i < count; ++i) {
    if (!paths.is_end(i)) continue;
    const uint32_t end = paths.other_end(i);
    if (paths.join(last, i)) last = end;
  }
  return paths.walk_from(empty);
}

/// A tour as an array, changed by turning parts of it round.
class Tour {
 public:
  Tour(std::vector<uint32_t> cities, uint64_t longest_turn)
      : at_(std::move(cities)), place_(at_.size()), longest_turn_(longest_turn) {
    for (size_t i = 0; i < at_.size(); ++i) place_[at_[i]] = static_cast<uint32_t>(i);
  }
  uint32_t size() const { return static_cast<uint32_t>(at_.size()); }
  uint32_t next(uint32_t city) const { return at_[place_[city] + 1 == size() ? 0 : place_[city] + 1]; }
  uint32_t before(uint32_t city) const { return at_[place_[city] == 0 ? size() - 1 : place_[city] - 1]; }
  uint32_t place(uint32_t city) const { return place_[city]; }
  const std::vector<uint32_t>& cities() const { return at_; }

  /// Turns the part from `first` to `last` (following next) round, or all the others, whichever is less. False: too
  /// long.
  bool turn(uint32_t first, uint32_t last) {
    uint32_t i = place_[first], k = place_[last];
    uint32_t inside = (k + size() - i) % size() + 1;
    if (2 * inside > size()) {
      const uint32_t outer_first = k + 1 == size() ? 0 : k + 1, outer_last = i == 0 ? size() - 1 : i - 1;
      i = outer_first, k = outer_last;
      inside = size() - inside;
    }
    if (inside > longest_turn_) return false;
    for (uint32_t swaps = inside / 2; swaps > 0; --swaps) {
      std::swap(at_[i], at_[k]);
      place_[at_[i]] = i, place_[at_[k]] = k;
      i = i + 1 == size() ? 0 : i + 1;
      k = k == 0 ? size() - 1 : k - 1;
    }
    return true;
  }

 private:
  std::vector<uint32_t> at_;     ///< by place
  std::vector<uint32_t> place_;  ///< by city
  uint64_t longest_turn_;
};

/// 2-opt and Or-opt steps that shorten the tour, near neighbours first.
class Improver {
 public:
  Improver(const Cities& cities, const NeighbourLists& near, Tour& tour) : cities_(cities), near_(near), tour_(tour) {}

  /// Goes through all cities that may gain since the last time; how many steps were taken.
  uint64_t pass() {
    if (awake_.empty()) awake_.assign(tour_.size(), 1);
    uint64_t steps = 0;
    const std::vector<uint32_t> cities = tour_.cities();
    for (const uint32_t city : cities) {
      if (awake_[city] == 0 || city + 1 == tour_.size()) continue;
      awake_[city] = 0;
      while (improve(city)) ++steps;
    }
    return steps;
  }

 private:
  bool improve(uint32_t city) { return two_opt_forwards(city) || two_opt_backwards(city) || move_segment(city); }

  void wake(std::initializer_list<uint32_t> cities) {
    for (const uint32_t city : cities) awake_[city] = 1;
  }

  /// (city, next) and (other, next of it) become (city, other) and (next, next of other).
  bool two_opt_forwards(uint32_t city) {
    const uint32_t next = tour_.next(city);
    const int64_t length = cities_.distance(city, next);
    for (const Neighbour& n : near_.of(city)) {
      if (n.distance >= length) return false;
      const uint32_t other = n.column, other_next = tour_.next(other);
      const int64_t gain =
          length + cities_.distance(other, other_next) - n.distance - cities_.distance(next, other_next);
      if (gain <= 0 || !tour_.turn(next, other)) continue;
      wake({city, next, other, other_next});
      return true;
    }
    return false;
  }

  /// (before, city) and (before the other, other) become (other, city) and (before the other, before).
  bool two_opt_backwards(uint32_t city) {
    const uint32_t before = tour_.before(city);
    const int64_t length = cities_.distance(before, city);
    for (const Neighbour& n : near_.of(city)) {
      if (n.distance >= length) return false;
      const uint32_t other = n.column, other_before = tour_.before(other);
      const int64_t gain =
          length + cities_.distance(other_before, other) - n.distance - cities_.distance(other_before, before);
      if (gain <= 0 || !tour_.turn(city, other_before)) continue;
      wake({city, before, other, other_before});
      return true;
    }
    return false;
  }

  /// Or-opt: one to three cities that begin or end with this one go between another and one beside it.
  bool move_segment(uint32_t city) {
    constexpr uint32_t kMostCities = 3;
    for (uint32_t count = 1; count <= kMostCities && count + 3 < tour_.size(); ++count)
      for (const bool forwards : {true, false})
        if (move_segment(city, count, forwards)) return true;
    return false;
  }

  /// The segment begins with city and goes forwards, or backwards. City comes to stand beside a near one.
  bool move_segment(uint32_t city, uint32_t count, bool forwards) {
    uint32_t last = city;
    for (uint32_t i = 1; i < count; ++i) last = forwards ? tour_.next(last) : tour_.before(last);
    const uint32_t first_place = forwards ? city : last, last_place = forwards ? last : city;
    const uint32_t before = tour_.before(first_place), after = tour_.next(last_place);
    const int64_t removed =
        cities_.distance(before, first_place) + cities_.distance(last_place, after) - cities_.distance(before, after);
    if (removed <= 0) return false;
    for (const Neighbour& n : near_.of(city)) {
      if (n.distance >= removed) return false;
      const uint32_t other = n.column;
      const uint32_t offset = (tour_.place(other) + tour_.size() - tour_.place(first_place)) % tour_.size();
      if (offset < count) continue;  // in the segment
      for (const bool behind : {true, false}) {
        const uint32_t beside = behind ? tour_.next(other) : tour_.before(other);
        if (beside == first_place || beside == last_place) continue;
        const int64_t gain = removed + cities_.distance(other, beside) - n.distance - cities_.distance(last, beside);
        if (gain <= 0 || !carry(first_place, last_place, other, beside, behind)) continue;
        wake({before, after, city, last, other, beside});
        // What neighbours the segment has in its new place decides which way round it goes.
        if (tour_.next(other) != city && tour_.before(other) != city)
          tour_.turn(first_place_of(city, last), last_place_of(city, last));
        return true;
      }
    }
    return false;
  }

  bool follows(uint32_t city, uint32_t last) const {
    uint32_t at = city;
    for (int i = 0; i < 3 && at != last; ++i) at = tour_.next(at);
    return at == last;
  }
  uint32_t first_place_of(uint32_t city, uint32_t last) const { return follows(city, last) ? city : last; }
  uint32_t last_place_of(uint32_t city, uint32_t last) const { return follows(city, last) ? last : city; }

  /// Moves the segment between two cities that stand beside each other, by turning what lies between and the segment.
  bool carry(uint32_t first, uint32_t last, uint32_t other, uint32_t beside, bool behind) {
    const uint32_t left = behind ? other : beside, right = behind ? beside : other;  // left before right
    const uint32_t before = tour_.before(first), after = tour_.next(last);
    const uint32_t size = tour_.size();
    const uint32_t ahead = (tour_.place(left) + size - tour_.place(last)) % size;
    const uint32_t count = (tour_.place(last) + size - tour_.place(first)) % size + 1;
    // Parts of more than half would be turned by turning the rest, and what is next would become what is before.
    if (2 * (ahead + count) <= size) {
      // segment, after ... left: all turned gives left ... after, segment; then the former turned back.
      if (!tour_.turn(first, left)) return false;
      return tour_.turn(left, after);
    }
    // right ... before, segment
    if (2 * ahead < size || !tour_.turn(right, last)) return false;
    return tour_.turn(before, right);
  }

  const Cities& cities_;
  const NeighbourLists& near_;
  Tour& tour_;
  std::vector<uint8_t> awake_;
};

/// Kinds in the order of their first columns, the empty column first.
std::vector<uint32_t> tour_along(const ColumnOrder& order, std::span<const uint32_t> first_columns) {
  std::vector<uint32_t> place(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  std::vector<uint32_t> tour(first_columns.size());
  std::iota(tour.begin(), tour.end(), 0U);
  std::sort(tour.begin(), tour.end(),
            [&](uint32_t a, uint32_t b) { return place[first_columns[a]] < place[first_columns[b]]; });
  tour.insert(tour.begin(), static_cast<uint32_t>(first_columns.size()));
  return tour;
}

/// The kinds in order, from behind the empty column on.
std::vector<uint32_t> kinds_of(const Tour& tour) {
  std::vector<uint32_t> kinds = tour.cities();
  const auto empty = std::find(kinds.begin(), kinds.end(), tour.size() - 1);
  std::rotate(kinds.begin(), empty, kinds.end());
  kinds.erase(kinds.begin());
  return kinds;
}

struct MadeTour {
  ColumnOrder order;
  TourFigures figures;
};

/// seed: greedy or bisection.
MadeTour improved_tour(const Incidence& matrix, const DistinctColumns& distinct, const Cities& cities,
                       const NeighbourLists& near, const TourOptions& options, TourSeed seed) {
  MadeTour made;
  TourFigures& f = made.figures;
  f.distinct_columns = distinct.first.size();
  auto start = Clock::now();
  const bool greedy = seed == TourSeed::greedy;
  Tour tour(greedy ? greedy_tour(matrix, distinct.first, cities, near, options.neighbours)
                   : tour_along(bisection_order(matrix), distinct.first),
            greedy ? kLongestTurn : kLongestTurnOfBisection);
  f.seed_s = seconds_since(start);
  f.runs_of_seed = count_runs(matrix, spread(distinct, kinds_of(tour)));
  start = Clock::now();
  Improver improver(cities, near, tour);
  for (f.passes = 0; f.passes < options.passes;) {
    const uint64_t steps = improver.pass();
    if (++f.passes == 1) f.runs_after_pass_1 = count_runs(matrix, spread(distinct, kinds_of(tour)));
    if (steps == 0) break;
  }
  f.improve_s = seconds_since(start);
  made.order = spread(distinct, kinds_of(tour));
  f.runs = count_runs(matrix, made.order);
  return made;
}

}  // namespace

Result<ColumnOrder> tour_order(const Incidence& matrix, const TourOptions& options, const NearSource& near_source,
                               TourFigures* figures) {
  const DistinctColumns distinct = distinct_columns(matrix);
  const auto start = Clock::now();
  const Result<NeighbourLists> near = near_source(distinct.first, options.neighbours);
  if (!near) return near.error();
  const double neighbours_s = seconds_since(start);
  const Cities cities(matrix, distinct.first);
  const auto tour_from = [&](TourSeed seed) {
    MadeTour made = improved_tour(matrix, distinct, cities, *near, options, seed);
    made.figures.neighbours_s = neighbours_s;
    return made;
  };
  MadeTour made = tour_from(options.seed == TourSeed::greedy ? TourSeed::greedy : TourSeed::bisection);
  if (options.seed == TourSeed::best) {
    MadeTour greedy = tour_from(TourSeed::greedy);
    if (double(made.figures.runs) > kWorthOfBisection * double(greedy.figures.runs)) made = std::move(greedy);
  }
  if (figures != nullptr) *figures = made.figures;
  return std::move(made.order);
}

ColumnOrder tour_order(const Incidence& matrix, const TourOptions& options, TourFigures* figures) {
  const auto at_once = [&matrix](std::span<const uint32_t> among, const NeighbourOptions& near) {
    return Result<NeighbourLists>(near_columns(matrix, among, near));
  };
  return *tour_order(matrix, options, at_once, figures);
}

}  // namespace promenade
