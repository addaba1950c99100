#include "preprocess/far/far_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "codec/far_face.h"
#include "codec/frame.h"
#include "geometry/parallax.h"
#include "preprocess/unit_io.h"

namespace promenade {
namespace {

constexpr double kBoxPart = 6;         // of the model's longest side; measured: scripts/far_table
constexpr double kDepthCells = 4;      // times the flat cell
constexpr double kLargestCell = 0.25;  // of the box: an eye at its rim must not be near the far side's triangles
constexpr double kTexelsABound = 4;
constexpr uint32_t kLeastLevels = 9;
/// Air above the model that belongs to viewing space, in heights of the model: as for the cells of visibility.
constexpr double kSky = 0.25;
constexpr uint32_t kLeastSidePx = 17;
constexpr double kRimM = 0.01;  // where one goes is within the grid, not on its rim

Box box_of(const Model& model) {
  Box box;
  for (const NodeId root : model.tables.roots)
    if (!model.is_moving(root)) box.add(model.tables.nodes[index_of(root)].box);
  return box;
}

/// The model and some air above it, and where one goes not farther away than the model is long.
DBox viewing_space(const Model& model, const FarOptions& o) {
  const Box box = box_of(model);
  const DBox air{box.min, glm::dvec3(box.max) + glm::dvec3(0, 0, kSky * double(box.size().z))};
  const glm::dvec3 size = air.size();
  const DBox around = air.grown(std::max({size.x, size.y, size.z}));
  DBox space = air;
  for (const glm::dvec3& place : o.along)
    if (const glm::dvec3 at = place - model.manifest.origin; around.contains(at)) space.add(DBox{at, at}.grown(kRimM));
  return space;
}

uint32_t levels_of(const FarOptions& o) {
  if (o.side_px != 0) return static_cast<uint32_t>(std::bit_width(o.side_px - 1)) - 1;
  const double texels = 90 * kTexelsABound / o.bound_deg;
  const auto levels = static_cast<uint32_t>(std::ceil(std::log2(std::max(texels, 1.0))));
  return std::clamp(levels, kLeastLevels, kMostFaceLevels);
}

/// Lengths of the boxes, from within outwards, and of the cells that keep the bound with flat pictures.
struct FlatShell {
  double box_m = 0, cell_m = 0;
};
Result<std::vector<FlatShell>> flat_shells(const FarOptions& o, double bound_rad, double inner_m, double longest_m) {
  double factor = o.spacing_factor;
  if (factor == 0)
    factor = o.spacing == ShellSpacing::linear ? std::pow(longest_m / inner_m, 1.0 / o.shells)
                                               : std::pow(std::log(longest_m) / std::log(inner_m), 1.0 / o.shells);
  std::vector<FlatShell> shells = {{inner_m, 0}};
  while (shells.size() < o.shells) {
    const double before_m = shells.back().box_m;
    const double box_m = o.spacing == ShellSpacing::linear ? before_m * factor : std::pow(before_m, factor);
    if (!(box_m > before_m && box_m < longest_m))
      return Error{
          fmt::format("--far-shells {}: shell {} would have boxes of {:.1f} m around {:.1f} m, the model has "
                      "{:.1f} m; take fewer, or a smaller --far-box or --far-factor",
                      o.shells, shells.size() + 1, box_m, before_m, longest_m)};
    shells.push_back({box_m, 0});
  }
  // From the outermost inwards, as [xiong1996] equation 4.1; pictures reach a little beyond the next box.
  for (size_t i = shells.size(); i-- > 0;) {
    const bool outermost = i + 1 == shells.size();
    const double reach_m = outermost ? longest_m : shells[i + 1].cell_m / 2 + shells[i + 1].box_m * (0.5 + kFarOverlap);
    const Result<double> cell_m = view_cell_length_m({bound_rad, shells[i].box_m, reach_m, !outermost});
    if (!cell_m) return cell_m.error();
    shells[i].cell_m = *cell_m;
  }
  return shells;
}

}  // namespace

Status check_options(const FarOptions& o) {
  if (!o.pictures) return Done{};
  if (!(o.bound_deg >= 1e-3 && o.bound_deg <= 45))
    return Error{fmt::format("--far-bound {}: must be between 0.001 and 45 degrees", o.bound_deg)};
  if (!(o.box_m >= 0 && std::isfinite(o.box_m))) return Error{fmt::format("--far-box {}: must be above 0", o.box_m)};
  if (!(o.cell_m >= 0 && std::isfinite(o.cell_m)))
    return Error{fmt::format("--far-cell {}: must be above 0", o.cell_m)};
  if (o.side_px != 0 &&
      (o.side_px < kLeastSidePx || o.side_px > (1U << kMostFaceLevels) + 1 || !std::has_single_bit(o.side_px - 1)))
    return Error{fmt::format("--far-side {}: must be 2^n + 1 pixels, {} to {}", o.side_px, kLeastSidePx,
                             (1U << kMostFaceLevels) + 1)};
  if (o.shells == 0 || o.shells > kMostFarShells)
    return Error{fmt::format("--far-shells {}: must be between 1 and {}", o.shells, kMostFarShells)};
  if (o.spacing_factor != 0 && !(o.spacing_factor > 1 && std::isfinite(o.spacing_factor)))
    return Error{fmt::format("--far-factor {}: must be above 1", o.spacing_factor)};
  if (o.jpeg_quality < 0 || o.jpeg_quality > 100)
    return Error{fmt::format("--far-quality {}: must be between 0 and 100", o.jpeg_quality)};
  return Done{};
}

uint64_t hash_of(const FarOptions& o) {
  UnitWriter writer;
  writer.value(o.pictures), writer.value(o.bound_deg), writer.value(o.box_m), writer.value(o.cell_m);
  writer.value(o.depth), writer.value(o.side_px), writer.value(o.jpeg_quality), writer.value(o.deltas);
  writer.value(o.height_m.value_or(-1)), writer.array(o.along);
  writer.value(o.shells), writer.value(o.spacing), writer.value(o.spacing_factor);
  return checksum(writer.bytes());
}

std::map<std::string, std::string> settings_of(const FarOptions& o) {
  if (!o.pictures) return {};
  std::map<std::string, std::string> settings{
      {"far-bound", fmt::format("{}", o.bound_deg)}, {"far-box", fmt::format("{}", o.box_m)},
      {"far-cell", fmt::format("{}", o.cell_m)},     {"far-depth", o.depth ? "on" : "off"},
      {"far-side", fmt::format("{}", o.side_px)},    {"far-quality", fmt::format("{}", o.jpeg_quality)},
      {"far-deltas", o.deltas ? "on" : "off"}};
  if (o.shells > 1) {
    settings["far-shells"] = fmt::format("{}", o.shells);
    settings["far-spacing"] = o.spacing == ShellSpacing::linear ? "linear" : "exponential";
    settings["far-factor"] = fmt::format("{}", o.spacing_factor);
  }
  if (o.height_m) settings["far-height"] = fmt::format("{}", *o.height_m);
  if (!o.along.empty()) settings["far-path"] = fmt::format("{} places", o.along.size());
  return settings;
}

Result<FarTables> far_grid(const Model& model, const FarOptions& o) {
  PROMENADE_TRY(check_options(o));
  const DBox space = viewing_space(model, o);
  const glm::dvec3 size = space.size();
  const double longest_m = std::max({size.x, size.y, size.z});
  FarTables tables;
  tables.bound_rad = glm::radians(o.bound_deg);
  tables.box_m = o.box_m > 0 ? o.box_m : longest_m / kBoxPart;
  tables.face_levels = levels_of(o);
  tables.has_depth = o.depth;
  if (!(tables.box_m > 0 && tables.box_m < longest_m))
    return Error{fmt::format("--far-box {}: nothing is beyond it, the model has {:.1f} m", tables.box_m, longest_m)};
  const Result<std::vector<FlatShell>> shells = flat_shells(o, tables.bound_rad, tables.box_m, longest_m);
  if (!shells) return shells.error();
  const auto largest_m = [&o](const FlatShell& flat) {
    return std::min(o.depth ? kDepthCells * flat.cell_m : flat.cell_m, kLargestCell * flat.box_m);
  };
  // Whole numbers of cells within: then each lies in one cell of the next shell, and needs that one's pictures alone.
  const double flat_m = shells->front().cell_m;
  tables.cell_m = o.cell_m > 0 ? o.cell_m : largest_m(shells->front());
  double within_m = tables.cell_m, of_innermost = 1;
  for (size_t i = 1; i < shells->size(); ++i) {
    const double most = largest_m((*shells)[i]) / within_m * (1 + 1e-9);
    const double times = std::max(1.0, o.cell_m > 0 ? std::floor(most) : std::round(most));
    tables.outer.push_back({(*shells)[i].box_m, static_cast<uint32_t>(times)});
    within_m *= times, of_innermost *= times;
    if (o.cell_m == 0) tables.cell_m = std::min(tables.cell_m, largest_m((*shells)[i]) / of_innermost);
  }
  if (!o.depth && tables.cell_m > flat_m * (1 + 1e-9))
    return Error{
        fmt::format("--far-cell {}: flat pictures on a box of {:.1f} m keep {} degrees in cells of {:.3f} m at "
                    "most; take pictures with depth, a larger bound or a larger box",
                    tables.cell_m, tables.box_m, o.bound_deg, flat_m)};
  if (tables.cell_m > kLargestCell * tables.box_m * (1 + 1e-9))
    return Error{fmt::format("--far-cell {}: at most a quarter of the box's {:.1f} m", tables.cell_m, tables.box_m)};
  tables.origin = space.min;
  for (int i = 0; i < 3; ++i) {
    const double count = std::max(1.0, std::ceil(size[i] / tables.cell_m));
    constexpr double kMostASide = 1e6;
    if (count > kMostASide)
      return Error{fmt::format("far pictures: {:.0f} view cells along an axis are too many", count)};
    tables.counts[i] = static_cast<uint32_t>(count);
  }
  if (const std::string defect = find_defect(tables); !defect.empty()) return Error{"far pictures: " + defect};
  return tables;
}

}  // namespace promenade
