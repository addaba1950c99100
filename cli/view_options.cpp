#include "cli/view_options.h"

#include <fmt/format.h>

#include "layout/file_io.h"
#include "runtime/calibration.h"
#include "runtime/cpu_renderer.h"

namespace promenade {
namespace {

Result<Policy> parse_policy(const std::string& text) {
  if (const std::optional<Policy> policy = policy_named(text)) return *policy;
  return Error{fmt::format("\"{}\" is no policy: {}", text, policy_names())};
}

Result<ErrorKind> parse_error_kind(const std::string& text) {
  if (text == "bound") return ErrorKind::bound;
  if (text == "p99") return ErrorKind::p99;
  return Error{fmt::format("\"{}\" is no kind of error: bound or p99", text)};
}

Result<RangeCull> parse_range_cull(const std::string& text) {
  if (const std::optional<RangeCull> cull = range_cull_named(text)) return *cull;
  return Error{fmt::format("\"{}\" is no cull of cells: any, plane or direction", text)};
}

Result<OffscreenKind> parse_offscreen(const std::string& text) {
  if (const std::optional<OffscreenKind> kind = offscreen_kind_named(text)) return *kind;
  return Error{fmt::format("\"{}\" is no way to draw offscreen: automatic, osmesa or egl", text)};
}

Result<RendererKind> parse_renderer(const std::string& text) {
  if (text == "auto") return RendererKind::automatic;
  if (text == "gl") return RendererKind::gl;
  if (text == "cpu") return RendererKind::cpu;
  return Error{fmt::format("\"{}\" is no renderer: gl, cpu or auto", text)};
}

}  // namespace

void add_frame_options(CLI::App& app, ViewOptions& options) {
  add_parsed<PixelSize>(app, "--size", options.size, parse_size, "Picture size, pixels")->default_str("1280x720");
  app.add_option("--fov", options.vertical_fov_deg, "Vertical field of view, degrees")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
}

void add_camera_options(CLI::App& app, ViewOptions& options) {
  add_frame_options(app, options);
  app.add_option("--near", options.near_m, "Nearest distance that is drawn, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--no-sky", options.no_sky, "Black where there is no surface");
}

void add_error_options(CLI::App& app, double& pixel_error, ErrorKind& kind) {
  app.add_option("--pixel-error", pixel_error, "Projected error that is allowed, pixels")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_parsed<ErrorKind>(app, "--error-kind", kind, parse_error_kind,
                        "Which error that is: bound (nothing is farther off) or p99 (99 % of the surface is nearer)")
      ->default_str("bound");
}

void add_pose_option(CLI::App& app, std::optional<Pose>& pose, const std::string& help) {
  app.add_option_function<std::string>(
      "--camera",
      [&pose](const std::string& text) {
        const Result<Pose> parsed = parse_pose(text);
        if (!parsed) throw CLI::ValidationError("--camera", parsed.error().message);
        pose = *parsed;
      },
      help);
}

void add_renderer_option(CLI::App& app, ViewOptions& options) {
  add_parsed<RendererKind>(app, "--renderer", options.renderer, parse_renderer,
                           "gl (OpenGL), cpu (the visibility buffer), auto: the faster one here, measured once")
      ->default_str("auto");
}

void add_renderer_options(CLI::App& app, ViewOptions& options) {
  add_renderer_option(app, options);
  app.add_flag(
      "--close-gaps", options.close_gaps,
      "With the cpu renderer: close gaps between nodes that rounding leaves, some pixels in a thousand million, "
      "for a seventh of a frame's time");
  add_parsed<OffscreenKind>(app, "--offscreen", options.offscreen, parse_offscreen,
                            "OpenGL without a display: osmesa (CPU), egl (GPU), automatic")
      ->default_str("automatic");
}

namespace {

void add_benefit_options(CLI::App& app, BenefitOptions& benefit) {
  CLI::Option_group* group = app.add_option_group(
      "cost-benefit", "What drawing is worth to the cost-benefit policy; a weight of 0: no such factor");
  group->add_option("--half-error", benefit.half_error_px, "Error at which half of the worth is lost, pixels")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  const auto add_weight = [group](const char* name, double& weight, const char* help) {
    group->add_option(name, weight, help)->check(CLI::Range(0.0, 1.0))->capture_default_str();
  };
  add_weight("--focus-weight", benefit.focus_weight, "Lost at the picture's corners");
  add_weight("--motion-weight", benefit.motion_weight, "Lost by what moves as fast as its triangles are large");
  add_weight("--benefit-hysteresis", benefit.hysteresis_weight, "Lost by levels that were not shown the frame before");
}

}  // namespace

void add_prefetch_options(CLI::App& app, ViewOptions& options) {
  SelectOptions& select = options.session.select;
  RangeOptions& range = options.session.range;
  CLI::Option_group* group = app.add_option_group("prefetch", "What is read before it is wanted");
  group->add_option("--prefetch-s", select.prefetch_s, "Load what will be wanted so much later, s (0: only what is)")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  group->add_option("--range-s", range.horizon_s, "Read what is seen from cells that can be reached so soon, s")
      ->check(CLI::Range(0.0, 600.0))
      ->capture_default_str();
  group->add_option("--range-cells", range.most_cells, "No more of them than this")->capture_default_str();
  add_parsed<RangeCull>(*group, "--range-cull", range.cull, parse_range_cull,
                        "Which of them: any, plane (not behind the movement), direction (met by its line)")
      ->default_str(std::string(name_of(range.cull)));
}

void add_fade_option(CLI::App& app, ViewOptions& options) {
  app.add_option("--fade-frames", options.session.fade_frames,
                 "Frames in which a switch between levels fades (0: it pops)")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
}

void add_eye_culling_option(CLI::App& app, ViewOptions& options) {
  app.add_flag("--eye-culling", options.session.select.eye_culling,
               "Of what the eye's cell sees, leave out what this eye does not see through the openings in walls (for "
               "models built with --openings)");
}

void add_frames_ahead_option(CLI::App& app, ViewOptions& options) {
  constexpr int kMost = 64;  // as far as [funkhouser1993] went
  app.add_option(
         "--frames-ahead", options.session.frames_ahead,
         "Choose so many frames while earlier ones are drawn: more frames a second where a processor is free for "
         "it, each shown that much later (0: the quickest response)")
      ->check(CLI::Range(0, kMost))
      ->capture_default_str();
}

namespace {

Result<FarStyle> parse_far_style(const std::string& text) {
  if (const std::optional<FarStyle> style = far_style_named(text)) return *style;
  return Error{fmt::format("\"{}\" is no style: full, near or far", text)};
}

}  // namespace

void add_far_style_option(CLI::App& app, ViewOptions& options) {
  add_parsed<FarStyle>(app, "--far-style", options.session.far_style, parse_far_style,
                       "With far pictures: full, near (geometry only) or far (pictures only)")
      ->default_str("full");
}

void add_policy_options(CLI::App& app, ViewOptions& options, Policy default_policy, uint64_t default_memory_bytes) {
  SelectOptions& select = options.session.select;
  LoaderOptions& loader = options.session.loader;
  TimeSliceOptions& time = select.time;
  select.policy = default_policy;
  loader.memory_bytes = default_memory_bytes;
  add_parsed<Policy>(app, "--policy", select.policy, parse_policy, fmt::format("What to draw: {}", policy_names()))
      ->default_str(std::string(name_of(default_policy)));
  add_error_options(app, select.pixel_error, select.error_kind);
  add_parsed<uint64_t>(app, "--memory", loader.memory_bytes, parse_bytes, "Bound on all resident model data")
      ->default_str(default_memory_bytes >= (uint64_t(1) << 30) ? fmt::format("{}GiB", default_memory_bytes >> 30)
                                                                : fmt::format("{}MiB", default_memory_bytes >> 20));
  app.add_option_function<uint32_t>(
         "--texture-side", [&loader](uint32_t side) { loader.texture_side = side; },
         "Halve pictures that nodes share until no side has more pixels (0: never; else: as far as --memory asks for)")
      ->type_name("PIXELS");
  app.add_option("--target-ms", time.target_ms, "Frame time to aim at, ms")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option_function<double>(
         "--disk-mbps", [&loader](double mbps) { loader.disk_mbps = mbps; },
         "Emulate a disk of so many megabytes a second")
      ->check(CLI::PositiveNumber);
  app.add_option("--disk-seek-ms", loader.disk_seek_ms, "Emulated time of a read elsewhere, ms")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option(
         "--along-share", loader.along_share,
         "Part of the most important node's priority at which a node that lies where the disk is goes first (0: "
         "never)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--error-hysteresis", select.error_hysteresis,
                 "Part of --pixel-error by which a finer level must be finer than asked for before it is given up")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  app.add_flag(
      "!--no-fit-memory", select.fit_memory,
      "Ask for what --pixel-error asks for where it does not fit into --memory, too, instead of a coarser bound");
  add_benefit_options(app, select.benefit);
  app.add_option_function<std::vector<std::string>>(
         "--class-weight",
         [&options](const std::vector<std::string>& given) {
           for (const std::string& one : given) {
             const Result<std::pair<std::string, double>> weight = parse_weight(one);
             if (!weight) throw CLI::ValidationError("--class-weight", weight.error().message);
             options.session.class_weights.insert_or_assign(weight->first, weight->second);
           }
         },
         "How much what the source calls CLASS matters (info MODEL lists them; others: 1)")
      ->type_name("CLASS=WEIGHT")
      ->delimiter(',');
  CLI::Option_group* group = app.add_option_group("time slices", "Constants of the time-slices and lakhia policies");
  group->add_option("--hysteresis-switch", time.hysteresis_switch, "Threshold at which a node's level changes")
      ->capture_default_str();
  group->add_option("--hysteresis-limit", time.hysteresis_limit, "Range of the hysteresis counter")
      ->capture_default_str();
  group->add_option("--visibility-weight", time.visibility_weight, "Weight of being in the frustum")
      ->capture_default_str();
  group->add_option("--foreshortening-weight", time.foreshortening_weight, "Weight of facing the viewer")
      ->capture_default_str();
  group->add_option("--textured-weight", time.textured_weight, "Cost of a textured triangle, 1 less it of another")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group->add_flag("!--no-hysteresis", time.hysteresis, "Switch levels at once");
  group->add_flag("!--no-time-feedback", time.time_feedback, "Keep the first estimate of the time a triangle takes");
  group->add_flag("!--no-share-feedback", time.share_feedback, "Keep the time that is shared out at the target");
  group->add_flag("!--visible-children", time.all_children_resident,
                  "Refine as soon as all visible children are resident");
}

Camera camera_of(const ViewOptions& options, const Pose& pose) {
  return {pose, options.size.width, options.size.height, options.vertical_fov_deg, options.near_m};
}

Background background_of(const ViewOptions& options) {
  Background background;
  background.sky = !options.no_sky;
  return background;
}

namespace {

Result<OffscreenRenderer> gl_renderer_on(std::unique_ptr<GlContext> context) {
  Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(*context);
  if (!renderer) return renderer.error();
  const std::string description = context->description();
  return OffscreenRenderer{std::move(context), std::move(*renderer), description, description};
}

OffscreenRenderer on_the_cpu(const ViewOptions& options, const std::string& why) {
  return {nullptr, create_cpu_renderer({.close_gaps = options.close_gaps}), "cpu: visibility buffer" + why, "cpu"};
}

/// Both renderers, a few frames each.
Result<Calibration> measure_both(OffscreenKind offscreen) {
  Result<std::unique_ptr<GlContext>> context = create_offscreen_context(offscreen);
  if (!context) return context.error();
  const Result<OffscreenRenderer> gl = gl_renderer_on(std::move(*context));
  if (!gl) return gl.error();
  return calibrate(*gl->renderer, gl->description);
}

/// The faster one on this machine, and why in its description.
Result<OffscreenRenderer> faster_renderer(const ViewOptions& options) {
  const OffscreenKind offscreen = options.offscreen;
  const std::string way(name_of(offscreen));
  const std::filesystem::path file = calibration_file(way);
  const Result<Calibration> known =
      calibrated(file, calibration_machine(way), [offscreen] { return measure_both(offscreen); });
  if (!known) return on_the_cpu(options, fmt::format(" (auto: no OpenGL: {})", known.error().message));
  const std::string why = fmt::format(" ({})", reason_of(*known, file));
  if (known->cpu_is_faster()) return on_the_cpu(options, why);
  Result<std::unique_ptr<GlContext>> context = create_offscreen_context(offscreen);
  if (!context) return on_the_cpu(options, fmt::format(" (auto: OpenGL is gone: {})", context.error().message));
  Result<OffscreenRenderer> gl = gl_renderer_on(std::move(*context));
  if (gl) gl->description += why;
  return gl;
}

}  // namespace

Result<OffscreenRenderer> make_offscreen_renderer(const ViewOptions& options) {
  if (options.renderer == RendererKind::cpu) return on_the_cpu(options, "");
  if (options.renderer == RendererKind::gl) {
    Result<std::unique_ptr<GlContext>> context = create_offscreen_context(options.offscreen);
    if (!context) return context.error();
    return gl_renderer_on(std::move(*context));
  }
  Result<OffscreenRenderer> chosen = faster_renderer(options);
  if (chosen) fmt::print(stderr, "renderer: {}\n", chosen->description);
  return chosen;
}

Result<DrawCosts> draw_costs_of(const OffscreenRenderer& offscreen) {
  return draw_costs_here(*offscreen.renderer, offscreen.name);
}

namespace {

/// Only the first seconds of a path; 0: all of it.
CameraPath cut_short(CameraPath path, double seconds) {
  if (seconds <= 0 || seconds >= path.duration_s()) return path;
  const double end = path.keys.front().t_s + seconds;
  const Pose last = pose_at(path, end);
  std::erase_if(path.keys, [end](const CameraPath::Key& key) { return key.t_s >= end; });
  path.keys.push_back({end, last});
  return path;
}

}  // namespace

Result<CameraPath> read_path(const std::filesystem::path& file, double seconds) {
  constexpr uint64_t kLargestPath = uint64_t(256) << 20;  // a key takes about 100 bytes: two million of them
  const Result<std::string> text = read_text_file(file, kLargestPath);
  if (!text) return text.error();
  Result<CameraPath> path = parse_path(*text, file.string());
  if (!path) return path.error();
  return cut_short(std::move(*path), seconds);
}

bool is_model(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path / "manifest.json", ignored);
}

}  // namespace promenade
