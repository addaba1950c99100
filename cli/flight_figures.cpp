#include "cli/flight_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "cli/console.h"
#include "cli/plot.h"
#include "cli/report_page.h"

namespace promenade {
namespace {

constexpr size_t kLakhiaWindow = 35;  // frames; Lakhia figures 6.4 and 6.6

Json json_of_row(const FrameRow& row) {
  return {{"frame", row.frame},
          {"t_s", row.t_s},
          {"frame_ms", row.frame_ms},
          {"select_ms", row.select_ms},
          {"upload_ms", row.upload_ms},
          {"draw_ms", row.draw_ms},
          {"wait_ms", row.wait_ms},
          {"response_ms", row.response_ms},
          {"estimated_ms", row.estimated_ms},
          {"estimated_without_feedback_ms", row.estimated_without_feedback_ms},
          {"share_ms", row.share_ms},
          {"coarsening", row.coarsening},
          {"moved_m", row.moved_m},
          {"triangles_drawn", row.triangles_drawn},
          {"nodes_drawn", row.nodes_drawn},
          {"nodes_missing", row.nodes_missing},
          {"toggles", row.toggles},
          {"toggles_up", row.toggles_up},
          {"toggles_down", row.toggles_down},
          {"toggles_loading", row.toggles_loading},
          {"toggles_back", row.toggles_back},
          {"nodes_fading", row.nodes_fading},
          {"pace", row.pace},
          {"draw_cpu_ms", row.draw_cpu_ms},
          {"estimated_cpu_ms", row.estimated_cpu_ms},
          {"redraw_ms", row.redraw_ms},
          {"redraw_cpu_ms", row.redraw_cpu_ms},
          {"popped_share", row.popped_share ? Json(*row.popped_share) : Json()},
          {"popped_area_share", row.popped_area_share ? Json(*row.popped_area_share) : Json()},
          {"resident_bytes", row.resident_bytes},
          {"bytes_read", row.bytes_read},
          {"cell", row.cell ? Json(index_of(*row.cell)) : Json()},
          {"vlod_missing", row.vlod_missing},
          {"eye_hidden_nodes", row.eye_hidden_nodes},
          {"eye_ms", row.eye_ms},
          {"range_cells", row.range_cells},
          {"nodes_foreseen", row.nodes_foreseen},
          {"delta_nodes", row.delta_nodes},
          {"delta_bytes", row.delta_bytes},
          {"nodes_by_level", row.nodes_by_level}};
}

using RowValue = std::function<double(const FrameRow&)>;

std::vector<double> column(const FlightReport& report, const RowValue& value) {
  std::vector<double> values;
  values.reserve(report.rows.size());
  for (const FrameRow& row : report.rows) values.push_back(value(row));
  return values;
}

/// Estimated over actual frame time, in percent; negative: the estimate was longer than the frame (Lakhia's sign).
double estimate_error_percent(double estimated_ms, double actual_ms) {
  return actual_ms > 0 ? 100 * (actual_ms - estimated_ms) / actual_ms : 0;
}

double estimated_ms(const FrameRow& row, bool with_feedback) {
  return with_feedback ? row.estimated_ms : row.estimated_without_feedback_ms;
}

std::vector<PlotSeries> nodes_by_level(const FlightReport& report) {
  size_t levels = 0;
  for (const FrameRow& row : report.rows) levels = std::max(levels, row.nodes_by_level.size());
  std::vector<PlotSeries> series;
  for (size_t level = 0; level < levels; ++level)
    series.push_back({fmt::format("level {}", level), column(report, [level](const FrameRow& row) {
                        return level < row.nodes_by_level.size() ? double(row.nodes_by_level[level]) : 0.0;
                      })});
  return series;
}

std::string plots(const FlightReport& report, const FlightPage& page) {
  const auto mib = [](uint64_t bytes) { return double(bytes) / double(1 << 20); };
  const auto with =
      column(report, [](const FrameRow& r) { return estimate_error_percent(r.estimated_ms, r.frame_ms); });
  const auto without = column(
      report, [](const FrameRow& r) { return estimate_error_percent(r.estimated_without_feedback_ms, r.frame_ms); });
  std::string svg;
  svg += line_plot({{"whole frame", column(report, [](const FrameRow& r) { return r.frame_ms; })},
                    {"select", column(report, [](const FrameRow& r) { return r.select_ms; })},
                    {"upload", column(report, [](const FrameRow& r) { return r.upload_ms; })}},
                   {.title = "Frame time", .y_label = "ms", .lines = {{"target", page.target_ms}}});
  svg += line_plot({{"without feedback", moving_average(without, kLakhiaWindow)},
                    {"with feedback", moving_average(with, kLakhiaWindow)}},
                   {.title = "Actual against estimated frame time, moving average of 35 frames",
                    .y_label = "%",
                    .lines = {},
                    .from_zero = false});
  svg += line_plot({{"resident", column(report, [&](const FrameRow& r) { return mib(r.resident_bytes); })}},
                   {.title = "Memory", .y_label = "MiB", .lines = {{"bound", mib(page.memory_bytes)}}});
  svg += line_plot({{"triangles", column(report, [](const FrameRow& r) { return double(r.triangles_drawn); })}},
                   {.title = "Triangles drawn", .y_label = "count", .lines = {}});
  svg += line_plot(nodes_by_level(report),
                   {.title = "Nodes drawn by level (0: the root)", .y_label = "count", .lines = {}});
  svg += line_plot(
      {{"toggles", moving_average(column(report, [](const FrameRow& r) { return double(r.toggles); }), kLakhiaWindow)}},
      {.title = "Toggles between levels, moving average of 35 frames", .y_label = "a frame", .lines = {}});
  svg += line_plot({{"fading", column(report, [](const FrameRow& r) { return double(r.nodes_fading); })}},
                   {.title = "Nodes drawn besides the front, for fades", .y_label = "count", .lines = {}});
  if (report.totals.popped_share_mean)
    svg +=
        line_plot({{"pixels", column(report, [](const FrameRow& r) { return r.popped_share.value_or(0) * 1e6; })},
                   {"areas", column(report, [](const FrameRow& r) { return r.popped_area_share.value_or(0) * 1e6; })}},
                  {.title = "Popped: pixels changed beyond what the camera's motion explains",
                   .y_label = "per million",
                   .lines = {}});
  svg += line_plot({{"response", column(report, [](const FrameRow& r) { return r.response_ms; })}},
                   {.title = "Response: from reading the pose to the finished picture", .y_label = "ms", .lines = {}});
  svg += line_plot({{"missing", column(report, [](const FrameRow& r) { return double(r.nodes_missing); })}},
                   {.title = "Nodes not resident when chosen (an ancestor stood in)", .y_label = "count", .lines = {}});
  svg += line_plot({{"read", column(report, [&](const FrameRow& r) { return mib(r.bytes_read); })}},
                   {.title = "Read from disk", .y_label = "MiB a frame", .lines = {}});
  return svg;
}

std::string base64(const std::vector<std::byte>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string table_of(const FlightReport& report) {
  const FlightTotals& t = report.totals;
  const auto error_text = [&](bool with_feedback) {
    const EstimateError error = estimate_error(report, with_feedback);
    return fmt::format("{:+.1f} %, deviation {:.1f} %", error.mean_percent, error.stddev_percent);
  };
  const std::pair<const char*, std::string> rows[] = {
      {"frames", fmt::format("{}", t.frames)},
      {"frame time, median", fmt::format("{:.1f} ms", t.frame_ms_p50)},
      {"frame time, 99th percentile", fmt::format("{:.1f} ms", t.frame_ms_p99)},
      {"frame time, standard deviation", fmt::format("{:.2f} ms", t.frame_ms_stddev)},
      {"response time",
       fmt::format("{:.1f} ms median, {:.1f} ms 99th percentile", t.response_ms_p50, t.response_ms_p99)},
      {"stages", fmt::format("select {:.2f} ms, upload {:.2f}, draw {:.2f}, waiting for what is chosen {:.2f}",
                             t.select_ms_mean, t.upload_ms_mean, t.draw_ms_mean, t.wait_ms_mean)},
      {"actual against estimated frame time", error_text(true)},
      {"the same without feedback", error_text(false)},
      {"triangles drawn, mean", human_count(static_cast<uint64_t>(t.triangles_drawn_mean))},
      {"nodes drawn, mean", fmt::format("{:.1f}", t.nodes_drawn_mean)},
      {"nodes missing, mean", fmt::format("{:.3f}", t.nodes_missing_mean)},
      {"one picture drawn twice deviates by",
       t.frame_noise_percent > 0 ? fmt::format("{:.1f} %", t.frame_noise_percent) : "not measured"},
      {"the same, processor time",
       t.frame_noise_percent > 0 ? fmt::format("{:.1f} %", t.frame_cpu_noise_percent) : "not measured"},
      {"popped pixels of a million, mean",
       t.popped_share_mean ? fmt::format("{:.0f}", *t.popped_share_mean * 1e6) : "not measured"},
      {"popped areas of a million, mean",
       t.popped_area_share_mean ? fmt::format("{:.0f}", *t.popped_area_share_mean * 1e6) : "not measured"},
      {"toggles a frame", fmt::format("{:.4f}", t.toggles_per_frame)},
      {"read from disk", fmt::format("{} in {} reads", human_bytes(t.bytes_read), t.reads)},
      {"of this drawn before it left memory",
       fmt::format("{:.0f} %", 100 * double(t.bytes_read_useful) / std::max(1.0, double(t.bytes_read)))},
      {"resident, peak", fmt::format("{} of {}", human_bytes(t.resident_bytes_peak), human_bytes(t.memory_bytes))},
      {"process memory, peak", human_bytes(t.peak_rss_bytes)},
      {"stalls", fmt::format("{}", t.stalls)}};
  std::vector<std::vector<std::string>> table;
  for (const auto& [name, value] : rows) table.push_back({name, value});
  return html_table(table, false);
}

EstimateError deviation_of(const std::vector<double>& errors) {
  if (errors.empty()) return {};
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e, squares += e * e;
  const double mean = sum / double(errors.size());
  return {mean, std::sqrt(std::max(0.0, squares / double(errors.size()) - mean * mean))};
}

}  // namespace

EstimateError estimate_error(const FlightReport& report, bool with_feedback) {
  return deviation_of(column(report, [&](const FrameRow& row) {
    return estimate_error_percent(estimated_ms(row, with_feedback), row.frame_ms);
  }));
}

EstimateError estimate_cpu_error(const FlightReport& report) {
  return deviation_of(column(report, [](const FrameRow& row) {
    return row.estimated_cpu_ms > 0 ? estimate_error_percent(row.estimated_cpu_ms, row.draw_cpu_ms) : 0;
  }));
}

Json totals_json(const FlightReport& report) {
  const EstimateError with = estimate_error(report, true), without = estimate_error(report, false),
                      cpu = estimate_cpu_error(report);
  const FlightTotals& t = report.totals;
  Json json = {{"frame_count", t.frames},
               {"frame_ms_mean", t.frame_ms_mean},
               {"frame_ms_p50", t.frame_ms_p50},
               {"frame_ms_p99", t.frame_ms_p99},
               {"frame_ms_stddev", t.frame_ms_stddev},
               {"response_ms_mean", t.response_ms_mean},
               {"response_ms_p50", t.response_ms_p50},
               {"response_ms_p99", t.response_ms_p99},
               {"select_ms_mean", t.select_ms_mean},
               {"upload_ms_mean", t.upload_ms_mean},
               {"draw_ms_mean", t.draw_ms_mean},
               {"wait_ms_mean", t.wait_ms_mean},
               {"triangles_drawn_mean", t.triangles_drawn_mean},
               {"nodes_drawn_mean", t.nodes_drawn_mean},
               {"nodes_missing_mean", t.nodes_missing_mean},
               {"toggles_per_frame", t.toggles_per_frame},
               {"toggles_loading", t.toggles_loading},
               {"toggles_back", t.toggles_back},
               {"nodes_fading_mean", t.nodes_fading_mean},
               {"frame_noise_percent", t.frame_noise_percent},
               {"frame_cpu_noise_percent", t.frame_cpu_noise_percent},
               {"draw_cpu_ms_mean", t.draw_cpu_ms_mean},
               {"popped_area_share_mean", t.popped_area_share_mean ? Json(*t.popped_area_share_mean) : Json()},
               {"popped_area_share_p99", t.popped_area_share_p99 ? Json(*t.popped_area_share_p99) : Json()},
               {"popped_share_mean", t.popped_share_mean ? Json(*t.popped_share_mean) : Json()},
               {"popped_share_p99", t.popped_share_p99 ? Json(*t.popped_share_p99) : Json()},
               {"teleports", t.teleports.count},
               {"teleports_unfinished", t.teleports.unfinished},
               {"teleport_full_ms_mean", t.teleports.full_ms_mean},
               {"teleport_full_ms_max", t.teleports.full_ms_max},
               {"cells_crossed", t.cells_crossed},
               {"delta_bytes_mean", t.delta_bytes_mean},
               {"delta_nodes_mean", t.delta_nodes_mean},
               {"vlods_missing", t.vlods_missing},
               {"far_crossed", t.far_crossed},
               {"far_late", t.far_late},
               {"far_missing", t.far_missing},
               {"far_triangles_mean", t.far_triangles_mean},
               {"bytes_read", t.bytes_read},
               {"reads", t.reads},
               {"bytes_read_useful", t.bytes_read_useful},
               {"resident_bytes_peak", t.resident_bytes_peak},
               {"coarsening_mean", t.coarsening_mean},
               {"coarsening_max", t.coarsening_max},
               {"texture_side_px", t.texture_side_px ? Json(*t.texture_side_px) : Json()},
               {"peak_rss_bytes", t.peak_rss_bytes},
               {"stalls", t.stalls},
               {"memory_bytes", t.memory_bytes},
               {"estimate_error_percent_mean", with.mean_percent},
               {"estimate_error_percent_stddev", with.stddev_percent},
               {"estimate_cpu_error_percent_mean", cpu.mean_percent},
               {"estimate_cpu_error_percent_stddev", cpu.stddev_percent},
               {"estimate_without_feedback_error_percent_mean", without.mean_percent},
               {"estimate_without_feedback_error_percent_stddev", without.stddev_percent}};
  return json;
}

Json json_of(const FlightReport& report) {
  Json json = totals_json(report);
  json["frames"] = Json::array();
  for (const FrameRow& row : report.rows) json["frames"].push_back(json_of_row(row));
  return json;
}

std::string html_of(const FlightReport& report, const FlightPage& page) {
  std::string html = table_of(report) + "<div class=pictures>\n";
  for (const FlightPage::Picture& picture : page.pictures)
    html += fmt::format(
        "<figure><img alt=\"frame {0}\" src=\"data:image/jpeg;base64,{1}\"><figcaption>frame "
        "{0}</figcaption></figure>\n",
        picture.frame, base64(picture.jpeg));
  const std::string how =
      fmt::format("{}, policy {}, {}", escaped(page.path), escaped(page.policy), escaped(page.renderer));
  return html_page("Flight through " + page.model, how, html + "</div>\n" + plots(report, page));
}

}  // namespace promenade
