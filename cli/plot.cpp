#include "cli/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace promenade {
namespace {

constexpr double kWidth = 860, kHeight = 260, kLeft = 64, kRight = 12, kTop = 34, kBottom = 34;
constexpr double kPlotWidth = kWidth - kLeft - kRight, kPlotHeight = kHeight - kTop - kBottom;
// Okabe and Ito's palette: told apart by every kind of colour vision.
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#b8a800"};

struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  void add(double v) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
};

/// 1, 2 or 5 times a power of ten: the step of about five ticks.
double tick_step(double span) {
  const double raw = span / 5, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double times = raw / power;
  return power * (times <= 1 ? 1 : times <= 2 ? 2 : times <= 5 ? 5 : 10);
}

std::string tick_text(double v) {
  const double size = std::abs(v);
  if (size >= 1e9) return fmt::format("{:.3g}G", v / 1e9);
  if (size >= 1e6) return fmt::format("{:.3g}M", v / 1e6);
  if (size >= 1e4) return fmt::format("{:.3g}k", v / 1e3);
  return fmt::format("{:.4g}", v);
}

struct Axes {
  Range y;
  size_t count = 1;
  double px(double i) const { return kLeft + (count > 1 ? i / double(count - 1) : 0.5) * kPlotWidth; }
  double py(double v) const { return kTop + (1 - (v - y.low) / (y.high - y.low)) * kPlotHeight; }
};

Axes axes_of(const std::vector<PlotSeries>& series, const PlotOptions& options) {
  Axes axes;
  for (const PlotSeries& s : series) {
    axes.count = std::max(axes.count, s.values.size());
    for (const double v : s.values) axes.y.add(v);
  }
  for (const auto& line : options.lines) axes.y.add(line.second);
  if (options.from_zero) axes.y.add(0);
  if (axes.y.low > axes.y.high) axes.y = {0, 1};
  if (axes.y.high - axes.y.low < 1e-12) axes.y.high = axes.y.low + 1;
  axes.y.high += 0.04 * (axes.y.high - axes.y.low);
  return axes;
}

std::string grid(const Axes& axes, const PlotOptions& options) {
  std::string svg;
  const double step = tick_step(axes.y.high - axes.y.low);
  for (double v = std::ceil(axes.y.low / step) * step; v <= axes.y.high; v += step)
    svg += fmt::format(
        "<line class=grid x1={0:.0f} x2={1:.0f} y1={2:.1f} y2={2:.1f} /><text x={3:.0f} y={4:.1f} "
        "text-anchor=end>{5}</text>\n",
        kLeft, kWidth - kRight, axes.py(v), kLeft - 6, axes.py(v) + 4, tick_text(std::abs(v) < step * 1e-9 ? 0 : v));
  const double x_step = std::max(1.0, tick_step(double(std::max<size_t>(axes.count, 2) - 1)));
  const auto tick = [&](double x, const std::string& text, const char* anchor) {
    svg += fmt::format("<text x={:.1f} y={:.0f} text-anchor={}>{}</text>\n", axes.px(x), kHeight - kBottom + 16, anchor,
                       escaped(text));
  };
  for (size_t i = 0; i < options.ticks.size(); ++i) {
    const bool alone = options.ticks.size() == 1;
    tick(double(i), options.ticks[i], alone ? "middle" : i == 0 ? "start" : i + 1 == axes.count ? "end" : "middle");
  }
  for (double x = 0; options.ticks.empty() && x < double(axes.count); x += x_step) tick(x, tick_text(x), "middle");
  svg += fmt::format("<text x={:.0f} y={:.0f} text-anchor=end>{}</text>\n", kWidth - kRight, kHeight - 4,
                     escaped(options.x_label));
  return svg;
}

