#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/view_options.h"
#include "layout/model_io.h"
#include "runtime/viewer.h"

namespace promenade {
namespace {

struct ViewArguments {
  std::filesystem::path model;
  std::optional<Pose> camera;
  std::filesystem::path folder = ".";
  ViewOptions view;
};

Status run_view(const ViewArguments& arguments, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  const std::unique_ptr<ModelSource> source = source_of(*reader);
  ViewerOptions options;
  options.session = arguments.view.session;
  options.session.background = background_of(arguments.view);
  options.renderer = arguments.view.renderer;
  options.width_px = arguments.view.size.width;
  options.height_px = arguments.view.size.height;
  options.vertical_fov_deg = arguments.view.vertical_fov_deg;
  options.near_m = arguments.view.near_m;
  options.start = arguments.camera;
  options.folder = arguments.folder;
  options.title = fmt::format("Promenade: {}", arguments.model.filename().string());
  const Result<ViewerReport> report = view(*source, options);
  if (!report) return report.error();
  figures = {{"frames", report->frames}, {"frame_ms_mean", report->frame_ms_mean}};
  for (const std::filesystem::path& file : report->screenshots) fmt::print("{}\n", file.string());
  for (const std::filesystem::path& file : report->paths) fmt::print("{}\n", file.string());
  return Done{};
}

}  // namespace

Command add_view(CLI::App& program) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* app = program.add_subcommand("view", "Walk and fly through a model in a window");
  app->add_option("MODEL", arguments->model, "A directory that build made")->required();
  add_pose_option(*app, arguments->camera,
                  "Where to start: x,y,z,yaw,pitch in metres and degrees (default: before the model)");
  app->add_option("--folder", arguments->folder, "Where screenshots and recorded paths go")->capture_default_str();
  add_camera_options(*app, arguments->view);
  add_fade_option(*app, arguments->view);
  add_prefetch_options(*app, arguments->view);
  add_renderer_option(*app, arguments->view);
  add_policy_options(*app, arguments->view, Policy::vlod_time_slices, uint64_t(256) << 20);
  app->footer(
      "Keys: left mouse button look; W A S D, arrows, space, C move; Q E roll; wheel speed; F straighten; H panel; P "
      "screenshot;\n"
      "R record a path; Escape leave.");
  return {app, {}, [arguments](JobMonitor&, Json& figures) { return run_view(*arguments, figures); }};
}

}  // namespace promenade
