#include "preprocess/node_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "codec/id_set.h"
#include "layout/file_io.h"
#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

constexpr uint32_t kNodes = 200, kCells = 40;

Model model_of_nodes() {
  Model model;
  model.tables.nodes.resize(kNodes);
  return model;
}

/// Cells in a row that see a window of a hidden order of the nodes.
Visibility row_of_cells() {
  std::vector<uint32_t> hidden(kNodes);
  for (uint32_t i = 0; i < kNodes; ++i) hidden[i] = i * 73 % kNodes;
  Visibility seen;
  for (uint32_t cell = 0; cell < kCells; ++cell) {
    std::vector<uint32_t> ids(hidden.begin() + 4 * cell, hidden.begin() + 4 * cell + 30);
    std::sort(ids.begin(), ids.end());
    seen.vlods.push_back({encode_ids(ids), static_cast<uint32_t>(ids.size()), 0, 0, 0});
    if (cell > 0) seen.cells.faces.push_back({CellId{cell - 1}, CellId{cell}, 0, 0, 0});
  }
  return seen;
}

class NodeOrders : public testing::Test {
 protected:
  Result<NodeOrder> order(const std::string& name) {
    const Result<WorkFolder> folder = WorkFolder::open(folder_.path() / "work", real_file_system());
    if (!folder.ok()) return folder.error();
    return node_order(model_of_nodes(), row_of_cells(), *parse_node_order(name), *folder, monitor_);
  }
  TemporaryFolder folder_;
  JobMonitor monitor_;
};

TEST_F(NodeOrders, the_tour_brings_together_what_a_step_brings) {
  const Result<NodeOrder> tour = order("tour"), input = order("input");
  ASSERT_TRUE(tour.ok() && input.ok());
  EXPECT_EQ(tour->delta_ids_mean, 8) << "four enter, four leave";
  EXPECT_TRUE(is_permutation_of(tour->order, kNodes));
  std::vector<uint32_t> place(kNodes);
  for (uint32_t i = 0; i < kNodes; ++i) place[tour->order[i]] = i;
  // Nodes 4 k + 30 to 4 k + 33 of the hidden order enter together, from cell to cell.
  for (uint32_t k = 0; k + 1 < kCells; ++k)
    for (uint32_t i = 31; i < 34; ++i) {
      const uint32_t a = place[(4 * k + i - 1) * 73 % kNodes], b = place[(4 * k + i) * 73 % kNodes];
      EXPECT_LE(std::max(a, b) - std::min(a, b), 3U) << "cell " << k;
    }
}

TEST_F(NodeOrders, the_tours_units_are_not_done_twice) {
  const Result<NodeOrder> first = order("tour");
  ASSERT_TRUE(first.ok());
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "work"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  ASSERT_EQ(names.size(), 9U) << "eight searches and the tour";
  EXPECT_EQ(names.front(), "order-near-00");
  EXPECT_EQ(names.back(), "order-tour");
  const auto written = std::filesystem::last_write_time(folder_.path() / "work" / "order-tour");
  EXPECT_EQ(order("tour")->order, first->order);
  EXPECT_EQ(std::filesystem::last_write_time(folder_.path() / "work" / "order-tour"), written);
  // Half done, and damaged: the rest is done again.
  std::filesystem::remove(folder_.path() / "work" / "order-tour");
  std::filesystem::remove(folder_.path() / "work" / "order-near-03");
  std::filesystem::resize_file(folder_.path() / "work" / "order-near-05", 20);
  EXPECT_EQ(order("tour")->order, first->order);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "work" / "order-near-03"));
}

TEST_F(NodeOrders, an_interrupted_tour_is_none) {
  class Stopped : public JobMonitor {
   public:
    bool cancelled() const override { return true; }
  } stopped;
  const Result<WorkFolder> folder = WorkFolder::open(folder_.path() / "work", real_file_system());
  ASSERT_TRUE(folder.ok());
  const Result<NodeOrder> made =
      node_order(model_of_nodes(), row_of_cells(), *parse_node_order("tour"), *folder, stopped);
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.error().message.find("interrupted"), std::string::npos);
}

TEST_F(NodeOrders, ones_own_is_taken_as_it_is) {
  std::string text;
  for (uint32_t i = kNodes; i-- > 0;) text += std::to_string(i) + "\n";
  ASSERT_TRUE(write_file(folder_.path() / "own.txt", std::string_view(text)).ok());
  const Result<NodeOrder> made = order("file:" + (folder_.path() / "own.txt").string());
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_EQ(made->order.front(), kNodes - 1);
  EXPECT_EQ(made->delta_ids_mean, 8);
}

}  // namespace
}  // namespace promenade
