#include "cli/study_hiders.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <random>

#include "cli/hider_page.h"
#include "cli/hider_study.h"
#include "layout/file_io.h"
#include "layout/model_io.h"
#include "preprocess/visibility/hider_chain.h"
#include "preprocess/visibility/study_cells.h"

namespace promenade {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> models;
  std::vector<std::string> chains;
  std::vector<float> sides_m = {4};
  StudyCellOptions cells;
  std::string place = "street";
  std::vector<double> at;  ///< a point, world: x, y, z; empty: none
  bool list = false;
  HiderStudyOptions study;
  std::filesystem::path report_file;
};

/// [funkhouser1993] table 7.3.
void print_cull_methods(const Model& model, const HiderStudy& study, Json& figures) {
  const auto whole = double(std::max<uint64_t>(model.manifest.source_triangles, 1));
  fmt::print("  {:<20} {:>10} {:>10} {:>12} {:>12} {:>10} {:>10}\n", "cull method", "nodes", "most", "triangles",
             "most", "of model", "most");
  fmt::print("  {:<20} {:>10} {:>10} {:>12} {:>12} {:>9.2f}% {:>9.2f}%\n", "entire model", "", "",
             model.manifest.source_triangles, "", 100.0, 100.0);
  const auto row = [&](const char* name, const Drawn& drawn) {
    const double n = double(std::max<uint64_t>(drawn.count, 1));
    const double mean = double(drawn.triangles) / n;
    fmt::print("  {:<20} {:>10.1f} {:>10} {:>12.0f} {:>12} {:>9.2f}% {:>9.2f}%\n", name, double(drawn.nodes) / n,
               drawn.most_nodes, mean, drawn.most_triangles, 100 * mean / whole,
               100 * double(drawn.most_triangles) / whole);
    figures["cull_methods"].push_back({{"name", name},
                                       {"nodes_mean", double(drawn.nodes) / n},
                                       {"nodes_max", drawn.most_nodes},
                                       {"triangles_mean", mean},
                                       {"triangles_max", drawn.most_triangles},
                                       {"share_mean", mean / whole},
                                       {"share_max", double(drawn.most_triangles) / whole}});
  };
  row("cell-to-object", study.cell_to_object);
  row("of these, in view", study.in_view);
  row("eye-to-object", study.eye_to_object);
  const double eyes = double(std::max<uint64_t>(study.eye_to_object.count, 1));
  fmt::print("  {:.2f} ms an eye\n", study.eye_ms / eyes);
  figures["eye_ms"] = study.eye_ms / eyes;
}

void print_rows(const std::vector<ChainRow>& rows, const HiderStudy& study) {
  const double n = double(study.cells);
  fmt::print("{} cells; front {:.0f} nodes, seen {:.0f}; reference (125 eyes, 6 x 256 x 256 each) {:.1f} ms a cell\n",
             study.cells, double(study.front_nodes) / n, double(study.seen_nodes) / n, study.reference_ms / n);
  fmt::print("  {:<36} {:>10} {:>8} {:>8} {:>9} {:>12} {:>12} {:>9}\n", "chain", "ms a cell", "hidden", "ratio",
             "nodes", "false nodes", "false pixels", "prepare s");
  for (const ChainRow& row : rows)
    fmt::print("  {:<36} {:>10.2f} {:>7.1f}% {:>8.3f} {:>9.1f} {:>12} {:>12} {:>9.1f}{}\n", row.name, row.ms / n,
               100 * row.hidden_share_sum / n, row.ratio_sum / n, double(row.kept_nodes) / n, row.false_hidden_nodes,
               row.false_hidden_pixels, row.prepare_s, row.conservative ? "" : "  not conservative");
}

/// Each cell with the last chain, those that keep most beside what is seen first.
void print_cells(std::vector<StudiedCell> cells) {
  std::stable_sort(cells.begin(), cells.end(),
                   [](const StudiedCell& a, const StudiedCell& b) { return a.ratio() > b.ratio(); });
  fmt::print("  {:>7} {:>6} {:>6} {:>6} {:>9} {:>9} {:>5}  {}\n", "ratio", "front", "kept", "seen", "triangles", "seen",
             "eyes", "cell, m");
  for (const StudiedCell& cell : cells) {
    const CellVerdict& v = cell.verdict;
    const Box& b = cell.box;
    fmt::print("  {:>7.3f} {:>6} {:>6} {:>6} {:>9} {:>9} {:>5}  {:.2f},{:.2f},{:.2f} to {:.2f},{:.2f},{:.2f}\n",
               cell.ratio(), v.front_nodes, v.kept_nodes, v.seen_nodes, v.kept_triangles, v.seen_triangles, cell.eyes,
               b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z);
  }
}

