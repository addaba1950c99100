#include "preprocess/far/far_cell.h"

#include "preprocess/far/far_options.h"

namespace promenade {

Result<ShapedFar> draw_far_cell(const FarScene& scene, const FarTables& tables, uint64_t place) {
  const FarShell shell = grid_place_of(tables, place).grid;
  FarReach reach{box_of_place(tables, place).center(), shell.box_m, std::nullopt};
  if (const std::optional<uint64_t> around = place_around(tables, place)) {
    const glm::dvec3 centre = box_of_place(tables, *around).center();
    const double half_m = grid_place_of(tables, *around).grid.box_m * (0.5 + kFarOverlap);
    reach.within = DBox{centre - half_m, centre + half_m};
  }
  Result<FarView> view = FarView::make(scene, reach, tables.face_levels);
  if (!view) return view.error();
  std::array<std::optional<DrawnSide>, 6> sides;
  for (uint32_t s = 0; s < 6; ++s) {
    DrawnSide drawn;
    const Result<bool> any = view->draw(s, drawn.colors, drawn.depth_m);
    if (!any) return any.error();
    if (*any) sides[s] = std::move(drawn);
  }
  FarTables own = tables;  // of the one shell
  own.box_m = shell.box_m, own.cell_m = shell.cell_m;
  return shape_far(own, std::move(sides));
}

}  // namespace promenade
