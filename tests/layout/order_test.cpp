#include "layout/order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "layout/order_columns.h"
#include "layout/order_landscape.h"
#include "layout/order_rivals.h"
#include "layout/step_sets.h"

namespace promenade {
namespace {

using testing::ElementsAre;
using Rows = std::vector<std::vector<uint32_t>>;

/// Rows that are runs of a hidden order of the columns.
Incidence hidden_runs(uint32_t columns, uint32_t rows, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<uint32_t> hidden(columns);
  std::iota(hidden.begin(), hidden.end(), 0U);
  for (size_t i = columns; i > 1; --i) std::swap(hidden[i - 1], hidden[random() % i]);
  Rows sets(rows);
  for (std::vector<uint32_t>& row : sets) {
    const auto begin = static_cast<uint32_t>(random() % columns);
    const uint32_t end = std::min(columns, begin + 2 + static_cast<uint32_t>(random() % 20));
    row.assign(hidden.begin() + begin, hidden.begin() + end);
    std::sort(row.begin(), row.end());
  }
  return incidence_of(sets, columns);
}

/// Runs by looking at every place of every row.
uint64_t slow_runs(const Rows& rows, const ColumnOrder& order) {
  uint64_t runs = 0;
  for (const std::vector<uint32_t>& row : rows)
    for (size_t i = 0; i < order.size(); ++i) {
      const auto has = [&](size_t k) { return std::binary_search(row.begin(), row.end(), order[k]); };
      runs += has(i) && (i == 0 || !has(i - 1)) ? 1U : 0U;
    }
  return runs;
}

TEST(Incidence, counts_runs_as_rows_have_them) {
  const Rows rows = {{0, 1, 2}, {0, 2, 4}, {}, {3}};
  const Incidence matrix = incidence_of(rows, 5);
  EXPECT_EQ(matrix.columns(), 5U);
  EXPECT_THAT(matrix.column(2), ElementsAre(0, 1));
  ColumnOrder order = {0, 1, 2, 3, 4};
  do EXPECT_EQ(count_runs(matrix, order), slow_runs(rows, order));
  while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(count_runs(Incidence(), {}), 0U);
}

TEST(Incidence, distance_is_the_number_of_rows_that_differ) {
  EXPECT_EQ(hamming_distance(std::vector<uint32_t>{}, std::vector<uint32_t>{}), 0U);
  EXPECT_EQ(hamming_distance(std::vector<uint32_t>{1, 5}, std::vector<uint32_t>{}), 2U);
  EXPECT_EQ(hamming_distance(std::vector<uint32_t>{1, 5, 9}, std::vector<uint32_t>{2, 5}), 3U);
}

TEST(Incidence, orders_of_ones_own_are_read) {
  EXPECT_EQ(*parse_order("2\n0\n1\n", 3), (ColumnOrder{2, 0, 1}));
  EXPECT_EQ(*parse_order("2\n0\n1", 3), (ColumnOrder{2, 0, 1}));
  EXPECT_FALSE(parse_order("", 3).ok());
  EXPECT_FALSE(parse_order("0\n0\n1\n", 3).ok());
  EXPECT_FALSE(parse_order("0\n1\n2\n2\n", 3).ok());
  EXPECT_FALSE(parse_order("0\n1\n3\n", 3).ok());
  EXPECT_FALSE(parse_order("0\n-1\n2\n", 3).ok());
  EXPECT_FALSE(parse_order("0\n1 \n2\n", 3).ok());
  EXPECT_FALSE(parse_order("0\n99999999999\n2\n", 3).ok());
}

TEST(Orders, are_permutations) {
  const Incidence matrix = hidden_runs(300, 400, 1);
  std::vector<glm::vec3> points(300);
  for (size_t i = 0; i < points.size(); ++i) points[i] = {float(i % 7), float(i % 11), float(i % 3)};
  for (const std::string_view name : order_names()) {
    const MadeOrder made = make_order(name, {&matrix, points});
    EXPECT_TRUE(is_permutation_of(made.order, 300)) << name;
    EXPECT_EQ(made.runs, count_runs(matrix, made.order)) << name;
  }
}

TEST(Orders, of_few_columns_or_rows_are_permutations) {
  for (uint32_t columns = 0; columns < 12; ++columns)
    for (const uint32_t rows : {0U, 1U, 5U}) {
      const Incidence matrix = columns == 0 ? incidence_of(Rows(rows), 0) : hidden_runs(columns, rows, columns);
      const std::vector<glm::vec3> points(columns);
      for (const std::string_view name : order_names())
        EXPECT_TRUE(is_permutation_of(make_order(name, {&matrix, points}).order, columns)) << name << ' ' << columns;
    }
}

TEST(Tour, finds_a_hidden_order) {
  for (const uint32_t seed : {1U, 2U, 3U}) {
    const Incidence matrix = hidden_runs(500, 2000, seed);
    const uint64_t input = make_order("input", {&matrix, {}}).runs;
    const uint64_t bound = lower_bound_of_runs(matrix);
    EXPECT_GT(bound, 1900U);
    for (const std::string_view name : {"greedy-tour", "tour"}) {
      const MadeOrder tour = make_order(name, {&matrix, {}});
      EXPECT_LT(tour.runs, 2050U) << name << ": the best has a run a row: 2000";
      EXPECT_GT(input, 6 * tour.runs) << name;
      EXPECT_LE(bound, tour.runs) << name;
    }
  }
}

TEST(Tour, is_the_same_on_any_number_of_threads) {
  const Incidence matrix = hidden_runs(3000, 4000, 4);
  const auto with_threads = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    ColumnOrder both = tour_order(matrix, TourOptions());
    const ColumnOrder published = tour_order(matrix, TourOptions(TourSeed::greedy));
    both.insert(both.end(), published.begin(), published.end());
    return both;
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(Neighbours, of_parts_are_those_found_at_once) {
  const Incidence matrix = hidden_runs(700, 900, 6);
  std::vector<uint32_t> among(700);
  std::iota(among.begin(), among.end(), 0U);
  const NeighbourOptions options;
  std::vector<NeighbourLists> parts;
  for (uint32_t round = 0; round < options.rounds; ++round)
    parts.push_back(near_columns_of_round(matrix, among, options, round));
  std::reverse(parts.begin(), parts.end());
  const NeighbourLists at_once = near_columns(matrix, among, options);
  const NeighbourLists together = near_columns_of_parts(matrix, among, options, parts);
  EXPECT_EQ(together.first, at_once.first);
  EXPECT_EQ(together.all, at_once.all);
  EXPECT_NE(parts[0].all, at_once.all) << "or one round would do";
}

TEST(Tour, is_the_better_of_two_and_bisections_when_they_are_about_as_good) {
  const auto runs_from = [](const Incidence& matrix, TourSeed seed) {
    return count_runs(matrix, tour_order(matrix, TourOptions(seed)));
  };
  int greedy_won = 0, bisection_won = 0;
  for (const Incidence& matrix : {hidden_runs(500, 2000, 1), hidden_runs(500, 2000, 2), hidden_runs(500, 2000, 3),
                                  hidden_runs(600, 300, 4), landscape_steps(1000)}) {
    const uint64_t greedy = runs_from(matrix, TourSeed::greedy), bisection = runs_from(matrix, TourSeed::bisection);
    const bool worth = double(bisection) <= 1.03 * double(greedy);
    ++(worth ? bisection_won : greedy_won);
    EXPECT_EQ(runs_from(matrix, TourSeed::best), worth ? bisection : greedy);
  }
  EXPECT_GT(greedy_won, 0);
  EXPECT_GT(bisection_won, 0);
}

TEST(Tour, says_what_its_source_of_neighbours_could_not_do) {
  const Incidence matrix = hidden_runs(50, 60, 7);
  const auto broken = [](std::span<const uint32_t>, const NeighbourOptions&) {
    return Result<NeighbourLists>(Error{"no disk"});
  };
  const Result<ColumnOrder> order = tour_order(matrix, TourOptions(), broken);
  ASSERT_FALSE(order.ok());
  EXPECT_EQ(order.error().message, "no disk");
}

TEST(Landscape, has_sound_columns_of_any_number) {
  for (const uint32_t columns : {0U, 1U, 2U, 21U, 500U, 3000U}) {
    const Incidence matrix = landscape_steps(columns);
    ASSERT_EQ(matrix.columns(), columns);
    for (uint32_t i = 0; i < columns; ++i) {
      const std::span<const uint32_t> ones = matrix.column(i);
      EXPECT_TRUE(std::is_sorted(ones.begin(), ones.end()));
      EXPECT_EQ(std::adjacent_find(ones.begin(), ones.end()), ones.end());
      EXPECT_TRUE(ones.empty() || ones.back() < matrix.rows);
    }
  }
  EXPECT_EQ(landscape_steps(3000).ones, landscape_steps(3000).ones);
  EXPECT_GT(distinct_columns(landscape_steps(3000)).first.size(), 1500U) << "most nodes are unlike any other";
}

TEST(StepRows, have_what_enters_either_way) {
  const Rows vlods = {{1, 4, 7}, {1, 5, 6}, {}};
  const std::vector<CellFace> faces = {{CellId{0}, CellId{1}, 0, 0, 0}, {CellId{2}, CellId{0}, 1, 0, 0}};
  const Rows rows = step_rows(vlods, faces);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_THAT(rows[0], ElementsAre(5, 6));
  EXPECT_THAT(rows[1], ElementsAre(4, 7));
  EXPECT_THAT(rows[2], ElementsAre(1, 4, 7));
  EXPECT_THAT(rows[3], ElementsAre());
}

TEST(Tour, never_gets_longer_while_it_is_improved) {
  TourFigures figures;
  const Incidence matrix = hidden_runs(2000, 1500, 5);
  tour_order(matrix, TourOptions(), &figures);
  EXPECT_LE(figures.runs_after_pass_1, figures.runs_of_seed);
  EXPECT_LE(figures.runs, figures.runs_after_pass_1);
}

TEST(Tour, keeps_equal_columns_together) {
  const Incidence matrix = incidence_of(Rows{{0, 3, 5}, {0, 3, 5}, {1, 2, 4}}, 6);
  EXPECT_EQ(make_order("tour", {&matrix, {}}).runs, 3U);
}

TEST(LowerBound, is_below_the_best_of_all_orders) {
  for (uint32_t seed = 1; seed < 12; ++seed) {
    const Incidence matrix = hidden_runs(7, 9, seed);
    ColumnOrder order = {0, 1, 2, 3, 4, 5, 6};
    uint64_t best = ~uint64_t(0);
    do best = std::min(best, count_runs(matrix, order));
    while (std::next_permutation(order.begin(), order.end()));
    EXPECT_LE(lower_bound_of_runs(matrix), best);
    EXPECT_GE(make_order("tour", {&matrix, {}}).runs, best);
  }
}

TEST(Hilbert, goes_from_neighbour_to_neighbour) {
  std::vector<glm::vec3> points;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) points.emplace_back(x, y, z);
  const ColumnOrder order = hilbert_order(points);
  for (size_t i = 1; i < order.size(); ++i) {
    const glm::vec3 step = points[order[i]] - points[order[i - 1]];
    EXPECT_EQ(step.x * step.x + step.y * step.y + step.z * step.z, 1.0F) << "place " << i;
  }
}

TEST(Morton, goes_through_an_octant_before_the_next) {
  std::vector<glm::vec3> points;
  points.reserve(64);
  for (int i = 0; i < 64; ++i) points.emplace_back(i / 16, i / 4 % 4, i % 4);
  const ColumnOrder order = morton_order(points);
  for (size_t i = 0; i < 8; ++i)
    EXPECT_TRUE(points[order[i]].x < 2 && points[order[i]].y < 2 && points[order[i]].z < 2);
}

TEST(BestOrder, is_the_first_with_fewest_runs) {
  const std::vector<MadeOrder> orders = {{"input", {}, 9, 0}, {"tour", {}, 4, 0}, {"other", {}, 4, 0}};
  EXPECT_EQ(best_of(orders).name, "tour");
}

}  // namespace
}  // namespace promenade
