#include "layout/cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/layout/cell_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr, testing::IsEmpty;

TEST(Cells, three_cells_are_sound) { EXPECT_THAT(find_defect(three_cells()), IsEmpty()); }

TEST(Cells, none_are_sound) {
  CellTables tables;
  tables.bound = one_pixel();
  EXPECT_THAT(find_defect(tables), IsEmpty());
  EXPECT_EQ(cell_at(tables, {0, 0, 0}), std::nullopt);
}

TEST(Cells, are_found_by_a_point) {
  const CellTables tables = three_cells();
  EXPECT_EQ(cell_at(tables, {1, 1, 1}), CellId{0});
  EXPECT_EQ(cell_at(tables, {3, 0.5, 1}), CellId{1});
  EXPECT_EQ(cell_at(tables, {3, 1.5, 1}), CellId{2});
  EXPECT_EQ(cell_at(tables, {2, 1, 0}), CellId{2}) << "a point on a plane belongs above it";
  EXPECT_EQ(cell_at(tables, {4, 2, 2}), CellId{2}) << "the outermost faces belong to their cells";
  EXPECT_EQ(cell_at(tables, {4.01, 1, 1}), std::nullopt);
  EXPECT_EQ(cell_at(tables, {std::numeric_limits<double>::quiet_NaN(), 1, 1}), std::nullopt);
}

TEST(Cells, defects_are_told) {
  const auto defect = [](const std::function<void(CellTables&)>& change) {
    CellTables tables = three_cells();
    change(tables);
    return find_defect(tables);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(defect([&](CellTables& t) { t.cells[1].box.max.z = nan; }), HasSubstr("cell 1: box"));
  EXPECT_THAT(defect([](CellTables& t) { t.cells[1].box.max.x = 2; }), HasSubstr("cell 1: box"));
  EXPECT_THAT(defect([](CellTables& t) { t.cells[1].box.max.x = 5; }), HasSubstr("cell 1 is not within it"));
  EXPECT_THAT(defect([](CellTables& t) { t.cells[2].face_count = 0xffffffff; }), HasSubstr("cell 2: faces"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces_of_cells[0] = 9; }), HasSubstr("cell 0: face 9"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces_of_cells[0] = 2; }), HasSubstr("cell 0: face 2 is not its"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces_of_cells.push_back(0); }), HasSubstr("named 7 times"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces[1].axis = 3; }), HasSubstr("face 1"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces[1].axis = 1; }), HasSubstr("do not touch"));
  EXPECT_THAT(defect([](CellTables& t) { t.faces[1].first_portal = 3; }), HasSubstr("face 1: portals"));
  EXPECT_THAT(defect([](CellTables& t) { t.portals[2].max.x = 9; }), HasSubstr("face 2: a portal"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[0].below = 0; }), HasSubstr("tree node 0: child 0"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[2].above = 9; }), HasSubstr("tree node 2: child 9"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[2].above = 3; }), HasSubstr("cell 1 is not within it"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[0].split_m = 7; }), HasSubstr("split at 7 m"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[0].axis = 7; }), HasSubstr("axis 7"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree[4].below = index_of(kNoCell); }), HasSubstr("2 of 3 cells"));
  EXPECT_THAT(defect([](CellTables& t) { t.tree.clear(); }), HasSubstr("without a tree"));
  EXPECT_THAT(defect([](CellTables& t) { t.bound.pixel_error = 0; }), HasSubstr("bound"));
  EXPECT_THAT(defect([&](CellTables& t) { t.box.max.x = nan; }), HasSubstr("tree's box"));
}

}  // namespace
}  // namespace promenade
