#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/verify_cells.h"
#include "cli/verify_points.h"
#include "cli/verify_source.h"
#include "preprocess/visibility/hider_chain.h"

namespace promenade {
namespace {

struct VerifyArguments {
  std::filesystem::path model;
  VerifyCellsOptions cells;
  VerifySourceOptions source;
  uint64_t points = 0;
};

Result<Policy> parse_policy(const std::string& text) {
  if (const std::optional<Policy> policy = policy_named(text)) return *policy;
  return Error{fmt::format("\"{}\" is no policy: {}", text, policy_names())};
}

Status run_verify(const VerifyArguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  PROMENADE_TRY(verify_checksums(*reader, monitor));
  const size_t segments = reader->model().tables.segments.size();
  figures = {{"checksums_ok", true}, {"segments_checked", segments}};
  fmt::print("{}: sound, {} segments checked\n", arguments.model.string(), segments);
  if (arguments.points > 0) {
    if (arguments.source.sources.empty()) return Error{"--points needs the model's source: --source"};
    PROMENADE_TRY(
        verify_points({arguments.source.sources, arguments.source.import, arguments.points, arguments.cells.looks.seed},
                      *reader, monitor, figures));
  }
  if (!arguments.source.sources.empty() && arguments.source.views > 0) {
    VerifySourceOptions source = arguments.source;
    source.seed = arguments.cells.looks.seed, source.pixel_error = arguments.cells.pixel_error;
    PROMENADE_TRY(verify_source(source, *reader, monitor, figures));
  }
  if (arguments.cells.cells == 0 || (reader->cells() == nullptr && arguments.cells.hiders.empty())) return Done{};
  VerifyCellsOptions cells = arguments.cells;
  cells.model = arguments.model;
  return verify_cells(cells, *reader, monitor, figures);
}

void add_cell_check(CLI::App& app, VerifyCellsOptions& o) {
  CLI::Option_group* group = app.add_option_group("cells", "Is anything hidden that can be seen?");
  o.looks.around = false, o.looks.picture_px = 512, o.looks.views = 50, o.looks.aimed_views = 50;
  group->add_option("--cells", o.cells, "Random view cells to look around in (0: none)")->capture_default_str();
  group
      ->add_option("--skip-cells", o.skip_cells,
                   "Leave out the first so many of these, which an earlier run has checked")
      ->capture_default_str();
  group
      ->add_option("--seconds", o.seconds,
                   "Begin no cell later than so many seconds after the first, and say how to go on")
      ->check(CLI::NonNegativeNumber)
      ->type_name("S");
  group->add_option("--views", o.looks.views, "Random pictures from each cell, half of them from its boundary")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  group->add_option("--view-size", o.looks.picture_px, "Side of such a picture, pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  group
      ->add_option("--aimed-views", o.looks.aimed_views,
                   fmt::format("Besides, narrow pictures a cell of {} rays, aimed at triangles of hidden nodes",
                               LookOptions::kAimedPx * LookOptions::kAimedPx))
      ->capture_default_str();
  group
      ->add_option("--hiders", o.hiders,
                   fmt::format("Check what this chain hides instead of what the model stores; of: {}. A model without "
                               "cells is checked in random places",
                               hider_names()))
      ->type_name("LIST");
  group->add_option("--picture", o.picture, "The view with most misses, hidden nodes in red, if any: a .png")
      ->type_name("FILE");
}

void add_source_check(CLI::App& app, VerifySourceOptions& o) {
  CLI::Option_group* group = app.add_option_group("source", "Are the pictures those of the source?");
  group->add_option("--source", o.sources, "The files or folders that the model was built from: pictures are compared")
      ->type_name("SOURCE");
  group->add_option("--source-views", o.views, "Random views from where somebody may stand (0: none)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  group->add_option("--path", o.path, "A recorded path: that many views evenly along it instead")->type_name("FILE");
  add_parsed<PixelSize>(*group, "--size", o.size, parse_size, "Their pictures, pixels")->default_str("1280x720");
  group->add_option("--fov", o.vertical_fov_deg, "Their vertical field of view, degrees")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
  add_parsed<Policy>(*group, "--policy", o.policy, parse_policy,
                     fmt::format("Which nodes the model's pictures show, one of: {}", policy_names()))
      ->default_str(std::string(name_of(Policy::static_error)));
  group
      ->add_option("--source-picture", o.picture,
                   "The view with most differing colours: source, model, difference; a .png or .jpg")
      ->type_name("FILE");
  add_import_options(*group, o.import);
}

}  // namespace

Command add_verify(CLI::App& program) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* app = program.add_subcommand(
      "verify",
      "Check a model: every byte against its checksum, that nothing is hidden that can be seen, pictures against the "
      "source's");
  app->add_option("MODEL", arguments->model, "A directory that build made")->required();
  app->add_option("--pixel-error", arguments->cells.pixel_error,
                  "Bound of the fronts (stored cells: their own), pixels at 1280 x 720, 60 degrees")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--seed", arguments->cells.looks.seed, "Other cells, other views")->capture_default_str();
  add_cell_check(*app, arguments->cells);
  add_source_check(*app, arguments->source);
  app->add_option(
      "--points", arguments->points,
      "With --source: so many random points on the source and on the nodes of every level, each held against "
      "the bounds of the nodes");
  return {
      app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_verify(*arguments, monitor, figures); }};
}

}  // namespace promenade
