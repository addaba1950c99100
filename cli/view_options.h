#pragma once
// Options that render, fly and view share: how a model is looked at.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/values.h"
#include "geometry/path.h"
#include "runtime/gl_context.h"
#include "runtime/gl_renderer.h"
#include "runtime/session.h"

namespace promenade {

struct ViewOptions {
  PixelSize size;
  double vertical_fov_deg = 60;
  double near_m = 0.1;
  SessionOptions session;
  RendererKind renderer = RendererKind::automatic;
  bool close_gaps = false;
  OffscreenKind offscreen = OffscreenKind::automatic;
  bool no_sky = false;
};

/// --size, --fov: the picture alone.
void add_frame_options(CLI::App& app, ViewOptions& options);
/// --size, --fov, --near, --no-sky: the camera and what it sees where nothing is.
void add_camera_options(CLI::App& app, ViewOptions& options);
/// --pixel-error, --error-kind: how fine a front is.
void add_error_options(CLI::App& app, double& pixel_error, ErrorKind& kind);
/// --camera x,y,z,yaw,pitch.
void add_pose_option(CLI::App& app, std::optional<Pose>& pose, const std::string& help);
/// --renderer.
void add_renderer_option(CLI::App& app, ViewOptions& options);
/// --renderer, --offscreen.
void add_renderer_options(CLI::App& app, ViewOptions& options);
/// --policy, --pixel-error, --memory, --target-ms, --disk-*, and the policies' constants.
void add_policy_options(CLI::App& app, ViewOptions& options, Policy default_policy, uint64_t default_memory_bytes);

/// --prefetch-s, --range-*: what is loaded beforehand.
void add_prefetch_options(CLI::App& app, ViewOptions& options);
/// --far-style: what policies with far pictures draw of near and far.
void add_far_style_option(CLI::App& app, ViewOptions& options);
/// --fade-frames: for what shows frame after frame.
void add_fade_option(CLI::App& app, ViewOptions& options);
/// --frames-ahead: for the same.
void add_eye_culling_option(CLI::App& app, ViewOptions& options);
void add_frames_ahead_option(CLI::App& app, ViewOptions& options);

Camera camera_of(const ViewOptions& options, const Pose& pose);
Background background_of(const ViewOptions& options);

/// A renderer without a window, and the context under it (null for the CPU's), in the order in which they must go.
struct OffscreenRenderer {
  std::unique_ptr<GlContext> context;
  std::unique_ptr<Renderer> renderer;
  std::string description;  ///< for reports
  std::string name;         ///< the renderer's alone, for what is stored about it
};
Result<OffscreenRenderer> make_offscreen_renderer(const ViewOptions& options);

/// What drawing costs with it on this machine, measured on first use (runtime/draw_costs.h).
Result<DrawCosts> draw_costs_of(const OffscreenRenderer& offscreen);

/// A recorded path from its file; only its first seconds, or all of it (0).
Result<CameraPath> read_path(const std::filesystem::path& file, double seconds = 0);

/// Whether a path names a model (else it is taken for a source).
bool is_model(const std::filesystem::path& path);

}  // namespace promenade
