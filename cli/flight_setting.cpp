#include "cli/flight_setting.h"

namespace promenade {

void add_flight_options(CLI::App& app, FlightSetting& setting) {
  app.add_option("MODEL", setting.model, "A directory that build made")->required();
  app.add_option("--path", setting.path_file, "The recorded path")->required()->type_name("FILE");
  app.add_option("--seconds", setting.seconds, "Fly only the first seconds of the path (0: all)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--teleport-every", setting.stay_s,
                 "Jump along the whole path and stay so many seconds at each place, for --seconds in all (0: travel)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("--settle", setting.settle, "Load what the first view asks for before the first frame");
  app.add_flag("--popping", setting.popping,
               "Measure how much of each picture popped: changed beyond what the camera's motion explains (slow)");
  add_fade_option(app, setting.view);
  add_frames_ahead_option(app, setting.view);
  add_prefetch_options(app, setting.view);
  add_camera_options(app, setting.view);
  add_far_style_option(app, setting.view);
  add_eye_culling_option(app, setting.view);
  add_policy_options(app, setting.view, kDefaultFlightPolicy, uint64_t(256) << 20);
  add_renderer_options(app, setting.view);
}

Result<OpenFlight> open_flight(const FlightSetting& setting) {
  const bool jumps = setting.stay_s > 0;
  Result<CameraPath> path = read_path(setting.path_file, jumps ? 0 : setting.seconds);
  if (!path) return path.error();
  if (jumps) *path = stops_along(*path, setting.stay_s, setting.seconds);
  Result<ModelReader> reader = ModelReader::open(setting.model);
  if (!reader) return reader.error();
  Result<OffscreenRenderer> offscreen = make_offscreen_renderer(setting.view);
  if (!offscreen) return offscreen.error();
  auto kept = std::make_unique<ModelReader>(std::move(*reader));
  std::unique_ptr<ModelSource> source = source_of(*kept);
  return OpenFlight{std::move(*path), std::move(kept), std::move(source), std::move(*offscreen)};
}

FlightOptions flight_options(const FlightSetting& setting) {
  FlightOptions options;
  options.session = setting.view.session;
  options.session.background = background_of(setting.view);
  options.width_px = setting.view.size.width;
  options.height_px = setting.view.size.height;
  options.vertical_fov_deg = setting.view.vertical_fov_deg;
  options.near_m = setting.view.near_m;
  options.settle_first = setting.settle;
  options.measure_popping = setting.popping;
  return options;
}

}  // namespace promenade
