#include "cli/study_policies.h"

#include <fmt/format.h>

#include <memory>

#include "cli/flight_figures.h"
#include "cli/flight_setting.h"
#include "cli/policy_page.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

/// Seconds of the path that are flown with each policy.
constexpr double kSeconds = 10;
/// Every so many frames one is drawn twice, to know the machine's noise.
constexpr uint32_t kRedrawEvery = 10;

struct Arguments {
  Arguments() { setting.seconds = kSeconds; }

  FlightSetting setting;
  std::filesystem::path report_file;
  std::vector<Policy> policies;
};

Result<std::vector<Policy>> parse_policies(const std::string& text) {
  std::vector<Policy> policies;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const std::optional<Policy> policy = policy_named(name);
    if (!policy) return Error{fmt::format("\"{}\" is no policy: {}", name, policy_names())};
    policies.push_back(*policy);
    begin = end + 1;
  }
  return policies;
}

Result<FlightReport> fly_with(Policy policy, const FlightSetting& setting, const OpenFlight& flight,
                              const DrawCosts& costs, JobMonitor& monitor) {
  FlightOptions options = flight_options(setting);
  options.session.select.policy = policy;
  options.session.draw_costs = costs;
  options.redraw_every = kRedrawEvery;
  const auto nothing = [](const FrameRow&, Renderer&) -> Status { return Done{}; };
  return fly(*flight.source, *flight.offscreen.renderer, flight.path, options, nothing, monitor);
}

void print_table(const std::vector<PolicyFlight>& flights) {
  fmt::print("{:18} {:>7} {:>7} {:>6} {:>9} {:>7} {:>8} {:>8} {:>8} {:>9}\n", "policy", "p50 ms", "p99 ms", "dev",
             "triangles", "nodes", "missing", "toggles", "est. off", "areas/M");
  for (const PolicyFlight& flight : flights) {
    const FlightTotals& t = flight.report.totals;
    const std::string popped = t.popped_area_share_mean ? fmt::format("{:.0f}", *t.popped_area_share_mean * 1e6) : "-";
    fmt::print("{:18} {:7.1f} {:7.1f} {:6.2f} {:9.0f} {:7.1f} {:8.3f} {:8.4f} {:+7.1f}% {:>9}{}\n", flight.policy,
               t.frame_ms_p50, t.frame_ms_p99, t.frame_ms_stddev, t.triangles_drawn_mean, t.nodes_drawn_mean,
               t.nodes_missing_mean, t.toggles_per_frame, estimate_error(flight.report, true).mean_percent, popped,
               flight.is_default ? "  (default)" : "");
  }
}

Status run_study(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const FlightSetting& setting = arguments.setting;
  const Result<OpenFlight> flight = open_flight(setting);
  if (!flight) return flight.error();
  const Result<DrawCosts> costs = draw_costs_of(flight->offscreen);
  if (!costs) return costs.error();
  std::vector<Policy> policies = arguments.policies;
  if (policies.empty()) policies.assign(all_policies().begin(), all_policies().end());
  std::vector<PolicyFlight> flights;
  figures["policies"] = Json::array();
  for (const Policy policy : policies) {
    if (arguments.policies.empty() && uses_far(policy) && flight->source->far() == nullptr) continue;
    Result<FlightReport> report = fly_with(policy, setting, *flight, *costs, monitor);
    if (!report) return Error{fmt::format("policy {}: {}", name_of(policy), report.error().message)};
    Json row = {{"name", name_of(policy)}};
    if (policy == kDefaultFlightPolicy) row["default"] = true;
    row.update(totals_json(*report));
    figures["policies"].push_back(std::move(row));
    flights.push_back({std::string(name_of(policy)), policy == kDefaultFlightPolicy, std::move(*report)});
  }
  print_table(flights);
  if (arguments.report_file.empty()) return Done{};
  const PolicyPage page{setting.model.filename().string(), setting.path_file.filename().string(),
                        flight->offscreen.description, setting.view.session.select.time.target_ms,
                        setting.view.session.loader.memory_bytes};
  PROMENADE_TRY(write_file(arguments.report_file, std::string_view(html_of(flights, page))));
  fmt::print("report: {}\n", arguments.report_file.string());
  return Done{};
}

}  // namespace

Command add_study_policies(CLI::App& study) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = study.add_subcommand("policies", "Fly one path with each policy, from a cold start, and compare");
  add_parsed<std::vector<Policy>>(*app, "--policies", arguments->policies, parse_policies,
                                  fmt::format("Some of {}, separated by commas", policy_names()))
      ->default_str("all");
  app->add_option("--report", arguments->report_file, "Write a page with all plots, a line a policy")
      ->type_name("FILE.html");
  add_flight_options(*app, arguments->setting);
  app->remove_option(app->get_option("--policy"));  // --policies says which
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_study(*arguments, monitor, figures); }};
}

}  // namespace promenade
