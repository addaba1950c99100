#include "cli/study_policies.h"

#include <fmt/format.h>

#include <memory>

#include "cli/flight_figures.h"
#include "cli/policy_page.h"
#include "cli/view_options.h"
#include "layout/file_io.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

constexpr Policy kDefaultPolicy = Policy::vlod_time_slices;

struct Arguments {
  std::filesystem::path model, path_file, report_file;
  std::vector<Policy> policies;
  double seconds = 10;
  bool settle = false, popping = false;
  ViewOptions view;
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

Result<FlightReport> fly_with(Policy policy, const Arguments& arguments, const ModelSource& source,
                              const OffscreenRenderer& offscreen, const DrawCosts& costs, const CameraPath& path,
                              JobMonitor& monitor) {
  FlightOptions options;
  options.session = arguments.view.session;
  options.session.select.policy = policy;
  options.session.draw_costs = costs;
  options.session.background = background_of(arguments.view);
  options.width_px = arguments.view.size.width;
  options.height_px = arguments.view.size.height;
  options.vertical_fov_deg = arguments.view.vertical_fov_deg;
  options.near_m = arguments.view.near_m;
  options.settle_first = arguments.settle;
  options.measure_popping = arguments.popping;
  options.redraw_every = 10;
  const auto nothing = [](const FrameRow&, Renderer&) -> Status { return Done{}; };
  return fly(source, *offscreen.renderer, path, options, nothing, monitor);
}

void print_table(const std::vector<PolicyFlight>& flights) {
  fmt::print("{:18} {:>7} {:>7} {:>6} {:>9} {:>7} {:>8} {:>8} {:>8} {:>9}\n", "policy", "p50 ms", "p99 ms", "dev",
             "triangles", "nodes", "missing", "toggles", "est. off", "popped/M");
  for (const PolicyFlight& flight : flights) {
    const FlightTotals& t = flight.report.totals;
    const std::string popped = t.popped_share_mean ? fmt::format("{:.0f}", *t.popped_share_mean * 1e6) : "-";
    fmt::print("{:18} {:7.1f} {:7.1f} {:6.2f} {:9.0f} {:7.1f} {:8.3f} {:8.4f} {:+7.1f}% {:>9}{}\n", flight.policy,
               t.frame_ms_p50, t.frame_ms_p99, t.frame_ms_stddev, t.triangles_drawn_mean, t.nodes_drawn_mean,
               t.nodes_missing_mean, t.toggles_per_frame, estimate_error(flight.report, true).mean_percent, popped,
               flight.is_default ? "  (default)" : "");
  }
}

Status run_study(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<CameraPath> path = read_path(arguments.path_file, arguments.seconds);
  if (!path) return path.error();
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  const std::unique_ptr<ModelSource> source = source_of(*reader);
  const Result<OffscreenRenderer> offscreen = make_offscreen_renderer(arguments.view);
  if (!offscreen) return offscreen.error();
  const Result<DrawCosts> costs = draw_costs_of(*offscreen);
  if (!costs) return costs.error();
  std::vector<Policy> policies = arguments.policies;
  if (policies.empty()) policies.assign(all_policies().begin(), all_policies().end());
  std::vector<PolicyFlight> flights;
  figures["policies"] = Json::array();
  for (const Policy policy : policies) {
    if (arguments.policies.empty() && uses_far(policy) && source->far() == nullptr) continue;
    Result<FlightReport> report = fly_with(policy, arguments, *source, *offscreen, *costs, *path, monitor);
    if (!report) return Error{fmt::format("policy {}: {}", name_of(policy), report.error().message)};
    Json row = {{"name", name_of(policy)}};
    if (policy == kDefaultPolicy) row["default"] = true;
    row.update(totals_json(*report));
    figures["policies"].push_back(std::move(row));
    flights.push_back({std::string(name_of(policy)), policy == kDefaultPolicy, std::move(*report)});
  }
  print_table(flights);
  if (arguments.report_file.empty()) return Done{};
  const PolicyPage page{arguments.model.filename().string(), arguments.path_file.filename().string(),
                        offscreen->description, arguments.view.session.select.time.target_ms,
                        arguments.view.session.loader.memory_bytes};
  PROMENADE_TRY(write_file(arguments.report_file, std::string_view(html_of(flights, page))));
  fmt::print("report: {}\n", arguments.report_file.string());
  return Done{};
}

}  // namespace

Command add_study_policies(CLI::App& study) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = study.add_subcommand("policies", "Fly one path with each policy, from a cold start, and compare");
  app->add_option("MODEL", arguments->model, "A directory that build made")->required();
  app->add_option("--path", arguments->path_file, "The recorded path")->required()->type_name("FILE");
  add_parsed<std::vector<Policy>>(*app, "--policies", arguments->policies, parse_policies,
                                  fmt::format("Some of {}, separated by commas", policy_names()))
      ->default_str("all");
  app->add_option("--seconds", arguments->seconds, "Fly only the first seconds of the path (0: all)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app->add_flag("--settle", arguments->settle, "Load what the first view asks for before the first frame");
  app->add_flag("--popping", arguments->popping, "Measure how much of each picture popped (slow)");
  app->add_option("--report", arguments->report_file, "Write a page with all plots, a line a policy")
      ->type_name("FILE.html");
  add_fade_option(*app, arguments->view);
  add_far_style_option(*app, arguments->view);
  add_prefetch_options(*app, arguments->view);
  add_camera_options(*app, arguments->view);
  add_policy_options(*app, arguments->view, kDefaultPolicy, uint64_t(256) << 20);
  add_renderer_options(*app, arguments->view);
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_study(*arguments, monitor, figures); }};
}

}  // namespace promenade
