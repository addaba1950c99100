#include "preprocess/visibility/cell_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "codec/frame.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr std::array<std::pair<CellStyle, std::string_view>, 4> kStyles = {
    {{CellStyle::none, "none"}, {CellStyle::automatic, "auto"}, {CellStyle::octree, "octree"}, {CellStyle::kd, "kd"}}};

Status check_number(const char* option, double value, double above, double most) {
  if (value > above && value <= most) return Done{};
  return Error{fmt::format("--{} {}: must be above {} and at most {}", option, value, above, most)};
}

}  // namespace

std::string_view name_of(CellStyle style) {
  for (const auto& [known, name] : kStyles)
    if (known == style) return name;
  return "";
}

std::optional<CellStyle> cell_style_named(std::string_view name) {
  for (const auto& [style, known] : kStyles)
    if (known == name) return style;
  return std::nullopt;
}

FrontBound bound_of(const CellOptions& options) {
  return {options.pixel_error,
          pixel_scale(options.width_px, options.height_px, options.vertical_fov_deg, options.error_at)};
}

Status check_options(const CellOptions& o) {
  PROMENADE_TRY(check_number("pixel-error", o.pixel_error, 0, 1e6));
  PROMENADE_TRY(check_number("fov", o.vertical_fov_deg, 0, 179));
  PROMENADE_TRY(check_number("smallest-cell", o.smallest_cell_m, 0, 1e9));
  if (!(o.cell_gain >= 1 && o.cell_gain <= 1e6))
    return Error{fmt::format("--cell-gain {}: must be between 1 and 1000000", o.cell_gain)};
  if (!(o.least_room_m >= 0 && o.least_room_m <= 1e9))
    return Error{fmt::format("--least-room {}: must be between 0 and 1e9", o.least_room_m)};
  if (o.width_px == 0 || o.height_px == 0) return Error{"--size: a picture has at least one pixel"};
  if (o.walk_height_m) PROMENADE_TRY(check_number("walk-height", *o.walk_height_m, 0, 1e6));
  for (const DBox& box : o.inside)
    if (box.empty() || !std::isfinite(box.diagonal())) return Error{"--cells-in: a box is empty or not finite"};
  return Done{};
}

uint64_t hash_of(const CellOptions& o) {
  UnitWriter writer;
  const FrontBound bound = bound_of(o);
  writer.value(o.cells), writer.value(bound.pixel_error), writer.value(bound.scale.focal_px);
  writer.value(bound.scale.tan_corner), writer.value(o.cell_triangles), writer.value(o.smallest_cell_m);
  writer.value(o.cell_gain), writer.value(o.least_room_m);
  writer.value(o.max_cells), writer.value(o.walk_height_m.value_or(-1));
  writer.array(o.inside);
  for (const std::string& hider : o.hiders) writer.text(hider);
  if (o.openings) writer.value(o.openings);
  return checksum(writer.bytes());
}

std::map<std::string, std::string> settings_of(const CellOptions& o) {
  std::map<std::string, std::string> settings{{"cells", std::string(name_of(o.cells))}};
  if (o.cells == CellStyle::none) return settings;
  settings["hiders"] = o.hiders.empty() ? "none" : fmt::format("{}", fmt::join(o.hiders, ","));
  settings["pixel-error"] = fmt::format("{}", o.pixel_error);
  settings["size"] = fmt::format("{}x{}", o.width_px, o.height_px);
  settings["fov"] = fmt::format("{}", o.vertical_fov_deg);
  settings["error-at"] = o.error_at == ErrorAt::corner ? "corner" : "center";
  settings["cell-triangles"] = fmt::format("{}", o.cell_triangles);
  settings["cell-gain"] = fmt::format("{}", o.cell_gain);
  settings["smallest-cell"] = fmt::format("{}", o.smallest_cell_m);
  settings["least-room"] = fmt::format("{}", o.least_room_m);
  if (o.max_cells != 0) settings["max-cells"] = fmt::format("{}", o.max_cells);
  if (o.walk_height_m) settings["walk-height"] = fmt::format("{}", *o.walk_height_m);
  if (o.openings) settings["openings"] = "on";
  if (!o.inside.empty()) settings["cells-in"] = fmt::format("{} boxes", o.inside.size());
  return settings;
}

}  // namespace promenade
