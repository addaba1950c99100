#include "preprocess/far/far_groups.h"

#include <algorithm>
#include <map>

namespace promenade {

glm::uvec3 coordinates_of(const FarTables& tables, uint64_t place) { return grid_place_of(tables, place).at; }

std::vector<FarGroup> far_groups(const FarTables& tables, std::span<const uint64_t> places) {
  std::map<std::array<uint32_t, 4>, FarGroup> cubes;
  for (const uint64_t place : places) {
    const FarGridPlace found = grid_place_of(tables, place);
    const glm::uvec3 cube = found.at / kFarGroupCells;
    cubes[{found.shell, cube.z, cube.y, cube.x}].places.push_back(place);
  }
  std::vector<FarGroup> groups;
  groups.reserve(cubes.size());
  for (auto& [cube, group] : cubes) {
    std::vector<uint64_t>& members = group.places;
    std::sort(members.begin(), members.end());
    // Steps to all others, squared.
    const auto sum_of = [&](uint64_t from) {
      const glm::ivec3 at(coordinates_of(tables, from));
      int64_t sum = 0;
      for (const uint64_t other : members) {
        const glm::ivec3 d = glm::ivec3(coordinates_of(tables, other)) - at;
        sum += d.x * d.x + d.y * d.y + d.z * d.z;
      }
      return sum;
    };
    const auto key =
        std::min_element(members.begin(), members.end(), [&](uint64_t a, uint64_t b) { return sum_of(a) < sum_of(b); });
    std::rotate(members.begin(), key, key + 1);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace promenade
