#include "cli/study_shells.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>
#include <memory>

#include "cli/plot.h"
#include "cli/report_page.h"
#include "geometry/shells.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

struct Arguments {
  std::filesystem::path report_file;
  ParallaxRule rule = ParallaxRule::published;
  double bound_deg = 10, box_m = 56;
  double length_m = 1000, width_m = 1000, height_m = 10;
  uint32_t factors = 200;
};

Result<ParallaxRule> parse_rule(const std::string& text) {
  if (text == "published") return ParallaxRule::published;
  if (text == "everywhere") return ParallaxRule::everywhere;
  return Error{fmt::format("\"{}\" is no rule: published or everywhere", text)};
}

double length_or_gap(double bound_deg, double box_m, double model_m, ParallaxRule rule) {
  const Result<double> cell_m = view_cell_length_m({glm::radians(bound_deg), box_m, model_m, false, rule});
  return cell_m ? *cell_m : std::numeric_limits<double>::quiet_NaN();
}

/// One of the thesis' plots: the length of a view cell against one quantity.
struct CellPlot {
  std::string figure, title, x_label;
  double from = 0, to = 0;
  std::function<double(double x, ParallaxRule rule)> length_m;
};

std::vector<CellPlot> cell_plots() {
  const auto by_bound = [](double box_m, double model_m) {
    return [box_m, model_m](double x, ParallaxRule rule) { return length_or_gap(x, box_m, model_m, rule); };
  };
  return {{"2-5", "View cell by angular bound: box 1000, model 3000", "bound, degrees", 0.1, 45, by_bound(1000, 3000)},
          {"2-6", "View cell by box: bound 10 degrees, model 3000", "length of the box", 10, 2900,
           [](double x, ParallaxRule rule) { return length_or_gap(10, x, 3000, rule); }},
          {"2-7", "View cell by model: bound 10 degrees, box 1000", "length of the model", 1100, 20000,
           [](double x, ParallaxRule rule) { return length_or_gap(10, 1000, x, rule); }},
          {"2-8", "View cell by angular bound: the campus, box 56 m, model 1 km", "bound, degrees", 0.1, 45,
           by_bound(56, 1000)},
          {"2-9", "View cell by angular bound: the city, box 56 m, model 10 km", "bound, degrees", 0.1, 45,
           by_bound(56, 10000)}};
}

constexpr uint32_t kPoints = 100;

/// Both rules in one plot, decimal logarithms as published; the values as JSON.
std::string drawn(const CellPlot& plot, Json& json) {
  PlotSeries published{"straight ahead, as published", {}}, everywhere{"over all rays", {}};
  Json row = {{"figure", plot.figure},
              {"title", plot.title},
              {"x", Json::array()},
              {"cell_published_m", Json::array()},
              {"cell_everywhere_m", Json::array()}};
  for (uint32_t i = 0; i < kPoints; ++i) {
    const double x = plot.from + (plot.to - plot.from) * i / (kPoints - 1);
    const double a = plot.length_m(x, ParallaxRule::published), b = plot.length_m(x, ParallaxRule::everywhere);
    row["x"].push_back(x), row["cell_published_m"].push_back(a), row["cell_everywhere_m"].push_back(b);
    published.values.push_back(std::log10(a)), everywhere.values.push_back(std::log10(b));
  }
  json.push_back(std::move(row));
  PlotOptions options;
  options.title = fmt::format("Figure {}. {}", plot.figure, plot.title);
  options.y_label = "log10 of the cell's length";
  options.x_label = fmt::format("{}, {:g} to {:g} in {} steps", plot.x_label, plot.from, plot.to, kPoints);
  options.from_zero = false;
  return line_plot({published, everywhere}, options);
}

ShellSetup setup_of(const Arguments& a) {
  return {glm::radians(a.bound_deg), a.box_m, {a.length_m, a.width_m, a.height_m}, a.rule};
}

Json json_of(const std::vector<Shell>& shells) {
  Json rows = Json::array();
  for (const Shell& shell : shells)
    rows.push_back({{"cell_m", shell.cell_m}, {"box_m", shell.box_m}, {"cells", shell.cells}});
  return rows;
}

std::vector<std::vector<std::string>> table_of(const std::vector<Shell>& shells) {
  std::vector<std::vector<std::string>> rows = {{"view cell, m", "box, m", "view cells"}};
  for (size_t i = shells.size(); i-- > 0;)
    rows.push_back({fmt::format("{:.1f}", shells[i].cell_m), fmt::format("{:.1f}", shells[i].box_m),
                    fmt::format("{}", shells[i].cells)});
  rows.push_back({"total", "", fmt::format("{}", cells_of(shells))});
  return rows;
}

struct Spacing {
  const char *name, *figure, *table;
  ShellSpacing spacing;
  double from, to;
};

