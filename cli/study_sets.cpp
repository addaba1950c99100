#include "cli/study_sets.h"

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>

#include "codec/id_set.h"
#include "layout/file_io.h"

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

Result<StudySets> read_study_sets(const ModelReader& reader, JobMonitor& monitor) {
  if (reader.cells() == nullptr) return Error{"the model has no view cells; build it with --cells auto"};
  const CellTables& tables = reader.cells()->tables();
  StudySets sets;
  for (uint32_t i = 0; i < tables.cells.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<Vlod> vlod = reader.cells()->read_vlod(CellId{i});
    if (!vlod) return vlod.error();
    std::vector<uint32_t>& ids = sets.vlods.emplace_back();
    for (const NodeId id : vlod->nodes) ids.push_back(index_of(id));
    monitor.progress("vLODs", i + 1, tables.cells.size());
  }
  for (const CellFace& face : tables.faces)
    sets.deltas.push_back(symmetric_difference(sets.vlods[index_of(face.below)], sets.vlods[index_of(face.above)]));
  return sets;
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
  return write_file(folder / "nodes.txt", std::string_view(text_of_nodes(reader.model().tables)));
}

}  // namespace promenade