Json json_of(const std::vector<StudiedCell>& studied) {
  Json cells = Json::array();
  for (const StudiedCell& cell : studied)
    cells.push_back({{"min", {cell.box.min.x, cell.box.min.y, cell.box.min.z}},
                     {"max", {cell.box.max.x, cell.box.max.y, cell.box.max.z}},
                     {"front_nodes", cell.verdict.front_nodes},
                     {"kept_nodes", cell.verdict.kept_nodes},
                     {"seen_nodes", cell.verdict.seen_nodes},
                     {"overestimate_ratio", cell.ratio()}});
  return cells;
}

Json json_of(const std::vector<ChainRow>& rows, const HiderStudy& study) {
  const double n = double(study.cells);
  Json chains = Json::array();
  for (const ChainRow& row : rows) {
    Json entry = {{"name", row.name},
                  {"ms_per_cell", row.ms / n},
                  {"hidden_share", row.hidden_share_sum / n},
                  {"overestimate_ratio_mean", row.ratio_sum / n},
                  {"false_hidden_nodes", row.false_hidden_nodes},
                  {"false_hidden_pixels", row.false_hidden_pixels},
                  {"nodes_mean", double(row.kept_nodes) / n},
                  {"triangles_mean", double(row.kept_triangles) / n},
                  {"conservative", row.conservative},
                  {"prepare_s", row.prepare_s}};
    if (row.is_default) entry["default"] = true;
    chains.push_back(std::move(entry));
  }
  return {{"chains", chains},
          {"reference_ms_per_cell", study.reference_ms / n},
          {"cells", study.cells},
          {"studied", json_of(study.studied)},
          {"eyes", study.eyes},
          {"pixels", study.pixels},
          {"front_nodes_mean", double(study.front_nodes) / n},
          {"seen_nodes_mean", double(study.seen_nodes) / n}};
}

/// Random cells of the model's own, the one that holds a point, or some of a place.
Result<std::vector<Box>> cells_of(const Arguments& arguments, const StudyCellOptions& options,
                                  const NodeMeshes& meshes) {
  if (arguments.place != "cells" && arguments.at.empty()) return study_cells(meshes, options);
  const CellsReader* stored = meshes.model().cells();
  if (stored == nullptr || stored->tables().cells.empty()) return Error{"has no view cells: try another --place"};
  if (!arguments.at.empty()) {
    const glm::dvec3 at(arguments.at[0], arguments.at[1], arguments.at[2]);
    const std::optional<CellId> cell = cell_at(stored->tables(), at - meshes.model().model().manifest.origin);
    if (!cell) return Error{fmt::format("no view cell holds {},{},{}", at.x, at.y, at.z)};
    return std::vector<Box>{stored->tables().cells[index_of(*cell)].box};
  }
  std::mt19937_64 random(options.seed);
  std::vector<Box> cells;
  cells.reserve(options.cells);
  for (uint32_t i = 0; i < options.cells; ++i)
    cells.push_back(stored->tables().cells[random() % stored->tables().cells.size()].box);
  return cells;
}

HiderFigures figures_of(const std::vector<ChainRow>& rows, const HiderStudy& study) {
  const double n = double(study.cells);
  HiderFigures figures;
  figures.cells = study.cells;
  figures.reference_ms_per_cell = study.reference_ms / n;
  for (const ChainRow& row : rows)
    figures.chains.push_back({row.name, row.ms / n, row.hidden_share_sum / n, row.ratio_sum / n,
                              double(row.kept_nodes) / n, double(row.kept_triangles) / n, row.false_hidden_nodes,
                              row.false_hidden_pixels});
  return figures;
}

/// What is told of all models and sides.
struct Told {
  Json json = Json::array();
  std::vector<HiderFigures> figures;
};

Status study_side(const Arguments& arguments, const NodeMeshes& meshes, const std::string& model, float side_m,
                  std::vector<ChainRow>& rows, JobMonitor& monitor, Told& told) {
  StudyCellOptions options = arguments.cells;
  options.place = arguments.place == "roof" ? StudyPlace::roof : StudyPlace::street;
  options.side_m = side_m;
  const Result<std::vector<Box>> cells = cells_of(arguments, options, meshes);
  if (!cells) return Error{fmt::format("{}: {}", model, cells.error().message)};
  for (ChainRow& row : rows) row.restart();
  HiderStudyOptions study_options = arguments.study;
  if (!told.figures.empty()) study_options.picture.clear();  // of the first study alone
  HiderStudy study(study_options, meshes, rows);
  for (size_t i = 0; i < cells->size(); ++i) {
    monitor.progress("cells", i, cells->size());
    if (monitor.cancelled()) return Error{"interrupted"};
    PROMENADE_TRY(study.add((*cells)[i]));
  }
  monitor.progress("cells", cells->size(), cells->size());
  if (study.cells == 0) {  // other sides, other models may have some
    fmt::print("{}: no {} cells of {} m found\n", model, arguments.place, side_m);
    return Done{};
  }
  const bool own = arguments.place == "cells" || !arguments.at.empty();
  if (arguments.models.size() > 1 || arguments.sides_m.size() > 1)
    fmt::print("{}{}: ", model, own ? "" : fmt::format(", {} cells of {} m", arguments.place, side_m));
  print_rows(rows, study);
  if (arguments.list) print_cells(study.studied);
  Json json = json_of(rows, study);
  HiderFigures figures = figures_of(rows, study);
  json["model"] = figures.model = model;
  json["model_triangles"] = figures.model_triangles = meshes.model().model().manifest.source_triangles;
  figures.side_m = own ? 0 : double(side_m);
  if (!own) json["side_m"] = side_m;
  if (arguments.study.eyes > 0) print_cull_methods(meshes.model().model(), study, json);
  told.json.push_back(std::move(json));
  told.figures.push_back(std::move(figures));
  return Done{};
}

