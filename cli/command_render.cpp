#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/picture.h"
#include "cli/source_renderer.h"
#include "cli/view_options.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

struct RenderArguments {
  std::vector<std::filesystem::path> input;
  std::filesystem::path output;
  std::optional<Pose> camera;
  std::filesystem::path path_file;
  uint32_t every = 1;
  Aov aov = Aov::color;
  double time_s = 0;
  ViewOptions view;
  ImportOptions import;
};

Result<std::vector<Camera>> cameras_of(const RenderArguments& arguments) {
  if (arguments.camera) return std::vector<Camera>{camera_of(arguments.view, *arguments.camera)};
  const Result<CameraPath> path = read_path(arguments.path_file);
  if (!path) return path.error();
  std::vector<Camera> cameras;
  for (uint32_t frame = 0; frame < path->frame_count(); frame += arguments.every)
    cameras.push_back(camera_of(arguments.view, pose_of_frame(*path, frame)));
  return cameras;
}

std::filesystem::path name_of_view(const RenderArguments& arguments, size_t view, size_t count) {
  if (arguments.camera) return arguments.output;
  return numbered(arguments.output, static_cast<uint32_t>(view), static_cast<uint32_t>(count));
}

Status render_model(const RenderArguments& arguments, const std::vector<Camera>& cameras, Renderer& renderer,
                    JobMonitor& monitor, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.input.front());
  if (!reader) return reader.error();
  const std::unique_ptr<ModelSource> source = source_of(*reader);
  SessionOptions options = arguments.view.session;
  options.fade_frames = 0;  // still pictures
  options.background = background_of(arguments.view);
  options.frame_bytes =
      renderer.frame_bytes(arguments.view.size.width, arguments.view.size.height, has_see_through(source->model()));
  options.loader_thread = false;  // a still picture waits for what it needs, in the same order each time
  Result<Session> session = Session::open(*source, renderer, options);
  if (!session) return session.error();
  Json rows = Json::array();
  for (size_t i = 0; i < cameras.size(); ++i) {
    monitor.progress("render", i, cameras.size());
    if (monitor.cancelled()) return Error{"interrupted"};
    session->set_time(arguments.time_s);
    const Result<FrameRow> row = session->settle(cameras[i]);
    if (!row) return row.error();
    const Result<Frame> frame = read_frame(renderer, cameras[i].width_px, cameras[i].height_px, arguments.aov);
    if (!frame) return frame.error();
    const std::filesystem::path name = name_of_view(arguments, i, cameras.size());
    PROMENADE_TRY(write_frame(*frame, arguments.aov, name));
    rows.push_back({{"image", name.string()},
                    {"triangles_drawn", row->triangles_drawn},
                    {"nodes_drawn", row->nodes_drawn},
                    {"nodes_missing", row->nodes_missing},
                    {"far_triangles", row->far_triangles},
                    {"draw_ms", row->draw_ms}});
  }
  monitor.progress("render", cameras.size(), cameras.size());
  figures["source_triangles"] = reader->model().manifest.source_triangles;
  figures["views"] = rows;
  figures["resident_bytes_peak"] = session->resident_bytes_peak();
  return Done{};
}

Status render_untouched_source(const RenderArguments& arguments, const std::vector<Camera>& cameras, Renderer& renderer,
                               JobMonitor& monitor, Json& figures) {
  SourceRenderOptions options;
  options.sources = arguments.input;
  options.import = arguments.import;
  options.cameras = cameras;
  options.aov = arguments.aov;
  options.time_s = arguments.time_s;
  options.look.lighting = arguments.view.session.lighting;
  options.look.background = background_of(arguments.view);
  options.memory_bytes = arguments.view.session.loader.memory_bytes;
  SourceRenderFigures made;
  const Result<std::vector<Frame>> frames = render_source(options, renderer, made, monitor);
  if (!frames) return frames.error();
  Json rows = Json::array();
  for (size_t i = 0; i < frames->size(); ++i) {
    const std::filesystem::path name = name_of_view(arguments, i, frames->size());
    PROMENADE_TRY(write_frame((*frames)[i], arguments.aov, name));
    rows.push_back({{"image", name.string()}});
  }
  figures["source_triangles"] = made.triangles;
  figures["draw_ms_mean"] = made.draw_ms_mean;
  figures["views"] = rows;
  return Done{};
}

Status run_render(const RenderArguments& arguments, JobMonitor& monitor, Json& figures) {
  PROMENADE_TRY(check_picture_name(arguments.aov, arguments.output));
  const Result<std::vector<Camera>> cameras = cameras_of(arguments);
  if (!cameras) return cameras.error();
  const Result<OffscreenRenderer> offscreen = make_offscreen_renderer(arguments.view);
  if (!offscreen) return offscreen.error();
  figures["renderer"] = offscreen->description;
  const bool model = arguments.input.size() == 1 && is_model(arguments.input.front());
  const auto render = model ? render_model : render_untouched_source;
  PROMENADE_TRY(render(arguments, *cameras, *offscreen->renderer, monitor, figures));
  fmt::print("{} picture(s): {}\n", cameras->size(), name_of_view(arguments, 0, cameras->size()).string());
  return Done{};
}

}  // namespace

Command add_render(CLI::App& program) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* app =
      program.add_subcommand("render", "Draw pictures of a model, or of its untouched source by brute force");
  app->add_option("MODEL|SOURCE", arguments->input, "A model's directory, or source files and folders")->required();
  app->add_option("-o,--output", arguments->output,
                  "IMAGE: .png or .jpg; depth and node ids: .exr or .tif. With --path numbered")
      ->required();
  CLI::Option_group* where = app->add_option_group("camera", "Where to look from: one of");
  add_pose_option(*where, arguments->camera, "x,y,z,yaw,pitch in metres and degrees");
  where->add_option("--path", arguments->path_file, "A recorded path: a picture for each of its frames")
      ->type_name("FILE");
  where->require_option(1);
  app->add_option("--every", arguments->every, "With --path: only every so many frames")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_parsed<Aov>(*app, "--aov", arguments->aov, parse_aov,
                  "What the picture holds: color, depth (m along the view axis) or node")
      ->default_str("color");
  app->add_option("--time", arguments->time_s, "Where animated objects are: seconds from their animation's start")
      ->check(CLI::Number)
      ->capture_default_str();
  add_camera_options(*app, arguments->view);
  add_far_style_option(*app, arguments->view);
  add_eye_culling_option(*app, arguments->view);
  add_policy_options(*app, arguments->view, Policy::static_error, uint64_t(4) << 30);
  add_renderer_options(*app, arguments->view);
  add_import_options(*app, arguments->import);
  return {
      app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_render(*arguments, monitor, figures); }};
}

}  // namespace promenade