/// Polyline of a series; where several frames share a pixel column, its lowest and highest value.
std::string curve(const PlotSeries& series, const Axes& axes, const char* color, bool dots) {
  const size_t columns = static_cast<size_t>(kPlotWidth);
  const size_t stride = std::max<size_t>(1, (series.values.size() + columns - 1) / columns);
  std::string points, svg;
  const auto flush = [&] {
    if (!points.empty())
      svg += fmt::format("<polyline fill=none stroke=\"{}\" stroke-width=1.3 points=\"{}\" />\n", color, points);
    points.clear();
  };
  for (size_t i = 0; i < series.values.size(); i += stride) {
    Range range;
    for (size_t k = i; k < std::min(i + stride, series.values.size()); ++k) range.add(series.values[k]);
    if (range.low > range.high) {
      flush();
      continue;
    }
    points += fmt::format("{:.1f},{:.1f} ", axes.px(double(i)), axes.py(range.high));
    if (stride > 1) points += fmt::format("{:.1f},{:.1f} ", axes.px(double(i)), axes.py(range.low));
  }
  flush();
  for (size_t i = 0; dots && i < series.values.size(); ++i)
    if (std::isfinite(series.values[i]))
      svg += fmt::format("<circle cx={:.1f} cy={:.1f} r=3 fill=\"{}\" />\n", axes.px(double(i)),
                         axes.py(series.values[i]), color);
  return svg;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string bar_plot(const std::vector<PlotBar>& bars, const std::string& title, const std::string& unit) {
  constexpr double kBarLeft = 200, kBarRight = 90, kBar = 16, kPitch = 22, kFirst = 30;
  double most = 0;
  for (const PlotBar& bar : bars) most = std::max(most, bar.value);
  const double height = kFirst + kPitch * double(bars.size()) + 6;
  std::string svg = fmt::format(
      "<svg class=plot viewBox=\"0 0 {0:.0f} {1:.0f}\" width={0:.0f} height={1:.0f} role=img>\n", kWidth, height);
  svg += fmt::format("<text class=title x={:.0f} y=16>{} ({})</text>\n", kLeft, escaped(title), escaped(unit));
  for (size_t i = 0; i < bars.size(); ++i) {
    const double y = kFirst + kPitch * double(i);
    const double length = most > 0 ? bars[i].value / most * (kWidth - kBarLeft - kBarRight) : 0;
    svg += fmt::format(
        "<text x={:.0f} y={:.1f} text-anchor=end>{}</text><rect class=bar x={:.0f} y={:.1f} width={:.1f} "
        "height={:.0f} /><text x={:.1f} y={:.1f}>{}</text>\n",
        kBarLeft - 8, y + 12, escaped(bars[i].name), kBarLeft, y, length, kBar, kBarLeft + length + 6, y + 12,
        tick_text(bars[i].value));
  }
  return svg + "</svg>\n";
}

std::vector<double> moving_average(const std::vector<double>& values, size_t window) {
  std::vector<double> out(values.size());
  const size_t half = window / 2;
  for (size_t i = 0; i < values.size(); ++i) {
    const size_t begin = i > half ? i - half : 0, end = std::min(values.size(), i + half + 1);
    double sum = 0;
    for (size_t k = begin; k < end; ++k) sum += values[k];
    out[i] = sum / double(end - begin);
  }
  return out;
}

std::string line_plot(const std::vector<PlotSeries>& series, const PlotOptions& options) {
  const Axes axes = axes_of(series, options);
  std::string svg = fmt::format(
      "<svg class=plot viewBox=\"0 0 {0:.0f} {1:.0f}\" width={0:.0f} height={1:.0f} role=img>\n", kWidth, kHeight);
  svg += fmt::format("<text class=title x={:.0f} y=16>{} ({})</text>\n", kLeft, escaped(options.title),
                     escaped(options.y_label));
  svg += grid(axes, options);
  for (const auto& [name, value] : options.lines)
    svg += fmt::format(
        "<line class=bound x1={0:.0f} x2={1:.0f} y1={2:.1f} y2={2:.1f} /><text x={1:.0f} y={3:.1f} "
        "text-anchor=end>{4}</text>\n",
        kLeft, kWidth - kRight, axes.py(value), axes.py(value) - 4, escaped(name));
  for (size_t i = 0; i < series.size(); ++i)
    svg += curve(series[i], axes, kColors[i % kColors.size()], !options.ticks.empty());
  double x = kWidth - kRight;
  for (size_t i = series.size(); series.size() > 1 && i-- > 0;) {
    svg += fmt::format("<text x={:.0f} y=16 text-anchor=end style=\"fill:{}\">{}</text>\n", x,
                       kColors[i % kColors.size()], escaped(series[i].name));
    x -= 7.5 * double(series[i].name.size()) + 14;
  }
  return svg + "</svg>\n";
}

}  // namespace promenade
