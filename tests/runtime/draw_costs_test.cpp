#include "runtime/draw_costs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "runtime/cpu_renderer.h"

namespace promenade {
namespace {

DrawLoad load_with(double nodes, double triangles, double cover) {
  DrawLoad load = load_of_picture(1280, 720);
  load.amount[DrawLoad::nodes] = nodes;
  load.amount[DrawLoad::triangles] = triangles;
  load.amount[DrawLoad::cover] = cover;
  return load;
}

DrawCosts machine() { return {{2.0, 0.01, 2e-5, 0.1, 0}, false}; }

TEST(DrawCosts, fit_finds_the_machine_and_nothing_negative) {
  std::vector<std::pair<DrawLoad, double>> rows;
  for (const DrawLoad& load : {load_with(0, 0, 0), load_with(500, 1000, 1), load_with(100, 200000, 3),
                               load_with(100, 200000, 9), load_with(16, 32, 14)})
    rows.emplace_back(load, ms_of(load, machine()));
  const DrawCosts found = fitted_costs(rows);
  for (size_t i = 0; i < DrawLoad::kTerms; ++i)
    EXPECT_NEAR(found.ms[i], machine().ms[i], 0.02 * machine().ms[i] + 1e-9) << "term " << i;
  rows.emplace_back(load_with(500, 200000, 14), 0.5);  // faster than its parts
  for (const double ms : fitted_costs(rows).ms) EXPECT_GE(ms, 0);
}

TEST(CostModel, finds_the_pace_whatever_single_frames_do) {
  CostModel model(machine());
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.03);
  double squares = 0;
  int counted = 0;
  for (int frame = 0; frame < 600; ++frame) {
    const DrawLoad load = load_with(100 + frame % 50, 100000 + 300.0 * (frame % 400), 5);
    const double pace = frame < 300 ? 1.5 : 0.8;  // another program has ended
    const double truth = pace * ms_of(load, machine());
    const double took = truth * (1 + noise(random)) * (frame % 37 == 0 ? 4 : 1);  // interrupted now and then
    const double off = model.estimate_ms(load) / truth - 1;
    if (frame % 300 > 20) squares += off * off, ++counted;
    model.learn(load, took);
  }
  EXPECT_LT(std::sqrt(squares / counted), 0.04);
}

TEST(CostModel, learns_which_term_was_wrong) {
  DrawCosts wrong = machine();
  wrong.ms[DrawLoad::triangles] /= 2;
  CostModel model(wrong);
  std::mt19937 random(4);
  const auto error_of = [&] {
    double worst = 0;
    for (const double triangles : {1e4, 1e5, 1e6}) {
      const DrawLoad load = load_with(100, triangles, 5);
      worst = std::max(worst, std::abs(model.estimate_ms(load) / ms_of(load, machine()) - 1));
    }
    return worst;
  };
  const double before = error_of();
  for (int frame = 0; frame < 3000; ++frame) {
    const DrawLoad load = load_with(100, random() % 2 == 0 ? 1e4 : 1e6, 5);
    model.learn(load, ms_of(load, machine()));
  }
  EXPECT_LT(error_of(), before / 3);
}

TEST(CostModel, finds_the_pace_anew_where_much_more_is_asked_for) {
  CostModel model(machine());
  const DrawLoad few = load_with(100, 1e5, 5), many = load_with(500, 1e6, 5);
  for (int frame = 0; frame < 20; ++frame) model.learn(few, ms_of(few, machine()));
  // Most of the many lies hidden: a third of what it would take.
  model.learn(many, ms_of(many, machine()) / 3);
  EXPECT_NEAR(model.pace(), 1.0 / 3, 0.02) << "from the first frame on";
  for (int frame = 0; frame < 5; ++frame) model.learn(many, ms_of(many, machine()) / 3);
  model.learn(many, ms_of(many, machine()) * 5);
  EXPECT_NEAR(model.pace(), 1.0 / 3, 0.02) << "one frame that the system interrupted changes nothing";
}

TEST(CostModel, ignores_times_that_are_none) {
  CostModel model(machine());
  const DrawLoad load = load_with(1, 1, 1);
  const double before = model.estimate_ms(load);
  for (const double none : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) model.learn(load, none);
  model.learn(DrawLoad{}, 5);
  EXPECT_EQ(model.estimate_ms(load), before);
}

class StoredCosts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("promenade_draw_costs_" + std::to_string(std::hash<std::string>()(testing::TempDir())) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Result<DrawCosts> get(const std::string& key) {
    return stored_draw_costs(folder_ / "costs.json", key, [this]() -> Result<DrawCosts> {
      ++measured_;
      return machine();
    });
  }
  std::filesystem::path folder_;
  int measured_ = 0;
};

TEST_F(StoredCosts, are_measured_once_a_key) {
  ASSERT_TRUE(get("a"));
  EXPECT_FALSE(get("b")->stored);
  EXPECT_TRUE(get("a")->stored);
  EXPECT_EQ(get("a")->ms, machine().ms);
  EXPECT_EQ(measured_, 2);
}

TEST_F(StoredCosts, broken_file_is_measured_again) {
  for (const char* text :
       {"", "{", "[]", R"({"format":1,"machines":{"a":[1,2]}})", R"({"format":1,"machines":{"a":[1,2,3,4,-5]}})",
        R"({"format":1,"machines":7})", R"({"format":9,"machines":{}})"}) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "costs.json") << text;
    measured_ = 0;
    ASSERT_TRUE(get("a"));
    EXPECT_EQ(measured_, 1) << text;
    EXPECT_TRUE(get("a")->stored) << text;
  }
}

TEST(DrawCosts, are_measured_on_a_renderer_that_is_left_as_it_was) {
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer();
  const Result<DrawCosts> costs = measure_draw_costs(*renderer);
  ASSERT_TRUE(costs) << costs.error().message;
  double sum = 0;
  for (const double ms : costs->ms) {
    EXPECT_GE(ms, 0);
    sum += ms;
  }
  EXPECT_GT(sum, 0);
  EXPECT_EQ(renderer->bytes(), 0U);
}

}  // namespace
}  // namespace promenade
