#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "layout/model_io.h"

namespace promenade {

Command add_verify(CLI::App& program) {
  auto path = std::make_shared<std::filesystem::path>();
  CLI::App* app =
      program.add_subcommand("verify", "Check a model's integrity: its tables, and every segment against its checksum");
  app->add_option("MODEL", *path, "A directory that build made")->required();
  return {app, {}, [path](JobMonitor& monitor, Json& figures) -> Status {
            const Result<ModelReader> reader = ModelReader::open(*path);
            if (!reader) return reader.error();
            PROMENADE_TRY(verify_checksums(*reader, monitor));
            const size_t segments = reader->model().tables.segments.size();
            figures = {{"checksums_ok", true}, {"segments_checked", segments}};
            fmt::print("{}: sound, {} segments checked\n", path->string(), segments);
            return Done{};
          }};
}

}  // namespace promenade