Status study_model(const Arguments& arguments, const std::filesystem::path& path, JobMonitor& monitor, Told& told) {
  const Result<ModelReader> reader = ModelReader::open(path);
  if (!reader) return reader.error();
  const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(*reader, uint64_t(1) << 30);
  if (!meshes) return meshes.error();
  Result<std::vector<ChainRow>> rows = make_chains(arguments.chains, *reader, monitor);
  if (!rows) return rows.error();
  const std::string name = (path.has_filename() ? path : path.parent_path()).stem().string();
  for (const float side_m : arguments.sides_m) {
    PROMENADE_TRY(study_side(arguments, **meshes, name, side_m, *rows, monitor, told));
    if (arguments.place == "cells" || !arguments.at.empty()) break;  // these have sides of their own
  }
  return Done{};
}

Status run_study(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  Told told;
  for (const std::filesystem::path& model : arguments.models)
    PROMENADE_TRY(study_model(arguments, model, monitor, told));
  if (told.json.empty()) return Error{"no cells found: try another --place or --side"};
  figures = told.json.front();
  if (told.json.size() > 1) figures["studies"] = told.json;
  if (arguments.report_file.empty()) return Done{};
  const std::string subtitle =
      fmt::format("{} random {} cells each; the reference takes 6 pictures of 256 x 256 from each of 125 eyes",
                  arguments.cells.cells, arguments.place);
  PROMENADE_TRY(write_file(arguments.report_file, std::string_view(html_of(told.figures, subtitle))));
  fmt::print("report: {}\n", arguments.report_file.string());
  return Done{};
}

}  // namespace

Command add_study_hiders(CLI::App& study) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = study.add_subcommand("hiders", "What each hider and chain of hiders costs and is worth");
  app->add_option("MODEL", arguments->models, "Directories that build made: one, or several to compare")->required();
  app->add_option("--hiders", arguments->chains,
                  fmt::format("A chain, names separated by commas, of: {}; or auto; may be given several times. "
                              "Default: each hider of the chain that a build of the model uses, and the chain",
                              hider_names()))
      ->type_name("LIST")
      ->take_all();
  app->add_option("--cells", arguments->cells.cells, "Random cells")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app->add_option("--side", arguments->sides_m, "Side of a cell, m; several, separated by commas: one after the other")
      ->delimiter(',')
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--place", arguments->place,
                  "street: on the ground, 2 m high; roof: cubes in the air; cells: of the model's own")
      ->check(CLI::IsMember({"street", "roof", "cells"}))
      ->capture_default_str();
  app->add_option("--views", arguments->study.looks.views, "Pictures of each cell that say what is seen")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--aimed-views", arguments->study.looks.aimed_views,
                  fmt::format("Besides, as many again from other eyes, and narrow pictures of {} rays, aimed at "
                              "triangles of nodes that the last chain keeps and no picture shows",
                              LookOptions::kAimedPx * LookOptions::kAimedPx))
      ->capture_default_str();
  app->add_option("--eyes", arguments->study.eyes,
                  "Eyes in each cell, for a table of what is drawn of the whole model, of what the last chain leaves "
                  "to the cell, and of what it leaves to an eye and its view of 60 degrees")
      ->capture_default_str();
  app->add_option("--at", arguments->at, "Only the model's own cell that holds this point, m")
      ->delimiter(',')
      ->expected(3)
      ->type_name("x,y,z");
  app->add_flag("--list", arguments->list, "A line for each cell: what the last chain keeps there, and what is seen");
  app->add_option("--pixel-error", arguments->study.pixel_error,
                  "Bound of the cells' fronts, pixels at 1280 x 720, 60 degrees")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--picture", arguments->study.picture,
                  "Plan of the first cell with the last chain, a .png: seen green, kept though not seen orange, hidden "
                  "grey (by the chain's first hider) and blue (by later ones), misses red")
      ->type_name("FILE");
  app->add_option("--report", arguments->report_file,
                  "Write a page with the figures, and plots of cost and quality by size of cells and of models")
      ->type_name("FILE.html");
  app->add_option("--seed", arguments->cells.seed, "Other cells, other views")->capture_default_str();
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) {
            arguments->study.looks.seed = arguments->cells.seed;
            return run_study(*arguments, monitor, figures);
          }};
}

}  // namespace promenade
