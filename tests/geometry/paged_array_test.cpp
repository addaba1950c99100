#include "geometry/paged_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace promenade {
namespace {

TEST(PagedArray, holds_what_a_vector_holds_however_it_grows) {
  PagedArray<uint64_t> paged;
  std::vector<uint64_t> plain;
  EXPECT_TRUE(paged.empty());
  for (uint64_t i = 0; i < 300'000; ++i) {
    paged.push_back(i * i);
    plain.push_back(i * i);
  }
  paged.append(plain);
  plain.insert(plain.end(), plain.begin(), plain.end());
  EXPECT_TRUE(std::equal(paged.begin(), paged.end(), plain.begin(), plain.end()));
  paged.push_back(paged[7]);
  EXPECT_EQ(paged.back(), 49U);
  paged.pop_back();
  paged.resize(5);
  EXPECT_EQ(std::accumulate(paged.begin(), paged.end(), uint64_t(0)), 30U);
  paged.clear();
  EXPECT_EQ(paged.size(), 0U);
}

TEST(PagedArray, grows_by_a_value_of_its_own) {
  PagedArray<uint32_t> paged;
  paged.push_back(5);
  for (size_t i = 0; i < 200'000; ++i) paged.push_back(paged[0]);  // now and then it moves
  for (const uint32_t value : paged) ASSERT_EQ(value, 5U);
}

TEST(PagedArray, moves_and_leaves_nothing_behind) {
  struct Odd {
    uint8_t bytes[13];
  };
  PagedArray<Odd> from;
  for (uint8_t i = 0; i < 200; ++i) from.push_back({{i}});
  PagedArray<Odd> to(std::move(from));
  EXPECT_EQ(to.size(), 200U);
  EXPECT_EQ(to[199].bytes[0], 199);
  PagedArray<Odd> last;
  last = std::move(to);
  EXPECT_EQ(last.size(), 200U);
  last.release();
  EXPECT_TRUE(last.empty());
  last.push_back({{3}});
  EXPECT_EQ(last[0].bytes[0], 3);
}

TEST(PagedArray, equals_what_holds_the_same) {
  PagedArray<int> a, b;
  EXPECT_EQ(a, b);
  a.push_back(1);
  EXPECT_FALSE(a == b);
  b.push_back(1);
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace promenade
