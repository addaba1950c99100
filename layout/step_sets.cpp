#include "layout/step_sets.h"

#include <algorithm>
#include <iterator>

namespace promenade {

std::vector<uint32_t> entering(std::span<const uint32_t> from, std::span<const uint32_t> to) {
  std::vector<uint32_t> ids;
  std::set_difference(to.begin(), to.end(), from.begin(), from.end(), std::back_inserter(ids));
  return ids;
}

std::vector<std::vector<uint32_t>> step_rows(std::span<const std::vector<uint32_t>> vlods,
                                             std::span<const CellFace> faces) {
  std::vector<std::vector<uint32_t>> rows;
  rows.reserve(2 * faces.size());
  for (const CellFace& face : faces) {
    const std::vector<uint32_t>&below = vlods[index_of(face.below)], &above = vlods[index_of(face.above)];
    rows.push_back(entering(below, above));
    rows.push_back(entering(above, below));
  }
  return rows;
}

}  // namespace promenade
