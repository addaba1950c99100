#include "cli/study_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>

#include "cli/view_options.h"
#include "codec/id_set.h"
#include "layout/file_io.h"
#include "runtime/cursor.h"

namespace promenade {
namespace {

std::string line_of(const std::vector<uint32_t>& ids) { return fmt::format("{}\n", fmt::join(ids, " ")); }

std::string text_of_nodes(const ModelTables& tables) {
  std::string text;
  for (const NodeRecord& node : tables.nodes) {
    const glm::vec3 center = node.box.center();
    const int64_t parent = node.parent == kNoNode ? -1 : int64_t(index_of(node.parent));
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {}\n", parent, tables.segments[node.segment].stored_bytes,
                   center.x, center.y, center.z);
  }
  return text;
}

}  // namespace

namespace {

Result<StudySets> read_sets(const ModelReader& reader, JobMonitor& monitor) {
  if (reader.cells() == nullptr) return Error{"the model has no view cells; build it with --cells auto"};
  const CellTables& tables = reader.cells()->tables();
  StudySets sets;
  sets.vlods.reserve(tables.cells.size());
  for (uint32_t i = 0; i < tables.cells.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<Vlod> vlod = reader.cells()->read_vlod(CellId{i});
    if (!vlod) return vlod.error();
    std::vector<uint32_t>& ids = sets.vlods.emplace_back();
    ids.reserve(vlod->nodes.size());
    for (const NodeId id : vlod->nodes) ids.push_back(index_of(id));
    monitor.progress("vLODs", i + 1, tables.cells.size());
  }
  sets.deltas.reserve(tables.faces.size());
  for (const CellFace& face : tables.faces)
    sets.deltas.push_back(symmetric_difference(sets.vlods[index_of(face.below)], sets.vlods[index_of(face.above)]));
  return sets;
}

Result<std::vector<uint32_t>> cells_along(const std::filesystem::path& file, const ModelReader& reader) {
  const Result<CameraPath> path = read_path(file);
  if (!path) return path.error();
  Cursor cursor(&reader.cells()->tables());
  std::vector<uint32_t> walk;
  for (uint32_t frame = 0; frame < path->frame_count(); ++frame) {
    cursor.move_to(pose_of_frame(*path, frame).eye - reader.model().manifest.origin);
    const std::optional<CellId> cell = cursor.cell();
    if (cell && (walk.empty() || walk.back() != index_of(*cell))) walk.push_back(index_of(*cell));
  }
  if (walk.size() < 2)
    return Error{fmt::format("{}: takes no step from one view cell to another: {} of them met in {} frames",
                             file.string(), walk.size(), path->frame_count())};
  return walk;
}

}  // namespace

void add_study_arguments(CLI::App& app, StudyArguments& arguments) {
  app.add_option("model", arguments.model, "Model with view cells")->required();
  app.add_option("--path", arguments.path_file, "Steps as this camera path takes them (default: across every face)");
  app.add_option("--export", arguments.export_folder,
                 "Folder for vlods.txt, deltas.txt, walk.txt and nodes.txt: the same data as plain text");
  app.add_option("--report", arguments.report_file, "HTML page with the tables and plots");
}

Result<StudyInput> open_study(const StudyArguments& arguments, JobMonitor& monitor) {
  Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  Result<StudySets> sets = read_sets(*reader, monitor);
  if (!sets) return sets.error();
  if (!arguments.path_file.empty()) {
    Result<std::vector<uint32_t>> walk = cells_along(arguments.path_file, *reader);
    if (!walk) return walk.error();
    sets->walk = std::move(*walk);
  }
  if (!arguments.export_folder.empty()) PROMENADE_TRY(export_study_sets(arguments.export_folder, *reader, *sets));
  return StudyInput{std::move(*reader), std::move(*sets)};
}

SizeFigures size_figures(std::vector<uint64_t> sizes) {
  if (sizes.empty()) return {};
  std::sort(sizes.begin(), sizes.end());
  const double sum =
      std::accumulate(sizes.begin(), sizes.end(), 0.0, [](double a, uint64_t b) { return a + double(b); });
  return {sum / double(sizes.size()), sizes[(sizes.size() - 1) * 99 / 100]};
}

Status export_study_sets(const std::filesystem::path& folder, const ModelReader& reader, const StudySets& sets) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return Error{fmt::format("{}: cannot make the folder: {}", folder.string(), failed.message())};
  std::string vlods, deltas;
  for (const std::vector<uint32_t>& vlod : sets.vlods) vlods += line_of(vlod);
  const std::vector<CellFace>& faces = reader.cells()->tables().faces;
  for (size_t i = 0; i < faces.size(); ++i)
    deltas += fmt::format("{} {}{}{}", index_of(faces[i].below), index_of(faces[i].above),
                          sets.deltas[i].empty() ? "" : " ", line_of(sets.deltas[i]));
  PROMENADE_TRY(write_file(folder / "vlods.txt", std::string_view(vlods)));
  PROMENADE_TRY(write_file(folder / "deltas.txt", std::string_view(deltas)));
  std::string walk;
  for (const uint32_t cell : sets.walk) walk += fmt::format("{}\n", cell);
  PROMENADE_TRY(write_file(folder / "walk.txt", std::string_view(walk)));
  return write_file(folder / "nodes.txt", std::string_view(text_of_nodes(reader.model().tables)));
}

}  // namespace promenade
