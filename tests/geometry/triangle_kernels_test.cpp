#include "geometry/triangle_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace promenade {
namespace {

/// Triangles of all kinds: fat, slivers, segments, points, far from zero.
TriangleCorners random_corners(std::mt19937& random) {
  std::uniform_real_distribution<float> in_cube(-1, 1);
  TriangleCorners corners{};
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const float size = std::exp2(10 * in_cube(random)), far = random() % 4 == 0 ? 1000.0F : 0.0F;
    for (size_t corner = 0; corner < 3; ++corner)
      for (size_t axis = 0; axis < 3; ++axis) corners.at[corner][axis][lane] = far + size * in_cube(random);
    if (random() % 4 != 0) continue;
    const size_t from = random() % 3, to = random() % 3;  // two corners in one place, or all three
    for (size_t axis = 0; axis < 3; ++axis) {
      corners.at[to][axis][lane] = corners.at[from][axis][lane];
      if (random() % 4 == 0) corners.at[0][axis][lane] = corners.at[1][axis][lane] = corners.at[2][axis][lane];
    }
  }
  return corners;
}

TEST(TriangleKernels, give_the_same_bits_with_either_vectors) {
  if (__builtin_cpu_supports("avx2") == 0) GTEST_SKIP() << "this processor has no AVX2";
  const TriangleKernels &one = portable_triangle_kernels(), &other = avx2_triangle_kernels();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> in_cube(-50, 50);
  for (int round = 0; round < 2000; ++round) {
    const TriangleCorners corners[2] = {random_corners(random), random_corners(random)};
    TriangleFrames frames[2] = {}, same[2] = {};
    one.make_frames(corners, 2, frames);
    other.make_frames(corners, 2, same);
    ASSERT_EQ(std::memcmp(frames, same, sizeof frames), 0);
    const float point[3] = {in_cube(random), in_cube(random), in_cube(random)};
    alignas(32) float d2[kLanes] = {}, same_d2[kLanes] = {};
    one.distances(frames[0], point, d2);
    other.distances(frames[0], point, same_d2);
    ASSERT_EQ(std::memcmp(d2, same_d2, sizeof d2), 0);
    float least2 = 0, same_least2 = 0;
    ASSERT_EQ(one.nearest(frames, 2, point, least2), other.nearest(frames, 2, point, same_least2));
    ASSERT_EQ(std::bit_cast<uint32_t>(least2), std::bit_cast<uint32_t>(same_least2));
  }
}

TEST(TriangleKernels, give_points_the_same_bits_one_by_one_and_eight_at_once) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> in_cube(-50, 50);
  std::vector<const TriangleKernels*> all = {&portable_triangle_kernels()};
  if (__builtin_cpu_supports("avx2") != 0) all.push_back(&avx2_triangle_kernels());
  for (int round = 0; round < 500; ++round) {
    const TriangleCorners corners = random_corners(random);
    TriangleFrames frames{};
    portable_triangle_kernels().make_frames(&corners, 1, &frames);
    PointLanes points{};
    for (size_t i = 0; i < kLanes; ++i)
      points.x[i] = in_cube(random), points.y[i] = in_cube(random), points.z[i] = in_cube(random);
    for (const TriangleKernels* kernels : all)
      for (size_t triangle = 0; triangle < kLanes; ++triangle) {
        alignas(32) float at_once[kLanes] = {}, of_triangles[kLanes] = {};
        kernels->distances_of(frames, triangle, points, at_once);
        for (size_t i = 0; i < kLanes; ++i) {
          const float point[3] = {points.x[i], points.y[i], points.z[i]};
          kernels->distances(frames, point, of_triangles);
          ASSERT_EQ(std::bit_cast<uint32_t>(at_once[i]), std::bit_cast<uint32_t>(of_triangles[triangle]));
        }
      }
  }
}

