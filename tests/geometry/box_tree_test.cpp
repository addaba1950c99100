#include "geometry/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/random.h"

namespace promenade {
namespace {

std::vector<uint32_t> near(const BoxTree& tree, const Box& box) {
  std::vector<uint32_t> found;
  tree.for_each_near(box, [&](uint32_t number) { found.push_back(number); });
  std::sort(found.begin(), found.end());
  return found;
}

Box random_box(Random& random, float space, float size) {
  Box box;
  const auto place = [&] { return static_cast<float>(random.below(1000)) / 1000.0F; };
  const auto point = [&] { return glm::vec3(place(), place(), place()); };
  const glm::vec3 at = point() * space;
  box.add(at), box.add(at + point() * size);
  return box;
}

TEST(BoxTree, finds_what_looking_at_each_box_finds) {
  Random random(1);
  for (const size_t count : {0U, 1U, 8U, 9U, 100U, 3000U}) {
    std::vector<Box> boxes;
    for (size_t i = 0; i < count; ++i) boxes.push_back(random_box(random, 100, i % 7 == 0 ? 40.0F : 2.0F));
    const BoxTree tree(boxes);
    for (int i = 0; i < 200; ++i) {
      const Box asked = random_box(random, 120, i % 3 == 0 ? 30.0F : 0.0F);
      std::vector<uint32_t> expected;
      for (uint32_t k = 0; k < boxes.size(); ++k)
        if (boxes[k].overlaps(asked)) expected.push_back(k);
      ASSERT_EQ(near(tree, asked), expected);
    }
  }
}

TEST(BoxTree, finds_flat_boxes_in_one_place_and_those_that_only_touch) {
  Box flat;
  flat.add({0, 0, 1}), flat.add({2, 2, 1});
  const BoxTree tree(std::vector<Box>(1000, flat));
  Box touching;
  touching.add({2, 2, 0}), touching.add({3, 3, 1});
  EXPECT_EQ(near(tree, touching).size(), 1000U);
  EXPECT_TRUE(near(tree, {glm::vec3(2.1F, 0, 0), glm::vec3(3, 3, 3)}).empty());
}

}  // namespace
}  // namespace promenade
