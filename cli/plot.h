#pragma once
// Plots as SVG text, for the reports.

#include <string>
#include <vector>

namespace promenade {

struct PlotSeries {
  std::string name;
  std::vector<double> values;  ///< one a frame; not finite: a gap
};

struct PlotOptions {
  std::string title;
  std::string y_label;  ///< with its unit
  std::string x_label = "frame";
  std::vector<std::pair<std::string, double>> lines;  ///< horizontal lines: a target, a bound
  bool from_zero = true;                              ///< the y axis starts at 0
  std::vector<std::string> ticks = {};                ///< names of the values along x, and dots at them; empty: numbers
};

/// One plot, 860 x 260 px, readable in light and dark pages. Long series are drawn as the range of each pixel column,
/// so that no peak gets lost. Names and titles are escaped. Pure.
std::string line_plot(const std::vector<PlotSeries>& series, const PlotOptions& options);

struct PlotBar {
  std::string name;
  double value = 0;  ///< >= 0
};

/// Horizontal bars, one below the other, each with its name and value; 860 px wide. Escaped like a line plot. Pure.
std::string bar_plot(const std::vector<PlotBar>& bars, const std::string& title, const std::string& unit);

/// &, <, > and quotes made harmless in HTML and SVG.
std::string escaped(const std::string& text);

/// Mean of each value and its neighbours in a window, shorter at the ends (Lakhia plots 35 frames).
std::vector<double> moving_average(const std::vector<double>& values, size_t window);

}  // namespace promenade
