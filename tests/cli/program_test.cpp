// The program as its users meet it: a city generated, built, looked at and flown through; usage; errors.

#include "program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace promenade {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json json_in(const fs::path& file) { return json::parse(read_text(file)); }

/// One line on standard error that starts with the program's name.
void expect_one_clear_line(const ProgramRun& run, const std::string& names) {
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_EQ(run.err.rfind("promenade: ", 0), 0U) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find(names), std::string::npos) << run.err;
}

/// A city that is generated and built once for all tests.
class SmallCity : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new TemporaryFolder;
    generated = new ProgramRun(
        run_program("generate city --seed 3 --triangles 100000 -o city.glb --json generate.json", folder()));
    built =
        new ProgramRun(run_program("build city.glb -o city.prom --memory 1GiB --jobs 2 --json build.json", folder()));
  }
  static void TearDownTestSuite() { delete shared_folder, delete generated, delete built; }
  static const fs::path& folder() { return shared_folder->path(); }

  static inline TemporaryFolder* shared_folder = nullptr;
  static inline ProgramRun* generated = nullptr;
  static inline ProgramRun* built = nullptr;
};

TEST_F(SmallCity, is_generated_with_its_paths) {
  ASSERT_EQ(generated->exit_code, 0) << generated->err;
  for (const char* file : {"city.glb", "city_walk.json", "city_drive.json", "city_fly.json"})
    EXPECT_TRUE(fs::exists(folder() / file)) << file;
  const json figures = json_in(folder() / "generate.json");
  EXPECT_NEAR(figures["triangles"].get<double>(), 100000, 10000);
}

TEST_F(SmallCity, is_built_with_the_figures_of_the_contract) {
  ASSERT_EQ(built->exit_code, 0) << built->err;
  const json figures = json_in(folder() / "build.json");
  for (const char* name : {"triangles_in", "nodes", "bytes_by_part", "stage_wall_s", "stage_peak_rss_bytes",
                           "build_wall_s", "peak_rss_bytes"})
    EXPECT_TRUE(figures.contains(name)) << name;
  EXPECT_GE(figures["triangles_in"].get<uint64_t>(), 90000U);
  EXPECT_GT(figures["nodes"].get<uint64_t>(), 50U);
  double nodes_s = 0;  // of the processor's time, the parts that the tree's nodes took
  for (const char* part : {"merge", "simplify", "measure", "code"}) {
    EXPECT_GT(figures["node_cpu_s"][part].get<double>(), 0) << part;
    nodes_s += figures["node_cpu_s"][part].get<double>();
  }
  EXPECT_EQ(figures["node_cpu_s"]["bake"], 0) << "a city without pictures";
  EXPECT_LT(nodes_s, figures["cpu_s"].get<double>());
  EXPECT_FALSE(fs::exists(folder() / "city.prom.work")) << "the working files of a finished build stay behind";
}

