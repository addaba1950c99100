#include "layout/far.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "codec/far_face.h"

namespace promenade {
namespace {

glm::dvec3 centre_of_place(const FarTables& tables, uint64_t place) {
  const uint64_t x = place % tables.counts.x, rest = place / tables.counts.x;
  const glm::dvec3 at(double(x), double(rest % tables.counts.y), double(rest / tables.counts.y));
  return tables.origin + (at + 0.5) * tables.cell_m;
}

bool positive(double value) { return std::isfinite(value) && value > 0; }

std::string find_grid_defect(const FarTables& t) {
  if (!positive(t.bound_rad) || !positive(t.box_m) || !positive(t.cell_m) || t.cell_m >= t.box_m)
    return fmt::format("cells of {} m in boxes of {} m for {} radians", t.cell_m, t.box_m, t.bound_rad);
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(t.origin[i])) return "the grid's origin is not finite";
  if (t.face_levels > kMostFaceLevels)
    return fmt::format("faces of {} levels, at most {}", t.face_levels, kMostFaceLevels);
  uint64_t places = 1;
  for (int i = 0; i < 3; ++i) {
    if (t.counts[i] == 0 || t.counts[i] > kMostFarPlaces / places)
      return fmt::format("a grid of {} x {} x {} places", t.counts.x, t.counts.y, t.counts.z);
    places *= t.counts[i];
  }
  return {};
}

}  // namespace

DBox box_of_place(const FarTables& tables, uint64_t place) {
  const glm::dvec3 centre = centre_of_place(tables, place);
  return {centre - tables.cell_m / 2, centre + tables.cell_m / 2};
}

DBox cell_box(const FarTables& tables, FarCellId id) { return box_of_place(tables, tables.cells[index_of(id)].place); }

Box near_box(const FarTables& tables, FarCellId id) {
  const glm::dvec3 centre = centre_of_place(tables, tables.cells[index_of(id)].place);
  return {glm::vec3(centre - tables.box_m / 2), glm::vec3(centre + tables.box_m / 2)};
}

std::optional<uint64_t> far_place_at(const FarTables& tables, const glm::dvec3& point) {
  const glm::dvec3 at = (point - tables.origin) / tables.cell_m;
  for (int i = 0; i < 3; ++i)
    if (!(at[i] >= 0 && at[i] < double(tables.counts[i]))) return std::nullopt;
  const auto x = static_cast<uint64_t>(at.x), y = static_cast<uint64_t>(at.y), z = static_cast<uint64_t>(at.z);
  return x + tables.counts.x * (y + tables.counts.y * z);
}

std::optional<FarCellId> far_cell_of_place(const FarTables& tables, uint64_t place) {
  const auto found = std::lower_bound(tables.cells.begin(), tables.cells.end(), place,
                                      [](const FarCellRecord& cell, uint64_t p) { return cell.place < p; });
  if (found == tables.cells.end() || found->place != place) return std::nullopt;
  return FarCellId{static_cast<uint32_t>(found - tables.cells.begin())};
}

std::optional<FarCellId> far_cell_at(const FarTables& tables, const glm::dvec3& point) {
  const std::optional<uint64_t> place = far_place_at(tables, point);
  return place ? far_cell_of_place(tables, *place) : std::nullopt;
}

std::string find_defect(const FarTables& t) {
  if (std::string defect = find_grid_defect(t); !defect.empty()) return defect;
  const uint64_t places = uint64_t(t.counts.x) * t.counts.y * t.counts.z;
  uint64_t face = 0;
  for (size_t i = 0; i < t.cells.size(); ++i) {
    const FarCellRecord& cell = t.cells[i];
    if (cell.place >= places || (i > 0 && cell.place <= t.cells[i - 1].place))
      return fmt::format("far cell {}: place {} of {} does not ascend", i, cell.place, places);
    if (cell.first_face != face || cell.face_count > 6 || cell.face_count > t.faces.size() - face)
      return fmt::format("far cell {}: faces {} + {} of {}", i, cell.first_face, cell.face_count, t.faces.size());
    if (!std::isfinite(cell.parallax_rad) || cell.parallax_rad < 0)
      return fmt::format("far cell {}: parallax of {} radians", i, cell.parallax_rad);
    for (uint32_t k = 0; k < cell.face_count; ++k, ++face)
      if (t.faces[face].side > 5 || (k > 0 && t.faces[face].side <= t.faces[face - 1].side))
        return fmt::format("far face {}: side {} does not ascend", face, t.faces[face].side);
  }
  if (face != t.faces.size()) return fmt::format("{} of {} far faces belong to cells", face, t.faces.size());
  const uint64_t most_triangles = uint64_t(2) << (2 * t.face_levels);
  for (size_t i = 0; i < t.faces.size(); ++i)
    if (t.faces[i].triangles > most_triangles)
      return fmt::format("far face {}: {} triangles, its grid has {}", i, t.faces[i].triangles, most_triangles);
  return {};
}

}  // namespace promenade
