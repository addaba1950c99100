#include "cli/study_hiders.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <random>

#include "cli/console.h"
#include "cli/node_picture.h"
#include "layout/cell_front.h"
#include "layout/model_io.h"
#include "preprocess/visibility/audit.h"
#include "preprocess/visibility/hider_chain.h"
#include "preprocess/visibility/hiders/sampled.h"
#include "preprocess/visibility/study_cells.h"
#include "preprocess/visibility/visibility.h"

namespace promenade {
namespace {

struct StudyArguments {
  std::filesystem::path model;
  std::vector<std::string> chains;
  StudyCellOptions cells;
  std::string place = "street";
  LookOptions looks;
  double pixel_error = 1;
  uint32_t eyes = 0;  ///< in each cell, for what an eye sees
  std::filesystem::path picture;
};

/// Nodes and triangles drawn: mean and most of several.
struct Drawn {
  uint64_t count = 0, nodes = 0, triangles = 0, most_nodes = 0, most_triangles = 0;
  void add(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden) {
    uint64_t n = 0, t = 0;
    for (size_t i = 0; i < front.size(); ++i)
      if (hidden[i] == 0) ++n, t += model.tables.nodes[index_of(front[i])].triangles;
    ++count, nodes += n, triangles += t;
    most_nodes = std::max(most_nodes, n), most_triangles = std::max(most_triangles, t);
  }
};

/// A chain with its sums over the cells.
struct ChainRow {
  std::string name;
  std::vector<std::unique_ptr<Hider>> hiders;
  bool conservative = true, is_default = false;
  double prepare_s = 0, ms = 0, ratio_sum = 0, hidden_share_sum = 0;
  uint64_t false_hidden_nodes = 0, false_hidden_pixels = 0, kept_nodes = 0, kept_triangles = 0;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

Result<std::vector<ChainRow>> make_chains(const StudyArguments& arguments, const ModelReader& reader,
                                          JobMonitor& monitor) {
  const Result<std::vector<std::string>> usual = chain_for_model({std::string(kAutoHiders)}, reader, monitor);
  if (!usual) return usual.error();
  std::vector<std::string> lists = arguments.chains;
  if (lists.empty()) {
    lists.push_back("none");
    lists.insert(lists.end(), usual->begin(), usual->end());
    if (usual->size() > 1) lists.push_back(joined(*usual));
  }
  std::vector<ChainRow> rows;
  rows.reserve(lists.size());
  for (const std::string& list : lists) {
    Result<std::vector<std::string>> names = parse_hiders(list);
    if (!names) return names.error();
    if (list == kAutoHiders) names = *usual;
    const WallClock clock;
    Result<std::vector<std::unique_ptr<Hider>>> hiders = make_hiders(*names, reader, HiderBuildOptions(), monitor);
    if (!hiders) return hiders.error();
    ChainRow row;
    row.name = list, row.hiders = std::move(*hiders), row.is_default = *names == *usual;
    row.prepare_s = clock.seconds();
    for (const auto& hider : row.hiders) row.conservative &= hider->is_conservative();
    rows.push_back(std::move(row));
  }
  return rows;
}

/// One cell: the reference's time, the truth, and each chain against it.
class CellStudy {
 public:
  CellStudy(const StudyArguments& arguments, const NodeMeshes& meshes, std::vector<ChainRow>& rows)
      : arguments_(arguments),
        meshes_(meshes),
        rows_(rows),
        reference_(make_sampled_hider(meshes)),
        bound_{arguments.pixel_error, pixel_scale(1280, 720, 60)} {}

