#include "preprocess/visibility/columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "geometry/random.h"
#include "preprocess/visibility/slip_map.h"
#include "tests/preprocess/situations.h"

namespace promenade {
namespace {

ColumnGrid small_grid() {
  ColumnGrid grid;
  grid.low = {-2, -2};
  grid.column_m = 0.2;
  grid.nx = 120, grid.ny = 150;
  return grid;
}

/// Blocks of all sizes, in all places, some of them outside the grid, and as many triangles without any order.
Mesh heap_of_blocks(uint32_t count) {
  Random random(3);
  const auto between = [&](float low, float high) {
    return low + (high - low) * float(random.below(1U << 20)) / float(1U << 20);
  };
  const auto place = [&] {
    const float x = between(-4, 24), y = between(-4, 30), z = between(0, 40);
    return glm::vec3(x, y, z);
  };
  Mesh mesh;
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 low = place(), size = (place() + 5.0F) * (i % 50 == 0 ? 0.3F : 0.04F);
    append(mesh, block(low, low + size));
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t k = 0; k < 3; ++k) {
      mesh.positions.push_back(low + 0.1F * place());
      mesh.indices.push_back(first + k);
    }
  }
  return mesh;
}

SolidColumns solid_of(const Mesh& mesh, size_t most_triangles) {
  ColumnOptions options;
  options.spans = true;
  options.most_triangles = most_triangles;
  ColumnBuilder builder(small_grid(), options);
  builder.add(mesh, {});
  return *builder.finish();
}

TEST(Columns, are_the_same_however_few_triangles_are_held) {
  const Mesh mesh = heap_of_blocks(400);
  const SolidColumns all = solid_of(mesh, 5000);
  EXPECT_GT(all.spans.size(), 1000U) << "else the test says little";
  for (const size_t held : {1U, 10U, 999U}) {
    const SolidColumns few = solid_of(mesh, held);
    EXPECT_EQ(few.base_m, all.base_m);
    EXPECT_EQ(few.top_m, all.top_m);
    EXPECT_EQ(few.slips.size(), all.slips.size());
    EXPECT_TRUE(std::equal(few.spans.begin(), few.spans.end(), all.spans.begin(), all.spans.end(),
                           [](const SolidColumns::Span& a, const SolidColumns::Span& b) {
                             return a.column == b.column && a.base_m == b.base_m && a.top_m == b.top_m;
                           }));
  }
}

TEST(Columns, say_when_they_take_too_much) {
  const Mesh mesh = heap_of_blocks(400);
  for (const size_t held : {100U, 5000U}) {
    ColumnOptions options;
    options.most_triangles = held;
    const auto fits = [&](uint64_t bytes) {
      options.most_bytes = bytes;
      ColumnBuilder builder(small_grid(), options);
      builder.add(mesh, {});
      return builder.finish().has_value();
    };
    EXPECT_FALSE(fits(uint64_t(500) << 10));
    EXPECT_TRUE(fits(uint64_t(100) << 20));
  }
}

TEST(SlipMap, finds_what_is_in_a_rectangle) {
  constexpr uint32_t kX = 70, kY = 45;
  SlipMap map(kX, kY);
  Random random(5);
  std::vector<uint8_t> filled(size_t(kX) * kY, 0);
  for (int i = 0; i < 60; ++i) {
    const uint32_t x = random.below(kX), y = random.below(kY);
    map.add(2, x, y);
    filled[size_t(y) * kX + x] = 1;
  }
  map.complete();
  size_t none = 0, some = 0;
  for (int i = 0; i < 4000; ++i) {
    const uint32_t x0 = random.below(kX), y0 = random.below(kY);
    const uint32_t x1 = std::min(kX, x0 + 1 + random.below(12)), y1 = std::min(kY, y0 + 1 + random.below(12));
    bool empty = true;
    for (uint32_t y = y0; y < y1; ++y)
      for (uint32_t x = x0; x < x1; ++x) empty &= filled[size_t(y) * kX + x] == 0;
    const bool surely_none = map.surely_none(2, x0, y0, x1, y1);
    const bool is_small = x1 - x0 <= 8 && y1 - y0 <= 8;
    EXPECT_TRUE(is_small ? surely_none == empty : empty || !surely_none);
    (empty ? none : some) += 1;
    EXPECT_TRUE(map.surely_none(1, x0, y0, x1, y1)) << "nothing is there that way";
  }
  EXPECT_GT(std::min(none, some), 200U) << "else the test says little";
}

}  // namespace
}  // namespace promenade