TEST(TriangleKernels, take_the_first_of_the_nearest_and_pass_by_what_is_no_number) {
  TriangleCorners corners{};
  for (size_t lane = 0; lane < kLanes; ++lane) {  // squares' halves over the origin, at heights 7, 6, ... 2, 2, 2
    const float height = float(std::max<size_t>(7 - lane, 2));
    corners.at[1][0][lane] = corners.at[2][1][lane] = 1;
    for (auto& corner : corners.at) corner[2][lane] = height;
  }
  const float point[3] = {0.25F, 0.25F, 0};
  for (const TriangleKernels* kernels : {&portable_triangle_kernels(), &triangle_kernels()}) {
    TriangleFrames frames[2] = {};
    kernels->make_frames(&corners, 1, &frames[0]);
    kernels->make_frames(&corners, 1, &frames[1]);
    float least2 = 0;
    EXPECT_EQ(kernels->nearest(frames, 2, point, least2), 5U);
    EXPECT_FLOAT_EQ(least2, 4);
    frames[0].origin_x[0] = frames[0].origin_z[5] = frames[0].base[7] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(kernels->nearest(frames, 1, point, least2), 6U);
    EXPECT_FLOAT_EQ(least2, 4);
    const float far[3] = {1e30F, 0, 0};
    EXPECT_LT(kernels->nearest(frames, 1, far, least2), kLanes);
    EXPECT_EQ(least2, std::numeric_limits<float>::infinity());
  }
}

/// A root over eight leaves of one block each, every box as large as its triangles.
struct SmallTree {
  BoxTreeNode root{};
  TriangleBlock blocks[kLanes] = {};
  explicit SmallTree(std::mt19937& random) {
    for (size_t i = 0; i < kLanes; ++i) {
      const TriangleCorners corners = random_corners(random);
      portable_triangle_kernels().make_frames(&corners, 1, &blocks[i]);
      float low[3], high[3];
      for (size_t axis = 0; axis < 3; ++axis) {
        low[axis] = high[axis] = corners.at[0][axis][0];
        for (const auto& corner : corners.at)
          for (const float value : corner[axis])
            low[axis] = std::min(low[axis], value), high[axis] = std::max(high[axis], value);
      }
      root.min_x[i] = low[0], root.min_y[i] = low[1], root.min_z[i] = low[2];
      root.max_x[i] = high[0], root.max_y[i] = high[1], root.max_z[i] = high[2];
      root.child[i] = BoxTreeNode::kLeafBit | static_cast<uint32_t>(i);
      root.blocks[i] = 1;
      for (size_t lane = 0; lane < kLanes; ++lane) blocks[i].triangle[lane] = static_cast<uint32_t>(i * kLanes + lane);
    }
  }
  TreeSearch search(const float* point) const {
    return {.nodes = &root,
            .blocks = blocks,
            .point = {point[0], point[1], point[2]},
            .enough_distance2 = 0,
            .group_of_triangle = nullptr,
            .group_hidden = nullptr,
            .distance2 = std::numeric_limits<float>::infinity(),
            .triangle = 0xffffffffU};
  }
};

TEST(TriangleKernels, search_finds_what_looking_at_every_triangle_does) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> in_cube(-50, 50);
  for (int round = 0; round < 500; ++round) {
    const SmallTree tree(random);
    const float point[3] = {in_cube(random), in_cube(random), in_cube(random)};
    float least2 = std::numeric_limits<float>::infinity();
    for (const TriangleBlock& block : tree.blocks) {
      alignas(32) float d2[kLanes] = {};
      portable_triangle_kernels().distances(block, point, d2);
      least2 = std::min(least2, *std::min_element(d2, d2 + kLanes));
    }
    for (const TriangleKernels* kernels : {&portable_triangle_kernels(), &triangle_kernels()}) {
      TreeSearch search = tree.search(point);
      kernels->search(search);
      EXPECT_NEAR(search.distance2, least2, 1e-5F * least2);
      ASSERT_LT(search.triangle, kLanes * kLanes);
    }
  }
}

}  // namespace
}  // namespace promenade
