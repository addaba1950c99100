#include "layout/openings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/random.h"
#include "layout/cell_faces.h"
#include "tests/layout/cell_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr, testing::IsEmpty;

constexpr uint64_t kTables = 0x1122334455667788U;

/// Up to three openings each way of each face, some faces closed.
Openings some_openings() {
  Openings openings;
  openings.regions = *regions_of(three_cells());
  Random random(7);
  openings.first.push_back(0);
  for (uint32_t i = 0; i < 2 * openings.regions.faces.size(); ++i) {
    const CellFace& face = openings.regions.faces[i / 2];
    const Box frame = rectangle_of(openings.regions, face).grown(kOpeningSlackM);
    for (uint32_t k = random.below(4); k > 0; --k) {
      Box box = frame;
      for (const uint32_t turn : {1U, 2U}) {
        const int axis = static_cast<int>((face.axis + turn) % 3);
        const auto a = static_cast<float>(random.unit()), b = static_cast<float>(random.unit());
        const float size = frame.max[axis] - frame.min[axis];
        box.min[axis] = frame.min[axis] + size * std::min(a, b),
        box.max[axis] = frame.min[axis] + size * std::max(a, b);
      }
      openings.boxes.push_back(box);
    }
    openings.first.push_back(static_cast<uint32_t>(openings.boxes.size()));
  }
  return openings;
}

TEST(Openings, every_leaf_is_a_region_cells_or_not) {
  const CellTables cells = three_cells();
  const Result<CellTables> regions = regions_of(cells);
  ASSERT_TRUE(regions) << regions.error().message;
  size_t leaves = 0;
  for (const CellTreeNode& node : cells.tree) leaves += node.axis == CellTreeNode::kLeaf ? 1 : 0;
  EXPECT_EQ(regions->cells.size(), leaves);
  EXPECT_THAT(find_defect(*regions), IsEmpty());
  double volume = 0;
  for (const CellRecord& region : regions->cells)
    volume += double(region.box.size().x) * double(region.box.size().y) * double(region.box.size().z);
  const glm::dvec3 size(cells.box.size());
  EXPECT_NEAR(volume, size.x * size.y * size.z, 1e-3 * volume) << "they fill all space";
}

TEST(Openings, come_back_never_narrower_and_hardly_wider) {
  const Openings due = some_openings();
  const Result<Openings> back = decode_openings(encode_openings(due, kTables), three_cells(), kTables);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->first, due.first);
  ASSERT_EQ(back->boxes.size(), due.boxes.size());
  ASSERT_GT(due.boxes.size(), 3U);
  for (uint32_t i = 0; i < 2 * due.regions.faces.size(); ++i) {
    const Box frame = rectangle_of(due.regions, due.regions.faces[i / 2]).grown(kOpeningSlackM);
    for (uint32_t k = due.first[i]; k < due.first[i + 1]; ++k) {
      EXPECT_TRUE(back->boxes[k].contains(due.boxes[k]));
      EXPECT_TRUE(frame.contains(back->boxes[k]));
      for (int axis = 0; axis < 3; ++axis) {
        const float step = 1.01F * frame.size()[axis] / 255;
        EXPECT_LE(due.boxes[k].min[axis] - back->boxes[k].min[axis], step);
        EXPECT_LE(back->boxes[k].max[axis] - due.boxes[k].max[axis], step);
      }
    }
  }
  EXPECT_EQ(encode_openings(*back, kTables), encode_openings(due, kTables)) << "and no wider the second time";
}

TEST(Openings, decode_rejects_every_truncation_and_every_changed_byte) {
  const std::vector<std::byte> bytes = encode_openings(some_openings(), kTables);
  for (size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decode_openings(std::span(bytes).first(length), three_cells(), kTables)) << length;
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::byte> changed = bytes;
    changed[i] ^= std::byte{1};
    EXPECT_FALSE(decode_openings(changed, three_cells(), kTables)) << i;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode_openings(longer, three_cells(), kTables));
}

TEST(Openings, of_another_model_are_refused) {
  const std::vector<std::byte> bytes = encode_openings(some_openings(), kTables);
  const Result<Openings> other_tables = decode_openings(bytes, three_cells(), kTables + 1);
  ASSERT_FALSE(other_tables);
  EXPECT_THAT(other_tables.error().message, HasSubstr("not of one build"));
  CellTables moved = three_cells();
  moved.box.max.z += 1;
  EXPECT_FALSE(decode_openings(bytes, moved, kTables));
}

}  // namespace
}  // namespace promenade
