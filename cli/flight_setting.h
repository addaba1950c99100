#pragma once
// What a flight needs before it starts, for the commands that fly: the model, the path, the renderer, the constants.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/view_options.h"
#include "layout/model_io.h"
#include "runtime/flight.h"

namespace promenade {

constexpr Policy kDefaultFlightPolicy = Policy::vlod_time_slices;

/// The options that every command which flies takes.
struct FlightSetting {
  std::filesystem::path model, path_file;
  double seconds = 0;  ///< of the path; 0: all
  double stay_s = 0;   ///< at places along the whole path, with jumps between; 0: travel
  bool settle = false, popping = false;
  ViewOptions view;
};

/// MODEL, --path, --seconds, --teleport-every, --settle, --popping, and those of the camera, the policies and the
/// renderer.
void add_flight_options(CLI::App& app, FlightSetting& setting);

/// A setting whose model, path and renderer are open.
struct OpenFlight {
  CameraPath path;
  std::unique_ptr<ModelReader> reader;  ///< outlives source
  std::unique_ptr<ModelSource> source;
  OffscreenRenderer offscreen;
};
/// Errors: what of them cannot be read or made.
Result<OpenFlight> open_flight(const FlightSetting& setting);

/// How to fly as the setting says: every frame of the path, without the machine's draw costs.
FlightOptions flight_options(const FlightSetting& setting);

}  // namespace promenade