  Status add(const Box& cell) {
    const Model& model = meshes_.model().model();
    const std::vector<NodeId> front = cell_front(model, cell, bound_);
    const Result<Looks> looks = look_from_cell(meshes_, cell, front, {}, arguments_.looks);
    if (!looks) return looks.error();
    if (looks->eyes == 0) return Done{};
    ++cells;
    eyes += looks->eyes, pixels += looks->pixels;
    std::vector<uint8_t> none(front.size(), 0);
    const WallClock reference_clock;
    PROMENADE_TRY(reference_->hide({cell, front}, none));
    reference_ms += reference_clock.seconds() * 1e3;
    for (ChainRow& row : rows_) {
      std::vector<uint8_t> hidden(front.size(), 0);
      std::vector<uint8_t> hidden_by(front.size(), 0);  // 1 + the hider's place in the chain
      for (size_t h = 0; h < row.hiders.size(); ++h) {
        const WallClock clock;
        PROMENADE_TRY(row.hiders[h]->hide({cell, front}, hidden));
        row.ms += clock.seconds() * 1e3;
        for (size_t i = 0; i < front.size(); ++i)
          if (hidden[i] != 0 && hidden_by[i] == 0) hidden_by[i] = static_cast<uint8_t>(h + 1);
      }
      if (cells == 1 && &row == &rows_.back() && !arguments_.picture.empty())
        PROMENADE_TRY(draw_plan(cell, front, hidden_by, *looks));
      if (&row == &rows_.back() && arguments_.eyes > 0) PROMENADE_TRY(see_from_eyes(row, cell, front, hidden));
      const CellVerdict verdict = judge(model, front, hidden, *looks);
      row.ratio_sum += double(verdict.kept_triangles) / double(std::max<uint64_t>(verdict.seen_triangles, 1));
      row.hidden_share_sum +=
          1 - double(verdict.kept_triangles) / double(std::max<uint64_t>(verdict.front_triangles, 1));
      row.false_hidden_nodes += verdict.false_hidden_nodes;
      row.false_hidden_pixels += verdict.false_hidden_pixels;
      row.kept_nodes += verdict.kept_nodes, row.kept_triangles += verdict.kept_triangles;
      if (&row == &rows_.front()) front_nodes += verdict.front_nodes, seen_nodes += verdict.seen_nodes;
    }
    return Done{};
  }

  /// What is drawn when the chain is asked for an eye in the cell, and for what its view pyramid meets.
  Status see_from_eyes(const ChainRow& row, const Box& cell, std::span<const NodeId> front,
                       std::span<const uint8_t> hidden) {
    const Model& model = meshes_.model().model();
    cell_to_object.add(model, front, hidden);
    const auto unit = [this] { return double(random_() >> 11U) * 0x1p-53; };
    for (uint32_t i = 0; i < arguments_.eyes; ++i) {
      Camera camera;
      const double x = unit(), y = unit(), z = unit();
      camera.pose.eye = glm::dvec3(cell.min) + glm::dvec3(x, y, z) * glm::dvec3(cell.size());
      camera.pose.yaw_deg = 360 * unit();
      const Frustum frustum = frustum_of(camera, glm::dvec3(0));
      std::vector<uint8_t> unseen(hidden.begin(), hidden.end());
      for (size_t k = 0; k < front.size(); ++k)
        if (classify(frustum, model.tables.nodes[index_of(front[k])].box) == Overlap::outside) unseen[k] = 1;
      const glm::vec3 eye(camera.pose.eye);
      const WallClock clock;
      for (const auto& hider : row.hiders) PROMENADE_TRY(hider->hide({{eye, eye}, front}, unseen));
      eye_ms += clock.seconds() * 1e3;
      eye_to_object.add(model, front, unseen);
    }
    return Done{};
  }

  /// From above: seen green, kept though not seen orange, hidden grey (by the chain's first hider) and shades of blue.
  Status draw_plan(const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by,
                   const Looks& looks) const {
    const std::array<glm::u8vec3, 4> hiders = {
        glm::u8vec3(170, 170, 170), {130, 160, 230}, {90, 110, 200}, {150, 90, 200}};
    const auto color_of = [&](size_t i) {
      if (looks.pixels_of[i] > 0) return hidden_by[i] == 0 ? glm::u8vec3(80, 190, 90) : glm::u8vec3(255, 0, 0);
      return hidden_by[i] == 0 ? glm::u8vec3(250, 160, 40) : hiders[std::min<size_t>(hidden_by[i] - 1U, 3)];
    };
    const Model& model = meshes_.model().model();
    Box box;
    for (const NodeId root : model.tables.roots) box.add(model.tables.nodes[index_of(root)].box);
    return write_node_picture(meshes_, front, plan_view(box, 1200), color_of, cell, arguments_.picture);
  }

  uint64_t cells = 0, eyes = 0, pixels = 0, front_nodes = 0, seen_nodes = 0;
  double reference_ms = 0, eye_ms = 0;
  Drawn cell_to_object, eye_to_object;

