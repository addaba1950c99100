#include "layout/far.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "codec/far_face.h"

namespace promenade {
namespace {

FarShell shell_around(const FarShell& within, const FarOuterShell& outer) {
  FarShell shell{outer.box_m, within.cell_m * outer.times, {}, within.first_place + within.places()};
  for (int i = 0; i < 3; ++i) shell.counts[i] = (within.counts[i] - 1) / outer.times + 1;
  return shell;
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
  if (t.outer.size() >= kMostFarShells) return fmt::format("{} shells, at most {}", t.outer.size() + 1, kMostFarShells);
  double box_m = t.box_m, cell_m = t.cell_m;
  for (const FarOuterShell& outer : t.outer) {
    if (!positive(outer.box_m) || outer.box_m <= box_m || outer.times == 0)
      return fmt::format("a shell of boxes of {} m around one of {} m, cells {} times as long", outer.box_m, box_m,
                         outer.times);
    box_m = outer.box_m, cell_m *= outer.times;
    if (!(cell_m < box_m)) return fmt::format("a shell of cells of {} m in boxes of {} m", cell_m, box_m);
  }
  return {};
}

/// Every cell but the outermost has one around it.
std::string find_chain_defect(const FarTables& t) {
  if (t.outer.empty()) return {};
  for (size_t i = 0; i < t.cells.size(); ++i) {
    const std::optional<uint64_t> around = place_around(t, t.cells[i].place);
    if (around && !far_cell_of_place(t, *around))
      return fmt::format("far cell {}: no cell around it, at place {}", i, *around);
  }
  return {};
}

}  // namespace

std::vector<FarShell> shells_of(const FarTables& tables) {
  std::vector<FarShell> shells;
  shells.reserve(tables.outer.size() + 1);
  shells.push_back({tables.box_m, tables.cell_m, tables.counts, 0});
  for (const FarOuterShell& outer : tables.outer) shells.push_back(shell_around(shells.back(), outer));
  return shells;
}

FarGridPlace grid_place_of(const FarTables& tables, uint64_t place) {
  FarGridPlace found{0, {tables.box_m, tables.cell_m, tables.counts, 0}, {}};
  while (found.shell < tables.outer.size() && place >= found.grid.first_place + found.grid.places())
    found.grid = shell_around(found.grid, tables.outer[found.shell++]);
  const uint64_t own = place - found.grid.first_place, rest = own / found.grid.counts.x;
  found.at = {own % found.grid.counts.x, rest % found.grid.counts.y, rest / found.grid.counts.y};
  return found;
}

std::optional<uint64_t> place_around(const FarTables& tables, uint64_t place) {
  const FarGridPlace from = grid_place_of(tables, place);
  if (from.shell == tables.outer.size()) return std::nullopt;
  const FarOuterShell& outer = tables.outer[from.shell];
  const FarShell around = shell_around(from.grid, outer);
  const glm::uvec3 at = from.at / outer.times;
  return around.first_place + at.x + around.counts.x * (at.y + uint64_t(around.counts.y) * at.z);
}

std::vector<FarCellId> chain_of(const FarTables& tables, FarCellId cell) {
  std::vector<FarCellId> chain = {cell};
  chain.reserve(tables.outer.size() + 1);
  std::optional<uint64_t> place = place_around(tables, tables.cells[index_of(cell)].place);
  for (; place; place = place_around(tables, *place))
    if (const std::optional<FarCellId> around = far_cell_of_place(tables, *place)) chain.push_back(*around);
  return chain;
}

DBox box_of_place(const FarTables& tables, uint64_t place) {
  const FarGridPlace found = grid_place_of(tables, place);
  const glm::dvec3 corner = tables.origin + glm::dvec3(found.at) * found.grid.cell_m;
  return {corner, corner + found.grid.cell_m};
}

DBox cell_box(const FarTables& tables, FarCellId id) { return box_of_place(tables, tables.cells[index_of(id)].place); }

Box near_box(const FarTables& tables, FarCellId id) { return near_box(tables, tables.cells[index_of(id)].place); }

Box near_box(const FarTables& tables, uint64_t place) {
  const FarGridPlace found = grid_place_of(tables, place);
  const glm::dvec3 centre = tables.origin + (glm::dvec3(found.at) + 0.5) * found.grid.cell_m;
  return {glm::vec3(centre - found.grid.box_m / 2), glm::vec3(centre + found.grid.box_m / 2)};
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
  const FarShell outermost = shells_of(t).back();
  const uint64_t places = outermost.first_place + outermost.places();
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
  return find_chain_defect(t);
}

}  // namespace promenade
