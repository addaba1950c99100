#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <memory>

#include "cli/console.h"
#include "cli/far_command.h"
#include "cli/view_options.h"
#include "preprocess/far/far_build.h"

namespace promenade {
namespace {

constexpr double kPlacesASecond = 30;

/// The places of a recorded path, close together, from its start to its end.
Result<std::vector<glm::dvec3>> places_of_path(const std::filesystem::path& file) {
  const Result<CameraPath> path = read_path(file);
  if (!path) return path.error();
  std::vector<glm::dvec3> places;
  const auto steps = static_cast<uint32_t>(std::ceil(path->duration_s() * kPlacesASecond));
  places.reserve(steps + 1);
  for (uint32_t i = 0; i <= steps; ++i)
    places.push_back(pose_at(*path, path->keys.front().t_s + std::min(i / kPlacesASecond, path->duration_s())).eye);
  return places;
}

struct Arguments {
  std::filesystem::path model;
  FarOptions far;
  uint64_t memory_bytes = uint64_t(4) << 30;
  uint32_t jobs = 0;
};

}  // namespace

void add_far_options(CLI::App& group, FarOptions& o) {
  group
      .add_option("--far-bound", o.bound_deg,
                  "Largest parallax of what is far, from anywhere in its view cell, degrees")
      ->capture_default_str();
  group
      .add_option("--far-box", o.box_m, "Length of the box within which geometry is drawn, m (0: a sixth of the model)")
      ->capture_default_str();
  group
      .add_option("--far-cell", o.cell_m,
                  "Length of a view cell, m (0: what flat pictures allow; with depth four times that)")
      ->capture_default_str();
  group
      .add_option(
          "--far-shells", o.shells,
          "Boxes around each other: pictures of what lies between two, those of the outer ones for many view cells")
      ->capture_default_str();
  group
      .add_option_function<std::string>(
          "--far-spacing",
          [&o](const std::string& how) {
            o.spacing = how == "linear" ? ShellSpacing::linear : ShellSpacing::exponential;
          },
          "How their boxes grow: linear (each --far-factor times as long) or exponential (each to the power of it)")
      ->check(CLI::IsMember({"linear", "exponential"}))
      ->default_str("linear");
  group
      .add_option("--far-factor", o.spacing_factor,
                  "By what they grow (0: evenly from the innermost towards the model's size)")
      ->capture_default_str();
  group.add_flag("!--far-flat", o.depth, "Pictures lie flat on the box's sides: small view cells, no depths");
  group.add_option("--far-side", o.side_px, "Pixels of a picture's side, 2^n + 1 (0: by the bound, 513 or 1025)")
      ->capture_default_str();
  group.add_option("--far-quality", o.jpeg_quality, "JPEG quality of pictures, 1 to 100 (0: PNG, exact)")
      ->capture_default_str();
  group.add_flag("--far-deltas", o.deltas,
                 "Store pictures by their differences from a neighbour's where that is shorter");
  group.add_option("--far-max-cells", o.max_cells, "Do not begin with more view cells than this")
      ->capture_default_str();
  group
      .add_option_function<double>(
          "--far-height", [&o](double height_m) { o.height_m = height_m; },
          "View cells only this high above what one may stand on, m (default: up to the sky)")
      ->check(CLI::PositiveNumber);
  group
      .add_option_function<std::string>(
          "--far-path",
          [&o](const std::string& file) {
            Result<std::vector<glm::dvec3>> places = places_of_path(file);
            if (!places) throw CLI::ValidationError("--far-path", places.error().message);
            o.along.insert(o.along.end(), places->begin(), places->end());
          },
          "View cells only where this recorded path goes (may be given several times)")
      ->type_name("FILE");
}

Json json_of(const FarFigures& f) {
  Json shells = Json::array();
  for (const FarShellFigures& s : f.shells)
    shells.push_back(
        {{"box_m", s.box_m}, {"cell_m", s.cell_m}, {"cells", s.cells}, {"faces", s.faces}, {"bytes", s.bytes}});
  return {{"cells", f.cells},
          {"cells_with_pictures", f.cells_with_pictures},
          {"faces", f.faces},
          {"faces_told", f.faces_told},
          {"cell_m", f.cell_m},
          {"box_m", f.box_m},
          {"side_px", f.side_px},
          {"parallax_max_deg", glm::degrees(f.parallax_max_rad)},
          {"triangles_mean", f.triangles_mean},
          {"bytes_mean", f.bytes_mean},
          {"texel_bytes_mean", f.texel_bytes_mean},
          {"ms_per_cell", f.ms_per_cell},
          {"cells_computed", f.cells_computed},
          {"shells", std::move(shells)}};
}

void print_far(const FarFigures& far) {
  fmt::print(
      "  far pictures from {} view cells of {:.1f} m in boxes of {:.0f} m: {:.0f} triangles and {} a cell, {:.2f} "
      "degrees off at most, {:.0f} ms a cell\n",
      far.cells_with_pictures, far.cell_m, far.box_m, far.triangles_mean,
      human_bytes(static_cast<uint64_t>(far.bytes_mean)), glm::degrees(far.parallax_max_rad), far.ms_per_cell);
  if (far.shells.size() < 2) return;
  for (const FarShellFigures& shell : far.shells)
    fmt::print("    shell of {:.0f} m: {} cells of {:.1f} m, {}\n", shell.box_m, shell.cells, shell.cell_m,
               human_bytes(shell.bytes));
}

Command add_far(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = program.add_subcommand(
      "far", "Make the far pictures of a built model, for the policies stratified and vlod-stratified");
  app->add_option("MODEL", arguments->model, "A directory that build made; what far pictures it has are replaced")
      ->required();
  add_far_options(*app, arguments->far);
  add_parsed<uint64_t>(*app, "--memory", arguments->memory_bytes, parse_bytes, "Bound on resident memory")
      ->default_str("4GiB");
  app->add_option("--jobs", arguments->jobs, "Threads (0: as many as cores); the bytes are the same")
      ->capture_default_str();
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) -> Status {
            const WallClock clock;
            const Result<FarFigures> made =
                add_far_pictures(arguments->model, arguments->far, arguments->memory_bytes, arguments->jobs, monitor);
            if (!made) return made.error();
            figures = {{"far", json_of(*made)}, {"far_wall_s", clock.seconds()}};
            print_far(*made);
            return Done{};
          }};
}

}  // namespace promenade
