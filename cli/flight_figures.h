#pragma once
// What a flight is told as: one JSON object, and a page to look at.

#include <string>
#include <vector>

#include "cli/command.h"
#include "runtime/flight.h"

namespace promenade {

/// How far the estimated frame times were from the actual ones, in percent of the actual: mean and standard deviation
/// over the frames. Positive: frames took longer than estimated ([lakhia2004] section 6.3, whose negative sign is a
/// conservative estimate).
struct EstimateError {
  double mean_percent = 0, stddev_percent = 0;
};
EstimateError estimate_error(const FlightReport& report, bool with_feedback);
/// The same of drawing alone, in processor time.
EstimateError estimate_cpu_error(const FlightReport& report);

/// The totals by their names.
Json totals_json(const FlightReport& report);

/// `fly --json`: a row a frame under "frames", their number under "frame_count", the totals by their names, the
/// loader's counts under "loader".
Json json_of(const FlightReport& report);

/// What a page says about where its figures come from.
struct FlightPage {
  std::string model, path, policy, renderer;
  double target_ms = 0;
  uint64_t memory_bytes = 0;
  struct Picture {
    uint32_t frame = 0;
    std::vector<std::byte> jpeg;
  };
  std::vector<Picture> pictures;
};

/// A self-contained HTML page: totals, pictures, and plots of frame times, estimates, memory against its bound, detail
/// by level, toggles (what [lakhia2004] plots in figures 6.1 to 6.6).
std::string html_of(const FlightReport& report, const FlightPage& page);

}  // namespace promenade
