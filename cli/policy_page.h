#pragma once
// Flights along one path side by side.

#include <string>
#include <vector>

#include "runtime/flight.h"

namespace promenade {

struct PolicyFlight {
  std::string policy;
  bool is_default = false;
  FlightReport report;
};

struct PolicyPage {
  std::string model, path, renderer;
  double target_ms = 0;
  uint64_t memory_bytes = 0;
};

/// A self-contained HTML page: a table with a column a policy, and a plot a statistic with a line a policy: those of
/// [funkhouser1993]'s table 3.3 and of [lakhia2004]'s chapter 6 that this runtime has.
std::string html_of(const std::vector<PolicyFlight>& flights, const PolicyPage& page);

}  // namespace promenade
