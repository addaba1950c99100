#pragma once
// What the studies of codecs and orders look at: every cell's vLOD, the deltas across faces, the cells along a path.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "cli/command.h"
#include "geometry/job_monitor.h"
#include "layout/model_io.h"

namespace promenade {

using IdSets = std::vector<std::vector<uint32_t>>;

/// What both studies are told.
struct StudyArguments {
  std::filesystem::path model;
  std::filesystem::path path_file;      ///< empty: every face is as likely
  std::filesystem::path export_folder;  ///< empty: nothing is exported
  std::filesystem::path report_file;    ///< empty: no page
};
/// model, --path, --export, --report.
void add_study_arguments(CLI::App& app, StudyArguments& arguments);

struct StudySets {
  IdSets vlods;                ///< by cell: node ids, ascending
  IdSets deltas;               ///< by face: the ids that are in one of the two vLODs
  std::vector<uint32_t> walk;  ///< the cells that the path goes through, each as often as it is entered
};

/// An open model, and what there is to study in it.
struct StudyInput {
  ModelReader reader;
  StudySets sets;
};
/// Opens, reads, exports. Errors: the model's or the path's; no cells; the path meets none; interruption.
Result<StudyInput> open_study(const StudyArguments& arguments, JobMonitor& monitor);

/// Writes vlods.txt (a cell a line: its nodes), deltas.txt (a face a line: the cells below and above, then the nodes
/// that change), walk.txt (a cell a line; empty without a path) and nodes.txt (a node a line: parent or -1, stored
/// bytes of its mesh, center x y z in metres), numbers in ascending order separated by blanks. Makes the folder.
Status export_study_sets(const std::filesystem::path& folder, const ModelReader& reader, const StudySets& sets);

/// Mean and 99th percentile of sizes; zeros without any.
struct SizeFigures {
  double mean = 0;
  uint64_t p99 = 0;
};
SizeFigures size_figures(std::vector<uint64_t> sizes);

}  // namespace promenade
