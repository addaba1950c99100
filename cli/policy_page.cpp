#include "cli/policy_page.h"

#include <fmt/format.h>

#include <functional>
#include <optional>

#include "cli/console.h"
#include "cli/flight_figures.h"
#include "cli/plot.h"
#include "cli/report_page.h"

namespace promenade {
namespace {

constexpr size_t kWindow = 35;  // frames; Lakhia figures 6.4 and 6.6

/// A statistic of a frame. The name in brackets is [funkhouser1993]'s, table 3.3, where it differs.
struct Statistic {
  const char* title;
  const char* unit;
  std::function<double(const FrameRow&)> value;
  bool averaged = false;  ///< over kWindow frames
  bool from_zero = true;
};

double mib(uint64_t bytes) { return double(bytes) / double(1 << 20); }

const std::vector<Statistic>& statistics() {
  static const std::vector<Statistic> all = {
      {"Frame time", "ms", [](const FrameRow& r) { return r.frame_ms; }},
      {"Response time: from reading the pose to the finished picture", "ms",
       [](const FrameRow& r) { return r.response_ms; }},
      {"Selection (visibility, detail elision and lookahead time)", "ms",
       [](const FrameRow& r) { return r.select_ms; }},
      {"Drawing (rendering time)", "ms", [](const FrameRow& r) { return r.draw_ms; }},
      {"Handing loaded nodes to the renderer", "ms", [](const FrameRow& r) { return r.upload_ms; }},
      {"Actual against estimated frame time, moving average of 35 frames", "%",
       [](const FrameRow& r) { return r.frame_ms > 0 ? 100 * (r.frame_ms - r.estimated_ms) / r.frame_ms : 0; }, true,
       false},
      {"Triangles drawn (rendered polygons)", "count", [](const FrameRow& r) { return double(r.triangles_drawn); }},
      {"Nodes drawn (rendered objects)", "count", [](const FrameRow& r) { return double(r.nodes_drawn); }},
      {"Nodes that fade out", "count", [](const FrameRow& r) { return double(r.nodes_fading); }},
      {"Toggles between levels, moving average of 35 frames", "a frame",
       [](const FrameRow& r) { return double(r.toggles); }, true},
      {"Nodes missing: an ancestor stood in (levels of detail skipped)", "count",
       [](const FrameRow& r) { return double(r.nodes_missing); }},
      {"Popped: pixels changed beyond what motion explains", "per million",
       [](const FrameRow& r) { return r.popped_share.value_or(0) * 1e6; }},
      {"Nodes that may be wanted soon (lookahead objects)", "count",
       [](const FrameRow& r) { return double(r.nodes_foreseen); }},
      {"Range cells", "count", [](const FrameRow& r) { return double(r.range_cells); }},
      {"Resident", "MiB", [](const FrameRow& r) { return mib(r.resident_bytes); }},
      {"Read from disk", "MiB a frame", [](const FrameRow& r) { return mib(r.bytes_read); }},
  };
  return all;
}

std::string plot_of(const std::vector<PolicyFlight>& flights, const Statistic& statistic, const PolicyPage& page) {
  std::vector<PlotSeries> series;
  bool any = false;
  for (const PolicyFlight& flight : flights) {
    std::vector<double> values;
    values.reserve(flight.report.rows.size());
    for (const FrameRow& row : flight.report.rows) values.push_back(statistic.value(row));
    for (const double value : values) any = any || value != 0;
    series.push_back({flight.policy, statistic.averaged ? moving_average(values, kWindow) : std::move(values)});
  }
  if (!any) return "";  // not measured, or it did not happen
  PlotOptions options;
  options.title = statistic.title;
  options.y_label = statistic.unit;
  options.from_zero = statistic.from_zero;
  if (&statistic == &statistics().front()) options.lines = {{"target", page.target_ms}};
  return line_plot(series, options);
}

/// A row of the table: what it is, and each flight's.
struct TableRow {
  const char* name;
  std::function<std::string(const FlightReport&)> text;
};

std::string table_of(const std::vector<PolicyFlight>& flights) {
  const TableRow rows[] = {
      {"frames", [](const FlightReport& r) { return fmt::format("{}", r.totals.frames); }},
      {"frame time, mean, ms", [](const FlightReport& r) { return fmt::format("{:.1f}", r.totals.frame_ms_mean); }},
      {"median", [](const FlightReport& r) { return fmt::format("{:.1f}", r.totals.frame_ms_p50); }},
      {"99th percentile", [](const FlightReport& r) { return fmt::format("{:.1f}", r.totals.frame_ms_p99); }},
      {"standard deviation", [](const FlightReport& r) { return fmt::format("{:.2f}", r.totals.frame_ms_stddev); }},
      {"response time, 99th percentile, ms",
       [](const FlightReport& r) { return fmt::format("{:.1f}", r.totals.response_ms_p99); }},
      {"estimate off by, %",
       [](const FlightReport& r) { return fmt::format("{:+.1f}", estimate_error(r, true).mean_percent); }},
      {"its deviation, %",
       [](const FlightReport& r) { return fmt::format("{:.1f}", estimate_error(r, true).stddev_percent); }},
      {"one picture drawn twice deviates by, %",
       [](const FlightReport& r) {
         return r.totals.frame_noise_percent > 0 ? fmt::format("{:.1f}", r.totals.frame_noise_percent) : "-";
       }},
      {"triangles, mean",
       [](const FlightReport& r) { return human_count(static_cast<uint64_t>(r.totals.triangles_drawn_mean)); }},
      {"nodes, mean", [](const FlightReport& r) { return fmt::format("{:.1f}", r.totals.nodes_drawn_mean); }},
      {"nodes missing, mean", [](const FlightReport& r) { return fmt::format("{:.3f}", r.totals.nodes_missing_mean); }},
      {"toggles a frame", [](const FlightReport& r) { return fmt::format("{:.4f}", r.totals.toggles_per_frame); }},
      {"of them by loading", [](const FlightReport& r) { return fmt::format("{}", r.totals.toggles_loading); }},
      {"of them undone within a second",
       [](const FlightReport& r) { return fmt::format("{}", r.totals.toggles_back); }},
      {"popped pixels of a million",
       [](const FlightReport& r) {
         return r.totals.popped_share_mean ? fmt::format("{:.0f}", *r.totals.popped_share_mean * 1e6) : "-";
       }},
      {"read", [](const FlightReport& r) { return human_bytes(r.totals.bytes_read); }},
      {"in reads", [](const FlightReport& r) { return fmt::format("{}", r.totals.reads); }},
      {"resident, peak", [](const FlightReport& r) { return human_bytes(r.totals.resident_bytes_peak); }},
      {"stalls", [](const FlightReport& r) { return fmt::format("{}", r.totals.stalls); }},
  };
  std::vector<std::vector<std::string>> cells(1, {""});
  for (const PolicyFlight& flight : flights)
    cells.front().push_back(flight.policy + (flight.is_default ? " (default)" : ""));
  for (const TableRow& row : rows) {
    cells.push_back({row.name});
    for (const PolicyFlight& flight : flights) cells.back().push_back(row.text(flight.report));
  }
  return html_table(cells, true);
}

}  // namespace

std::string html_of(const std::vector<PolicyFlight>& flights, const PolicyPage& page) {
  std::string body = table_of(flights);
  for (const Statistic& statistic : statistics()) body += plot_of(flights, statistic, page);
  return html_page("Policies in " + page.model,
                   fmt::format("{}, target {:.1f} ms, memory {}, {}", escaped(page.path), page.target_ms,
                               human_bytes(page.memory_bytes), escaped(page.renderer)),
                   body);
}

}  // namespace promenade
