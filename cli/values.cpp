#include "cli/values.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

namespace promenade {
namespace {

bool read_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

}  // namespace

Result<uint64_t> parse_bytes(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 9> kUnits = {{{"TiB", 1099511627776.0},
                                                                          {"GiB", 1073741824.0},
                                                                          {"MiB", 1048576.0},
                                                                          {"KiB", 1024.0},
                                                                          {"TB", 1e12},
                                                                          {"GB", 1e9},
                                                                          {"MB", 1e6},
                                                                          {"kB", 1e3},
                                                                          {"B", 1.0}}};
  std::string_view rest = text;
  double scale = 1;
  for (const auto& [unit, factor] : kUnits) {
    if (!rest.ends_with(unit)) continue;
    rest.remove_suffix(unit.size());
    scale = factor;
    break;
  }
  while (rest.ends_with(' ')) rest.remove_suffix(1);
  double value = 0;
  if (!read_number(rest, value) || value < 0 || value * scale >= 9.2e18)
    return Error{fmt::format("\"{}\" is no size: write it like 4GiB, 256MiB or 1000000", text)};
  return static_cast<uint64_t>(value * scale);
}

Result<PixelSize> parse_size(const std::string& text) {
  constexpr double kLargestSide = 16384;  // the renderers' limit
  const size_t x = text.find('x');
  double width = 0, height = 0;
  const bool read = x != std::string::npos && read_number(std::string_view(text).substr(0, x), width) &&
                    read_number(std::string_view(text).substr(x + 1), height);
  if (!read || width < 1 || height < 1 || width > kLargestSide || height > kLargestSide || width != std::floor(width) ||
      height != std::floor(height))
    return Error{
        fmt::format("\"{}\" is no picture size: write it like 1280x720, sides from 1 to {}", text, kLargestSide)};
  return PixelSize{static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

Result<std::pair<std::string, double>> parse_weight(const std::string& text) {
  const size_t at = text.rfind('=');
  double weight = 0;
  if (at == std::string::npos || !read_number(std::string_view(text).substr(at + 1), weight) || weight < 0 ||
      weight > 1)
    return Error{fmt::format("\"{}\" is no weight: write it like chair=0.25, from 0 to 1", text)};
  return std::pair(text.substr(0, at), weight);
}

Result<Pose> parse_pose(const std::string& text) {
  std::vector<double> numbers;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    double value = 0;
    if (!read_number(std::string_view(text).substr(begin, end - begin), value)) numbers.assign(100, 0);
    numbers.push_back(value);
    begin = end + 1;
  }
  if (numbers.size() != 5 && numbers.size() != 6)
    return Error{fmt::format("\"{}\" is no camera: write it as x,y,z,yaw,pitch in metres and degrees", text)};
  return Pose{{numbers[0], numbers[1], numbers[2]}, numbers[3], numbers[4], numbers.size() == 6 ? numbers[5] : 0.0};
}

}  // namespace promenade
