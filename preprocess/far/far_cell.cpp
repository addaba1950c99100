#include "preprocess/far/far_cell.h"

namespace promenade {

Result<ShapedFar> draw_far_cell(const FarScene& scene, const FarTables& tables, uint64_t place) {
  const glm::dvec3 centre = box_of_place(tables, place).center();
  Result<FarView> view = FarView::make(scene, centre, tables.box_m, tables.face_levels);
  if (!view) return view.error();
  std::array<std::optional<DrawnSide>, 6> sides;
  for (uint32_t s = 0; s < 6; ++s) {
    DrawnSide drawn;
    const Result<bool> any = view->draw(s, drawn.colors, drawn.depth_m);
    if (!any) return any.error();
    if (*any) sides[s] = std::move(drawn);
  }
  return shape_far(tables, std::move(sides));
}

}  // namespace promenade
