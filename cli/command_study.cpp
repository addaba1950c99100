#include <memory>

#include "cli/command.h"
#include "cli/study_geometry.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

struct StudyArguments {
  std::filesystem::path model;
  StudyGeometryOptions geometry;
};

}  // namespace

Command add_study(CLI::App& program) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* app = program.add_subcommand("study", "Compare ways of doing one thing, on a model's own data");
  app->require_subcommand(1);
  CLI::App* geometry = app->add_subcommand("geometry", "Codecs and grids of the nodes' meshes: bits, speed, rounding");
  geometry->add_option("MODEL", arguments->model, "A directory that build made")->required();
  geometry->add_option("--nodes", arguments->geometry.nodes, "How many nodes to code, evenly spread")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->fallthrough();
  geometry->fallthrough();
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) -> Status {
            const Result<ModelReader> reader = ModelReader::open(arguments->model);
            if (!reader) return reader.error();
            return study_geometry(*reader, arguments->geometry, monitor, figures);
          }};
}

}  // namespace promenade