TEST_F(SmallCity, info_tells_its_levels) {
  const ProgramRun run = run_program("info city.prom --json info.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "info.json");
  EXPECT_EQ(figures["nodes"], json_in(folder() / "build.json")["nodes"]);
  const json& levels = figures["levels"];
  ASSERT_GE(levels.size(), 2U);
  EXPECT_EQ(levels[0]["nodes"], 1);
  EXPECT_GT(levels[0]["error_m_max"], levels.back()["error_m_mean"]);
}

TEST_F(SmallCity, info_measures_the_fronts_of_a_path_by_either_error) {
  double shares[2] = {0, 0};
  for (const std::string kind : {"bound", "p99"}) {
    const ProgramRun run = run_program(
        "info city.prom --front-from city_walk.json --eyes 5 --error-kind " + kind + " --json front.json", folder());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json front = json_in(folder() / "front.json")["front"];
    EXPECT_EQ(front["error_kind"], kind);
    EXPECT_LE(front["in_view_triangles_mean"], front["triangles_mean"]);
    EXPECT_LE(front["triangles_mean"], front["full_triangles_mean"]);
    shares[kind == "p99"] = front["share_of_full"].get<double>();
  }
  EXPECT_LE(shares[1], shares[0]) << "99 % of a surface is no farther off than all of it";
}

TEST_F(SmallCity, study_geometry_compares_codecs) {
  const ProgramRun run = run_program("study geometry city.prom --nodes 20 --json study.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "study.json");
  uint32_t defaults = 0;
  for (const json& row : figures["codecs"]) {
    EXPECT_GT(row["bits_per_triangle"], 0) << row["name"];
    EXPECT_GT(row["encode_triangles_per_s"], 0) << row["name"];
    EXPECT_GT(row["decode_triangles_per_s"], 0) << row["name"];
    EXPECT_GE(row["error_ratio"], 0) << row["name"];
    defaults += row["default"].get<bool>() ? 1U : 0U;
  }
  EXPECT_EQ(defaults, 1);
  EXPECT_EQ(run_program("study geometry", folder()).exit_code, 2);
  EXPECT_EQ(run_program("study nothing city.prom", folder()).exit_code, 2);
}

TEST_F(SmallCity, is_flown_through_within_its_bound_with_a_row_a_frame) {
  const ProgramRun run = run_program(
      "fly city.prom --path city_walk.json --seconds 1 --size 160x90 --memory 64MiB --renderer gl --offscreen osmesa "
      "--frames "
      "pictures --frames-every 10 "
      "--report walk.html --json fly.json",
      folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "fly.json");
  ASSERT_EQ(figures["frames"].size(), 31U);
  for (const char* name :
       {"frame_ms_p50", "frame_ms_p99", "frame_ms_stddev", "response_ms_p99", "triangles_drawn_mean",
        "nodes_drawn_mean", "nodes_missing_mean", "toggles_per_frame", "cells_crossed", "delta_bytes_mean",
        "bytes_read", "reads", "bytes_read_useful", "resident_bytes_peak", "peak_rss_bytes", "stalls"})
    EXPECT_TRUE(figures[name].is_number()) << name;
  EXPECT_LE(figures["resident_bytes_peak"].get<uint64_t>(), uint64_t(64) << 20);
  EXPECT_GT(figures["triangles_drawn_mean"].get<double>(), 0);
  EXPECT_TRUE(fs::exists(folder() / "pictures" / "frame_0010.png"));
  EXPECT_FALSE(fs::exists(folder() / "pictures" / "frame_0005.png"));
  const std::string page = read_text(folder() / "walk.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_NE(page.find("data:image/jpeg;base64,"), std::string::npos);
}

TEST_F(SmallCity, study_policies_compares_them_on_one_path) {
  const ProgramRun run = run_program(
      "study policies city.prom --path city_walk.json --policies static,cost-benefit,vlod-time-slices --seconds 0.5 "
      "--size 160x90 --renderer cpu --popping --report policies.html --json policies.json",
      folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "policies.json");
  ASSERT_EQ(figures["policies"].size(), 3U);
  for (const json& row : figures["policies"]) {
    for (const char* name : {"frame_ms_p50", "frame_ms_p99", "frame_ms_stddev", "response_ms_p99", "toggles_per_frame",
                             "nodes_missing_mean", "popped_share_mean", "frame_noise_percent"})
      EXPECT_TRUE(row[name].is_number()) << name;
    EXPECT_FALSE(row.contains("frames")) << "totals only";
    EXPECT_EQ(row.contains("default"), row["name"] == "vlod-time-slices");
  }
  const std::string page = read_text(folder() / "policies.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  for (const char* name : {"static", "cost-benefit", "vlod-time-slices", "Frame time", "Resident"})
    EXPECT_NE(page.find(name), std::string::npos) << name;
  EXPECT_EQ(run_program("study policies city.prom --path city_walk.json --policies best", folder()).exit_code, 2);
}

TEST_F(SmallCity, gets_far_pictures_later_and_is_flown_and_held_against_the_source_with_them) {
  fs::copy(folder() / "city.prom", folder() / "far.prom", fs::copy_options::recursive);
  const ProgramRun made = run_program(
      "far far.prom --far-path city_fly.json --far-bound 4 --far-side 129 --far-deltas --json far.json", folder());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json far = json_in(folder() / "far.json")["far"];
  EXPECT_GT(far["cells_with_pictures"], 0);
  EXPECT_GT(far["faces_told"], 0);
  EXPECT_LE(far["parallax_max_deg"], 4);
  const ProgramRun flown = run_program(
      "fly far.prom --path city_fly.json --seconds 1 --size 160x90 --settle --policy stratified --renderer cpu --json "
      "far_fly.json",
      folder());
  ASSERT_EQ(flown.exit_code, 0) << flown.err;
  EXPECT_GT(json_in(folder() / "far_fly.json")["far_triangles_mean"], 0);
  const ProgramRun held = run_program(
      "verify far.prom --cells 0 --source city.glb --path city_fly.json --source-views 3 --size 320x180 --policy "
      "stratified --json held.json",
      folder());
  ASSERT_EQ(held.exit_code, 0) << held.err;
  // Four degrees are 20 pixels in the picture's middle; without far pictures as surfaces it would be hundreds.
  EXPECT_LT(json_in(folder() / "held.json")["pixel_error_p99_px"], 25);
  // Once more, in two shells.
  const ProgramRun shells = run_program(
      "far far.prom --far-path city_fly.json --far-bound 4 --far-side 129 --far-shells 2 --json far.json", folder());
  ASSERT_EQ(shells.exit_code, 0) << shells.err;
  const json both = json_in(folder() / "far.json")["far"];
  ASSERT_EQ(both["shells"].size(), 2U);
  EXPECT_GT(both["shells"][1]["box_m"], both["shells"][0]["box_m"]);
  EXPECT_LE(both["parallax_max_deg"], 4);
  const ProgramRun again = run_program(
      "verify far.prom --cells 0 --source city.glb --path city_fly.json --source-views 3 --size 320x180 --policy "
      "stratified --json held.json",
      folder());
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_LT(json_in(folder() / "held.json")["pixel_error_p99_px"], 25);
  EXPECT_EQ(run_program("far far.prom --far-shells 9", folder()).exit_code, 1);
  EXPECT_EQ(run_program("far far.prom --far-bound 0", folder()).exit_code, 1);
  expect_one_clear_line(run_program("far none.prom", folder()), "none.prom");
}

/// Two closed rooms side by side, full of little boxes, as an OBJ file.
std::string two_full_rooms() {
  std::string vertices, faces;
  int count = 0;
  const auto box = [&](double x0, double y0, double z0, double x1, double y1, double z1) {
    for (const double z : {z0, z1})
      for (const auto& [x, y] : {std::pair(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
        vertices += fmt::format("v {} {} {}\n", x, y, z);
    for (const std::array<int, 4>& f : std::vector<std::array<int, 4>>{
             {4, 3, 2, 1}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}})
      faces += fmt::format("f {} {} {} {}\n", count + f[0], count + f[1], count + f[2], count + f[3]);
    count += 8;
  };
  box(0, 0, 0, 8.6, 4.4, 0.2), box(0, 0, 3.2, 8.6, 4.4, 3.4);          // floor, ceiling
  box(0, 0, 0.2, 0.2, 4.4, 3.2), box(8.4, 0, 0.2, 8.6, 4.4, 3.2);      // left, right
  box(0.2, 0, 0.2, 8.4, 0.2, 3.2), box(0.2, 4.2, 0.2, 8.4, 4.4, 3.2);  // front, back
  box(4.2, 0.2, 0.2, 4.4, 4.2, 3.2);                                   // between
  for (const double room : {0.7, 4.9})
    for (int i = 0; i < 20; ++i)
      for (int k = 0; k < 20; ++k) {
        const double x = room + 0.15 * i, y = 0.6 + 0.15 * k;
        box(x, y, 0.3, x + 0.1, y + 0.1, 0.4 + 0.002 * ((7 * i + 3 * k) % 20));
      }
  return vertices + faces;
}

TEST(SmallBuilding, eye_culling_leaves_out_nodes_and_no_pixel) {
  TemporaryFolder folder;
  const auto run = [&](const std::string& words) { return run_program(words, folder.path()); };
  write_text(folder.path() / "rooms.obj", two_full_rooms());
  write_text(folder.path() / "walk.json",
             R"({"fps": 30, "keys": [{"t": 0, "eye": [2, 2, 1.7], "yaw_deg": 0, "pitch_deg": -20},
                 {"t": 1, "eye": [2.5, 1.5, 1.7], "yaw_deg": 90, "pitch_deg": -40}]})");
  const std::string build =
      "build rooms.obj --unit 1 --up z --cells kd --hiders none --node-triangles 500 --memory 1GiB --jobs 2 -o ";
  ASSERT_EQ(run(build + "rooms.prom --openings --json build.json").exit_code, 0);
  ASSERT_EQ(run(build + "rooms.prom --openings --json build.json").exit_code, 0) << "in place of the first";
  EXPECT_GT(json_in(folder.path() / "build.json")["bytes_by_part"]["openings"], 0);
  const std::string fly =
      "fly rooms.prom --path walk.json --size 320x180 --settle --policy vlod --renderer cpu --fade-frames 0 ";
  ASSERT_EQ(run(fly + "--frames all --json all.json").exit_code, 0);
  ASSERT_EQ(run(fly + "--frames eye --json eye.json --eye-culling").exit_code, 0);
  size_t pictures = 0;
  for (const auto& picture : fs::directory_iterator(folder.path() / "all")) {
    ++pictures;
    EXPECT_TRUE(read_text(picture.path()) == read_text(folder.path() / "eye" / picture.path().filename()))
        << picture.path();
  }
  EXPECT_GT(pictures, 10U);
  for (const json& frame : json_in(folder.path() / "eye.json")["frames"]) EXPECT_GT(frame["eye_hidden_nodes"], 0);
  for (const json& frame : json_in(folder.path() / "all.json")["frames"]) EXPECT_EQ(frame["eye_hidden_nodes"], 0);
  ASSERT_EQ(run(build + "without.prom").exit_code, 0);
  expect_one_clear_line(run("fly without.prom --path walk.json --renderer cpu --eye-culling"), "--openings");
}

TEST_F(SmallCity, study_far_tells_what_differences_from_a_neighbour_save) {
  const ProgramRun run = run_program(
      "study far city.prom --path city_fly.json --places 1 --far-box 220 --far-side 129 --steps 1 --flat-cells 1 "
      "--depth-cells 2 "
      "--json study_far.json",
      folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "study_far.json");
  const json rows = figures["far"];
  ASSERT_EQ(rows.size(), 2U * 5U);
  ASSERT_EQ(figures["near"].size(), 2U);
  EXPECT_GT(figures["near"][0]["leaves_mean"], 0);
  EXPECT_LE(figures["near"][0]["changed_mean"], figures["near"][0]["leaves_mean"]);
  for (const json& row : rows) {
    EXPECT_GT(row["bytes_per_cell_mean"], 0);
    EXPECT_LT(row["color_error_mean"], 1.5 * rows[0]["color_error_mean"].get<double>() + 1);
    if (row["name"] == "alone") {
      EXPECT_EQ(row["share_of_alone"], 1);
    }
  }
}

TEST_F(SmallCity, study_hiders_compares_chains_by_size_of_cell) {
  const ProgramRun run = run_program(
      "study hiders city.prom --cells 2 --views 12 --side 2,6 --hiders none --hiders horizon --picture plan.png "
      "--report hiders.html --json hiders.json",
      folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "hiders.json");
  ASSERT_EQ(figures["studies"].size(), 2U) << "a side each";
  EXPECT_EQ(figures["studies"][1]["side_m"], 6);
  for (const json& study : figures["studies"]) {
    ASSERT_EQ(study["chains"].size(), 2U);
    EXPECT_EQ(study["cells"], 2) << "sums start anew with each side";
    EXPECT_EQ(study["chains"][0]["hidden_share"], 0) << "no hider hides nothing";
    EXPECT_GT(study["chains"][1]["hidden_share"], 0);
    EXPECT_LE(study["chains"][1]["overestimate_ratio_mean"], study["chains"][0]["overestimate_ratio_mean"]);
    EXPECT_GE(study["chains"][1]["overestimate_ratio_mean"], 1);
  }
  EXPECT_EQ(figures["chains"], figures["studies"][0]["chains"]) << "the contract's names tell of the first";
  EXPECT_TRUE(fs::exists(folder() / "plan.png"));
  const std::string page = read_text(folder() / "hiders.html");
  for (const char* text : {"</html>", "Cost by size of cell, city", "Quality by size of cell, city", ">6 m</text>"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST_F(SmallCity, study_hiders_tells_of_cells_one_by_one_and_of_one_that_is_asked_for) {
  const std::string study = "study hiders city.prom --hiders backface,horizon --views 12 ";
  const ProgramRun run = run_program(study + "--place cells --cells 3 --eyes 2 --list --json cells.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "cells.json");
  ASSERT_EQ(figures["studied"].size(), figures["cells"]);
  double kept = 0, ratios = 0;
  for (const json& cell : figures["studied"])
    kept += cell["kept_nodes"].get<double>(), ratios += cell["overestimate_ratio"].get<double>();
  const auto count = figures["cells"].get<double>();
  EXPECT_NEAR(figures["chains"][0]["nodes_mean"].get<double>(), kept / count, 1e-6);
  EXPECT_NEAR(figures["chains"][0]["overestimate_ratio_mean"].get<double>(), ratios / count, 1e-6);
  const json& drawn = figures["cull_methods"];
  ASSERT_EQ(drawn.size(), 3U) << "of the cell, of these in view, of the eye";
  EXPECT_LE(drawn[1]["triangles_mean"], drawn[0]["triangles_mean"]);
  EXPECT_LE(drawn[2]["triangles_mean"], drawn[1]["triangles_mean"]);

  const json& first = figures["studied"][0];
  const auto middle = [&](size_t axis) {
    return (first["min"][axis].get<double>() + first["max"][axis].get<double>()) / 2;
  };
  const std::string at = fmt::format("--at={},{},{} ", middle(0), middle(1), middle(2));
  ASSERT_EQ(run_program(study + at + "--json cell.json", folder()).exit_code, 0);
  const json asked = json_in(folder() / "cell.json")["studied"];
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0]["min"], first["min"]);
  EXPECT_EQ(asked[0]["kept_nodes"], first["kept_nodes"]);
  const ProgramRun outside = run_program(study + "--at=1e5,0,0", folder());
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_NE(outside.err.find("no view cell holds 100000,0,0"), std::string::npos) << outside.err;
}

TEST_F(SmallCity, flight_becomes_a_video_or_says_what_is_missing) {
  const std::string fly = "fly city.prom --path city_walk.json --seconds 0.3 --size 161x91 --renderer cpu --video ";
  const ProgramRun run = run_program(fly + "walk.mp4", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(fs::file_size(folder() / "walk.mp4"), 1000U);
  EXPECT_EQ(run_program(fly + "walk.nothing", folder()).exit_code, 1) << "no such kind of video";
  expect_one_clear_line(run_program(fly + "none.mp4", folder(), "PATH=/nowhere"), "\"ffmpeg\"");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder()))
    EXPECT_TRUE(entry.path().stem() == "walk" || !entry.path().string().ends_with(".mp4")) << entry.path();
  EXPECT_FALSE(fs::exists(folder() / "walk.nothing"));
}

TEST_F(SmallCity, looks_the_same_from_the_model_at_full_detail_and_from_the_source) {
  const json key = json_in(folder() / "city_fly.json")["keys"][0];
  const std::string camera = key["eye"][0].dump() + "," + key["eye"][1].dump() + "," + key["eye"][2].dump() + "," +
                             key["yaw_deg"].dump() + "," + key["pitch_deg"].dump();
  const std::string rest = " --camera " + camera + " --size 160x90 --renderer gl --offscreen osmesa -o ";
  const ProgramRun model = run_program("render city.prom --policy none" + rest + "model.png", folder());
  const ProgramRun source = run_program("render city.glb" + rest + "source.png", folder());
  ASSERT_EQ(model.exit_code, 0) << model.err;
  ASSERT_EQ(source.exit_code, 0) << source.err;
  const std::string compare =
      "cd '" + folder().string() +
      "' && idiff -q -fail 0.05 -failpercent 1 -warn 0.05 -warnpercent 1 model.png source.png >/dev/null";
  EXPECT_EQ(std::system(compare.c_str()), 0)
      << "colours differ by more than a twentieth in more than 1 % of the pixels";
}

TEST_F(SmallCity, verify_finds_one_changed_bit) {
  EXPECT_EQ(run_program("verify city.prom", folder()).exit_code, 0);
  fs::copy(folder() / "city.prom", folder() / "changed.prom", fs::copy_options::recursive);
  const fs::path file = folder() / "changed.prom" / "geometry.bin";
  std::string bytes = read_text(file);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(file, bytes);
  expect_one_clear_line(run_program("verify changed.prom", folder()), "geometry.bin");
}

TEST_F(SmallCity, verify_holds_pictures_against_the_source) {
  const ProgramRun run = run_program(
      "verify city.prom --cells 12 --views 4 --view-size 64 --aimed-views 5 --source city.glb --source-views 3 "
      "--size 320x180 --source-picture differences.png --json verify.json",
      folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "verify.json");
  EXPECT_EQ(figures["source_views"], 3);
  EXPECT_GT(figures["pixel_error_max_px"], 0);
  EXPECT_LE(figures["pixel_error_p99_px"], figures["pixel_error_max_px"]);
  EXPECT_LE(figures["pixel_error_max_px"], 1.5) << "the bound is one pixel at 720 lines; a corner stretches it";
  EXPECT_EQ(figures["false_hidden_nodes"], 0);
  EXPECT_GT(figures["rays_aimed_at_hidden_nodes"], 0);
  ASSERT_EQ(run_program("generate city --seed 9 --triangles 4000 -o other.glb", folder()).exit_code, 0);
  expect_one_clear_line(run_program("verify city.prom --cells 0 --source other.glb --source-views 1", folder()),
                        "triangles");
}

TEST_F(SmallCity, verify_holds_bounds_against_the_source) {
  const ProgramRun run = run_program(
      "verify city.prom --cells 0 --source city.glb --source-views 0 --points 20000 --json verify.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "verify.json");
  EXPECT_EQ(figures["points_on_source"], 10000);
  EXPECT_GE(figures["points_on_nodes"], 10000);
  EXPECT_EQ(figures["source_points_beyond_bound"], 0);
  EXPECT_EQ(figures["node_points_beyond_bound"], 0);
  EXPECT_GE(figures["bound_over_distance_median"], 1);
  EXPECT_LT(figures["bound_over_distance_median"], 3);
  EXPECT_FALSE(figures.contains("source_views") || figures.contains("error"));
  expect_one_clear_line(run_program("verify city.prom --cells 0 --points 10", folder()), "--source");
  ASSERT_EQ(run_program("generate city --seed 9 --triangles 4000 -o other.glb", folder()).exit_code, 0);
  expect_one_clear_line(
      run_program("verify city.prom --cells 0 --source other.glb --source-views 0 --points 10 --json failed.json",
                  folder()),
      "triangles");
  const json failed = json_in(folder() / "failed.json");
  EXPECT_EQ(failed["checksums_ok"], true) << "what was found before stays";
  EXPECT_NE(failed["error"].get<std::string>().find("triangles"), std::string::npos);
}

TEST_F(SmallCity, verify_goes_on_where_it_stopped) {
  const std::string words = "verify city.prom --cells 6 --views 2 --view-size 64 --aimed-views 2 --json ";
  const auto figures_of = [&](const std::string& file, const std::string& more) {
    const ProgramRun run = run_program(words + file + more, folder());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json_in(folder() / file);
  };
  const json whole = figures_of("whole.json", ""), stopped = figures_of("stopped.json", " --seconds 0 --skip-cells 6");
  EXPECT_EQ(whole["cells_left"], 0);
  EXPECT_EQ(stopped["rays_or_pixels_checked"], 0);
  const json end = figures_of("end.json", " --skip-cells 2");
  EXPECT_LT(end["rays_or_pixels_checked"], whole["rays_or_pixels_checked"]);
  // However soon it stops, what it says that is left is the rest.
  const json begin = figures_of("begin.json", " --seconds 0");
  const uint64_t left = begin["cells_left"];
  const json rest = figures_of("rest.json", " --skip-cells " + std::to_string(6 - left));
  for (const char* sum : {"rays_or_pixels_checked", "rays_aimed_at_hidden_nodes", "cells_checked", "cells_solid"})
    EXPECT_EQ(begin[sum].get<uint64_t>() + rest[sum].get<uint64_t>(), whole[sum].get<uint64_t>()) << sum;
}

TEST_F(SmallCity, a_corrupt_model_is_named_and_not_drawn) {
  fs::copy(folder() / "city.prom", folder() / "corrupt.prom", fs::copy_options::recursive);
  fs::resize_file(folder() / "corrupt.prom" / "tables.bin", 100);
  expect_one_clear_line(run_program("info corrupt.prom", folder()), "tables.bin");
}

TEST_F(SmallCity, ways_to_store_what_cells_see_are_compared) {
  const ProgramRun run = run_program("study codecs city.prom --export sets --json codecs.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "codecs.json");
  double of_blocks = 0, of_frames = 0;
  for (const json& codec : figures["codecs"]) {
    for (const char* name : {"bytes_per_delta_mean", "bytes_total", "encode_ids_per_s", "decode_ids_per_s"})
      EXPECT_TRUE(codec.contains(name)) << name;
    EXPECT_EQ(codec["default"].get<bool>(), codec["name"] == "blocks");
    if (codec["name"] == "blocks") of_blocks = codec["bytes_total"];
    if (codec["name"] == "zstd-frames") of_frames = codec["bytes_total"];
  }
  EXPECT_GT(of_blocks, 0);
  EXPECT_GT(of_frames, 0);
  EXPECT_LT(2 * of_blocks, of_frames);
  for (const char* file : {"sets/vlods.txt", "sets/deltas.txt", "sets/nodes.txt", "sets/walk.txt"})
    EXPECT_TRUE(fs::exists(folder() / file)) << file;
}

TEST_F(SmallCity, studies_along_a_path_leave_a_page_each) {
  for (const std::string part : {"codecs", "orders"}) {
    const ProgramRun run =
        run_program("study " + part + " city.prom --path city_walk.json --report page.html --json page.json", folder());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    std::ifstream in(folder() / "page.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_NE(page.find("city_walk.json"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "the page stands alone";
  }
}

TEST_F(SmallCity, table_1_is_made_of_as_many_columns_as_asked_for) {
  const ProgramRun run = run_program("study orders city.prom --table 3000 --json table.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "table.json");
  ASSERT_EQ(figures["table"].size(), 3U);
  for (const json& row : figures["table"]) {
    EXPECT_EQ(row["generated"].get<bool>(), row["columns"] > figures["nodes"]);
    for (const char* seed : {"greedy", "from_bisection"}) {
      const json& tour = row[seed];
      EXPECT_LE(tour["runs"], tour["runs_seed"]) << seed;
      EXPECT_LE(tour["runs"], row["runs_shuffled"]) << seed;
      if (row["runs_lower_bound"] > 0) {
        EXPECT_LE(row["runs_lower_bound"], tour["runs"]) << seed;
      }
    }
  }
  EXPECT_NE(run.out.find("| 3000"), std::string::npos);
}

TEST_F(SmallCity, a_build_tells_what_changes_between_cells) {
  const json build = json_in(folder() / "build.json");
  const ProgramRun run = run_program("study codecs city.prom --json codecs.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json study = json_in(folder() / "codecs.json");
  EXPECT_NEAR(double(build["delta_ids_mean"]), double(study["delta_ids_mean"]), 1e-9);
  for (const json& codec : study["codecs"])
    if (codec["default"]) {
      EXPECT_NEAR(double(build["delta_bytes_mean"]), double(codec["bytes_per_delta_mean"]), 1e-9);
    }
}

TEST_F(SmallCity, orders_of_nodes_are_compared_with_one_of_ones_own) {
  const size_t nodes = json_in(folder() / "build.json")["nodes"];
  std::ofstream own(folder() / "backwards.txt");
  for (size_t i = nodes; i-- > 0;) own << i << '\n';
  own.close();
  const ProgramRun run = run_program(
      "study orders city.prom --path city_walk.json --order file:backwards.txt --json orders.json", folder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json_in(folder() / "orders.json");
  std::map<std::string, double> runs;
  for (const json& order : figures["orders"]) {
    for (const char* name : {"reads_per_step_mean", "bytes_per_step_mean", "useful_share", "wall_s", "profiles"})
      EXPECT_TRUE(order.contains(name)) << name;
    runs[order["name"]] = order["runs_per_delta_mean"];
  }
  EXPECT_EQ(runs.at("file"), runs.at("input")) << "runs are the same from either end";
  EXPECT_LE(runs.at("tour"), runs.at("input"));
  for (const json& order : figures["orders"])
    if (order.contains("walk")) {
      EXPECT_GT(double(order["walk"]["ssd"]["useful_share"]), 0) << order["name"];
      EXPECT_LE(double(order["walk"]["ssd"]["useful_share"]), 1) << order["name"];
    }
  EXPECT_EQ(run_program("study orders city.prom --order backwards.txt", folder()).exit_code, 2);
  EXPECT_EQ(run_program("study orders city.prom --disk drum", folder()).exit_code, 2);
  expect_one_clear_line(run_program("study orders city.prom --order file:city_walk.json", folder()), "line 1");
}

TEST(Usage, errors_exit_with_2_and_help_with_0) {
  const TemporaryFolder folder;
  for (const char* words :
       {"", "dance", "build", "build x --nonsense", "fly x", "generate city", "generate village -o x.glb",
        "render x -o y.png", "render x -o y.png --camera 1,2,3", "build x -o y --memory lots",
        "fly x --path p --policy magic", "render x -o y.png --camera 0,0,0,0,0 --size 0x0"})
    EXPECT_EQ(run_program(words, folder.path()).exit_code, 2) << words;
  for (const char* words : {"--help", "--version", "generate --help", "build --help", "info --help", "render --help",
                            "fly --help", "view --help", "verify --help"}) {
    const ProgramRun run = run_program(words, folder.path());
    EXPECT_EQ(run.exit_code, 0) << words;
    EXPECT_FALSE(run.out.empty()) << words;
  }
}

TEST(Errors, name_the_file_and_leave_nothing_behind) {
  const TemporaryFolder folder;
  write_text(folder.path() / "broken.glb", "glTF, but not really");
  write_text(folder.path() / "empty.obj", "v 0 0 0\n");
  write_text(folder.path() / "path.json", "{}");
  expect_one_clear_line(run_program("build missing.glb -o m", folder.path()), "missing.glb");
  expect_one_clear_line(run_program("build broken.glb -o m", folder.path()), "broken.glb");
  expect_one_clear_line(run_program("build empty.obj -o m", folder.path()), "no triangles");
  expect_one_clear_line(run_program("info broken.glb", folder.path()), "broken.glb");
  expect_one_clear_line(run_program("fly missing --path path.json", folder.path()), "path.json");
  expect_one_clear_line(
      run_program("render empty.obj --camera 0,0,0,0,0 -o x.png --renderer gl --offscreen osmesa", folder.path()),
      "no triangles");
  EXPECT_FALSE(fs::exists(folder.path() / "m"));
  EXPECT_FALSE(fs::exists(folder.path() / "x.png"));
}

TEST(Building, one_triangle_is_a_model_that_can_be_looked_at) {
  const TemporaryFolder folder;
  write_text(folder.path() / "one.obj", "v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n");
  const ProgramRun build = run_program("build one.obj -o one.prom --json build.json", folder.path());
  ASSERT_EQ(build.exit_code, 0) << build.err;
  EXPECT_EQ(json_in(folder.path() / "build.json")["nodes"], 1);
  // The triangle lies on the ground (y up turned to z up); seen from above it fills the middle of the picture.
  const ProgramRun render =
      run_program("render one.prom --camera 0.3,0.3,1,0,-90 --size 64x64 --renderer gl --offscreen osmesa -o one.png",
                  folder.path());
  ASSERT_EQ(render.exit_code, 0) << render.err;
  EXPECT_GT(fs::file_size(folder.path() / "one.png"), 100U);
}

TEST(Footprints, a_city_in_cityjson_tells_the_plan_of_every_building) {
  const TemporaryFolder folder;
  const ProgramRun made = run_program("generate city --triangles 30000 -o c.city.jsonl --json g.json", folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const ProgramRun built = run_program("build c.city.jsonl -o c.prom --jobs 2", folder.path());
  ASSERT_EQ(built.exit_code, 0) << built.err;
  ASSERT_EQ(run_program("info c.prom --json i.json", folder.path()).exit_code, 0);
  const json told = json_in(folder.path() / "i.json"), there = json_in(folder.path() / "g.json");
  EXPECT_GE(told["footprints"], there["buildings"]) << "of a stepped tower several";
  EXPECT_GT(there["buildings"], 10);
}

}  // namespace
}  // namespace promenade
