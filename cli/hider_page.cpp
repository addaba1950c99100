#include "cli/hider_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "cli/plot.h"
#include "cli/report_page.h"

namespace promenade {
namespace {

std::string side_text(double side_m) { return side_m > 0 ? fmt::format("{} m", side_m) : "own cells"; }

std::string table_of(const std::vector<HiderFigures>& studies) {
  std::vector<std::vector<std::string>> rows = {{"model", "triangles", "side", "cells", "reference ms", "chain",
                                                 "ms a cell", "of the reference", "hidden %", "overestimate", "nodes",
                                                 "triangles seen", "false nodes", "false pixels"}};
  for (const HiderFigures& s : studies)
    for (const ChainFigures& c : s.chains)
      rows.push_back({s.model, fmt::format("{}", s.model_triangles), side_text(s.side_m), fmt::format("{}", s.cells),
                      fmt::format("{:.1f}", s.reference_ms_per_cell), c.name, fmt::format("{:.2f}", c.ms_per_cell),
                      c.ms_per_cell > 0 ? fmt::format("1/{:.1f}", s.reference_ms_per_cell / c.ms_per_cell) : "",
                      fmt::format("{:.1f}", 100 * c.hidden_share), fmt::format("{:.3f}", c.overestimate),
                      fmt::format("{:.1f}", c.nodes_mean), fmt::format("{:.0f}", c.triangles_mean),
                      fmt::format("{}", c.false_hidden_nodes), fmt::format("{}", c.false_hidden_pixels)});
  return html_table(rows, true);
}

/// A line a chain over some studies.
std::string plot(const std::vector<const HiderFigures*>& studies, const std::string& title, const std::string& unit,
                 const std::function<std::string(const HiderFigures&)>& tick,
                 const std::function<double(const ChainFigures&)>& value) {
  PlotOptions options = {.title = title, .y_label = unit, .x_label = "", .lines = {}, .from_zero = true};
  for (const HiderFigures* s : studies) options.ticks.push_back(tick(*s));
  std::vector<PlotSeries> lines;
  for (size_t c = 0; c < studies.front()->chains.size(); ++c) {
    PlotSeries& line = lines.emplace_back();
    line.name = studies.front()->chains[c].name;
    for (const HiderFigures* s : studies) line.values.push_back(value(s->chains[c]));
  }
  return line_plot(lines, options);
}

std::string plots_of(const std::vector<const HiderFigures*>& studies, const std::string& what,
                     const std::function<std::string(const HiderFigures&)>& tick) {
  return plot(studies, "Cost " + what, "ms a cell", tick, [](const ChainFigures& c) { return c.ms_per_cell; }) +
         plot(studies, "Quality " + what, "triangles kept over triangles seen", tick,
              [](const ChainFigures& c) { return c.overestimate; });
}

}  // namespace

std::string html_of(const std::vector<HiderFigures>& studies, const std::string& subtitle) {
  std::string body;
  std::set<std::string> models;
  for (const HiderFigures& study : studies)
    if (models.insert(study.model).second) {
      std::vector<const HiderFigures*> of_model;
      for (const HiderFigures& s : studies)
        if (s.model == study.model) of_model.push_back(&s);
      if (of_model.size() > 1)
        body += plots_of(of_model, "by size of cell, " + study.model,
                         [](const HiderFigures& s) { return side_text(s.side_m); });
    }
  std::set<double> sides;
  for (const HiderFigures& study : studies)
    if (sides.insert(study.side_m).second) {
      std::vector<const HiderFigures*> of_side;
      for (const HiderFigures& s : studies)
        if (s.side_m == study.side_m) of_side.push_back(&s);
      std::stable_sort(of_side.begin(), of_side.end(), [](const HiderFigures* a, const HiderFigures* b) {
        return a->model_triangles < b->model_triangles;
      });
      if (of_side.size() > 1)
        body += plots_of(of_side, "by size of model, " + side_text(study.side_m), [](const HiderFigures& s) {
          return fmt::format("{} ({:.2f} M)", s.model, double(s.model_triangles) / 1e6);
        });
    }
  return html_page("What hiders cost and are worth", escaped(subtitle), body + table_of(studies));
}

}  // namespace promenade