 private:
  const StudyArguments& arguments_;
  const NodeMeshes& meshes_;
  std::vector<ChainRow>& rows_;
  std::unique_ptr<Hider> reference_;
  FrontBound bound_;
  std::mt19937_64 random_{1};
};

/// [funkhouser1993] table 7.3.
void print_cull_methods(const Model& model, const CellStudy& study, Json& figures) {
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
  row("eye-to-object", study.eye_to_object);
  const double eyes = double(std::max<uint64_t>(study.eye_to_object.count, 1));
  fmt::print("  {:.2f} ms an eye\n", study.eye_ms / eyes);
  figures["eye_ms"] = study.eye_ms / eyes;
}

void print_rows(const std::vector<ChainRow>& rows, const CellStudy& study) {
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

Json json_of(const std::vector<ChainRow>& rows, const CellStudy& study) {
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
          {"eyes", study.eyes},
          {"pixels", study.pixels},
          {"front_nodes_mean", double(study.front_nodes) / n},
          {"seen_nodes_mean", double(study.seen_nodes) / n}};
}

/// Random cells of the model's own, or of a place that has some.
Result<std::vector<Box>> cells_of(const StudyArguments& arguments, const NodeMeshes& meshes) {
  if (arguments.place != "cells") return study_cells(meshes, arguments.cells);
  const CellsReader* stored = meshes.model().cells();
  if (stored == nullptr || stored->tables().cells.empty())
    return Error{fmt::format("{}: the model has no view cells: try another --place", arguments.model.string())};
  std::mt19937_64 random(arguments.cells.seed);
  std::vector<Box> cells;
  cells.reserve(arguments.cells.cells);
  for (uint32_t i = 0; i < arguments.cells.cells; ++i)
    cells.push_back(stored->tables().cells[random() % stored->tables().cells.size()].box);
  return cells;
}

Status run_study(StudyArguments arguments, JobMonitor& monitor, Json& figures) {
  arguments.cells.place = arguments.place == "roof" ? StudyPlace::roof : StudyPlace::street;
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(*reader, uint64_t(1) << 30);
  if (!meshes) return meshes.error();
  Result<std::vector<ChainRow>> rows = make_chains(arguments, *reader, monitor);
  if (!rows) return rows.error();
  const Result<std::vector<Box>> cells = cells_of(arguments, **meshes);
  if (!cells) return cells.error();
  CellStudy study(arguments, **meshes, *rows);
  for (size_t i = 0; i < cells->size(); ++i) {
    monitor.progress("cells", i, cells->size());
    if (monitor.cancelled()) return Error{"interrupted"};
    PROMENADE_TRY(study.add((*cells)[i]));
  }
  monitor.progress("cells", cells->size(), cells->size());
  if (study.cells == 0)
    return Error{fmt::format("{}: no {} cells of {} m found: try another --place or --side", arguments.model.string(),
                             arguments.place, arguments.cells.side_m)};
  print_rows(*rows, study);
  figures = json_of(*rows, study);
  if (arguments.eyes > 0) print_cull_methods(reader->model(), study, figures);
  return Done{};
}

}  // namespace

Command add_study_hiders(CLI::App& study) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* app = study.add_subcommand("hiders", "What each hider and chain of hiders costs and is worth");
  app->add_option("MODEL", arguments->model, "A directory that build made")->required();
  app->add_option("--hiders", arguments->chains,
                  fmt::format("A chain, names separated by commas, of: {}; or auto; may be given several times. "
                              "Default: each hider of the chain that a build of this model uses, and the chain",
                              hider_names()))
      ->type_name("LIST")
      ->take_all();
  app->add_option("--cells", arguments->cells.cells, "Random cells")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app->add_option("--side", arguments->cells.side_m, "Side of a cell, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--place", arguments->place,
                  "street: on the ground, 2 m high; roof: cubes in the air; cells: of the model's own")
      ->check(CLI::IsMember({"street", "roof", "cells"}))
      ->capture_default_str();
  app->add_option("--views", arguments->looks.views, "Pictures of each cell that say what is seen")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--eyes", arguments->eyes,
                  "Eyes in each cell, for a table of what is drawn of the whole model, of what the last chain leaves "
                  "to the cell, and of what it leaves to an eye and its view of 60 degrees")
      ->capture_default_str();
  app->add_option("--pixel-error", arguments->pixel_error,
                  "Bound of the cells' fronts, pixels at 1280 x 720, 60 degrees")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--picture", arguments->picture,
                  "Plan of the first cell with the last chain, a .png: seen green, kept though not seen orange, hidden "
                  "grey (by the chain's first hider) and blue (by later ones), misses red")
      ->type_name("FILE");
  app->add_option("--seed", arguments->cells.seed, "Other cells, other views")->capture_default_str();
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) {
            arguments->looks.seed = arguments->cells.seed;
            return run_study(*arguments, monitor, figures);
          }};
}

}  // namespace promenade