/// The number of cells by factor, and the best factor's shells.
Result<std::string> study_spacing(const Arguments& arguments, const Spacing& s, uint64_t single_cells, Json& figures) {
  const ShellSetup setup = setup_of(arguments);
  PlotSeries cells{"several shells", {}}, single{"one", {}};
  Json by_factor = Json::array();
  for (uint32_t i = 0; i < arguments.factors; ++i) {
    const double factor = s.from + (s.to - s.from) * i / std::max(1U, arguments.factors - 1);
    const Result<std::vector<Shell>> shells = shells_of(setup, s.spacing, factor);
    if (!shells) return shells.error();
    cells.values.push_back(double(cells_of(*shells))), single.values.push_back(double(single_cells));
    by_factor.push_back({{"factor", factor}, {"cells", cells_of(*shells)}, {"shells", shells->size()}});
  }
  const Result<ShellOptimum> best = best_shells(setup, s.spacing, s.from, s.to, arguments.factors);
  if (!best) return best.error();
  figures[s.name] = {{"factor", best->factor},
                     {"cells", cells_of(best->shells)},
                     {"shells", json_of(best->shells)},
                     {"by_factor", std::move(by_factor)}};
  const std::string title =
      fmt::format("Table {}: {} spacing, factor {:.4f}, {:.0f} % of one shell's cells", s.table, s.name, best->factor,
                  100 * double(cells_of(best->shells)) / double(single_cells));
  fmt::print("{}\n", title);
  for (const std::vector<std::string>& row : table_of(best->shells))
    fmt::print("  {:>12} {:>8} {:>10}\n", row[0], row[1], row[2]);
  PlotOptions options;
  options.title = fmt::format("Figure {}. View cells by {} factor", s.figure, s.name);
  options.y_label = "view cells";
  options.x_label = fmt::format("factor, {:g} to {:g} in {} steps", s.from, s.to, arguments.factors);
  return line_plot({cells, single}, options) + fmt::format("<p>{}</p>\n", escaped(title)) +
         html_table(table_of(best->shells), true);
}

Status run_study(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  std::string body;
  figures["plots"] = Json::array();
  const std::vector<CellPlot> plots = cell_plots();
  for (size_t i = 0; i < plots.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    body += drawn(plots[i], figures["plots"]);
    monitor.progress("plots", i + 1, plots.size());
  }
  const Result<Shell> single = single_shell(setup_of(arguments));
  if (!single) return single.error();
  figures["single"] = {{"cell_m", single->cell_m}, {"cells", single->cells}};
  fmt::print("one shell: box {:.1f} m, view cells of {:.2f} m, {} of them\n", arguments.box_m, single->cell_m,
             single->cells);
  for (const Spacing& s : {Spacing{"linear", "4-3", "4.1", ShellSpacing::linear, 1.2, 4},
                           Spacing{"exponential", "4-4", "4.2", ShellSpacing::exponential, 1.05, 1.5}}) {
    const Result<std::string> part = study_spacing(arguments, s, single->cells, figures);
    if (!part) return part.error();
    body += *part;
  }
  if (arguments.report_file.empty()) return Done{};
  const std::string subtitle =
      fmt::format("bound {:g} degrees, inner box {:g} m, model {:g} x {:g} x {:g} m, rule {}", arguments.bound_deg,
                  arguments.box_m, arguments.length_m, arguments.width_m, arguments.height_m,
                  arguments.rule == ParallaxRule::published ? "published" : "everywhere");
  PROMENADE_TRY(
      write_file(arguments.report_file,
                 std::string_view(html_page("View cells around near geometry and far pictures", subtitle, body))));
  fmt::print("report: {}\n", arguments.report_file.string());
  return Done{};
}

}  // namespace

Command add_study_shells(CLI::App& study) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = study.add_subcommand(
      "shells", "How large view cells may be under far pictures, and what several shells of them save (no model)");
  add_parsed<ParallaxRule>(*app, "--rule", arguments->rule, parse_rule,
                           "Where the largest parallax is looked for: published (straight ahead) or everywhere")
      ->default_str("published");
  app->add_option("--far-bound", arguments->bound_deg, "Bound on the parallax of far pictures, degrees")
      ->check(CLI::Range(1e-6, 89.0))
      ->capture_default_str();
  const auto add_length = [app](const char* name, double& length_m, const char* help) {
    app->add_option(name, length_m, help)->check(CLI::PositiveNumber)->capture_default_str();
  };
  add_length("--far-box", arguments->box_m, "Length of the innermost box, m");
  add_length("--length", arguments->length_m, "Length of the model, m");
  add_length("--width", arguments->width_m, "Width of the model, m");
  add_length("--height", arguments->height_m, "Height of the model, m");
  app->add_option("--factors", arguments->factors, "How many factors are tried")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app->add_option("--report", arguments->report_file, "Write a page with the plots and tables")->type_name("FILE.html");
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_study(*arguments, monitor, figures); }};
}

}  // namespace promenade
