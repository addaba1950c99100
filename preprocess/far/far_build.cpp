#include "preprocess/far/far_build.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "codec/frame.h"
#include "layout/model_folder.h"
#include "preprocess/unit_io.h"

namespace promenade {
namespace {

constexpr uint64_t kDrawingPart = 2;  // of the memory, as within a build

}  // namespace

Result<FarFigures> add_far_pictures(const std::filesystem::path& path, const FarOptions& options, uint64_t memory_bytes,
                                    uint32_t jobs, JobMonitor& monitor, FileSystem& files) {
  FarOptions wanted = options;
  wanted.pictures = true;
  PROMENADE_TRY(check_options(wanted));
  const std::filesystem::path model = without_trailing_slash(path);
  const Result<FileLock> lock = FileLock::acquire(beside(model, ".lock"), fmt::format("model {}", model.string()));
  if (!lock) return lock.error();
  Result<ModelWriter> writer = ModelWriter::extend(model, settings_of(wanted), files);
  if (!writer) return writer.error();
  const Result<WorkFolder> folder = WorkFolder::open(beside(model, ".work"), files);
  if (!folder) return folder.error();
  const Result<ModelReader> reader = ModelReader::open(writer->staged_folder(), files);
  if (!reader) return reader.error();
  UnitWriter hashed;
  hashed.text(reader->model().manifest.tool_version), hashed.value(reader->model().manifest.input_hash);
  tbb::task_arena arena(jobs == 0 ? tbb::task_arena::automatic : static_cast<int>(jobs));
  const Result<FarUnits> made = arena.execute([&] {
    return make_far(*reader, wanted, checksum(hashed.bytes()), memory_bytes / kDrawingPart, *folder, monitor);
  });
  if (!made) return made.error();
  PROMENADE_TRY(writer->add_far(made->tables, cells_of(*made, *folder)));
  PROMENADE_TRY(writer->publish());
  PROMENADE_TRY(folder->remove());
  return made->figures;
}

}  // namespace promenade
