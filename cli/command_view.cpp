#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/view_options.h"
#include "layout/model_io.h"
#include "runtime/viewer.h"
#include "runtime/viewer_settings.h"

namespace promenade {
namespace {

struct ViewArguments {
  std::filesystem::path model;
  std::optional<Pose> camera;
  std::filesystem::path folder = ".";
  std::filesystem::path path_file;
  std::filesystem::path settings_file = viewer_settings_file();
  const CLI::App* app = nullptr;
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
  if (!arguments.path_file.empty()) {
    Result<CameraPath> path = read_path(arguments.path_file);
    if (!path) return path.error();
    options.replay = std::move(*path);
    if (!options.start) options.start = pose_of_frame(options.replay, 0);
  }
  std::error_code ignored;
  options.settings_file = arguments.settings_file;
  options.model_name = std::filesystem::absolute(arguments.model, ignored).lexically_normal().string();
  options.keep_policy = arguments.app->count("--policy") == 0;
  options.keep_pixel_error = arguments.app->count("--pixel-error") == 0;
  options.keep_target = arguments.app->count("--target-ms") == 0;
  const Result<ViewerReport> report = view(*source, options);
  if (!report) return report.error();
  figures = {{"frames", report->frames},
             {"frame_ms_mean", report->frame_ms_mean},
             {"response_ms_mean", report->response_ms_mean}};
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
  app->add_option("--path", arguments->path_file, "A recorded path to fly along at once; any key takes over")
      ->type_name("FILE");
  app->add_option("--settings", arguments->settings_file,
                  "Where policy, speed and bookmarks are kept from visit to visit (empty: nowhere)")
      ->capture_default_str();
  arguments->app = app;
  app->add_option("--folder", arguments->folder, "Where screenshots and recorded paths go")->capture_default_str();
  add_camera_options(*app, arguments->view);
  add_fade_option(*app, arguments->view);
  add_frames_ahead_option(*app, arguments->view);
  add_prefetch_options(*app, arguments->view);
  add_renderer_option(*app, arguments->view);
  add_far_style_option(*app, arguments->view);
  add_eye_culling_option(*app, arguments->view);
  add_policy_options(*app, arguments->view, Policy::vlod_time_slices, uint64_t(256) << 20);
  app->footer(
      "Keys: left mouse button look; double click go there; W A S D, arrows, space, C move; G walk or fly; Q E roll;\n"
      "wheel speed; F straighten; Home back to the start; 1-9 to a bookmark, Ctrl + 1-9 set it; B bird's eye (wheel:\n"
      "height); V boxes of nodes in false colours; T what moves stops, or goes on; H panel; P screenshot; R record a "
      "path;\n"
      "L replay it; Escape leave.");
  return {app, {}, [arguments](JobMonitor&, Json& figures) { return run_view(*arguments, figures); }};
}

}  // namespace promenade
