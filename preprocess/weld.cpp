#include "preprocess/weld.h"

#include <bit>

namespace promenade {

namespace {

constexpr uint32_t kFree = 0xffffffffU;

uint32_t hash(const glm::vec3& p) {
  // + 0 makes -0 into 0, which compares equal to it.
  uint64_t h = std::bit_cast<uint32_t>(p.x + 0.0F) * 0x9e3779b97f4a7c15ULL;
  h = (h ^ (h >> 29U) ^ std::bit_cast<uint32_t>(p.y + 0.0F)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 32U) ^ std::bit_cast<uint32_t>(p.z + 0.0F)) * 0x94d049bb133111ebULL;
  return static_cast<uint32_t>(h >> 32U);
}

}  // namespace

Places find_places(std::span<const glm::vec3> positions) {
  Places places;
  places.of_vertex.resize(positions.size());
  const size_t slots = std::bit_ceil(positions.size() * 2 + 1);
  std::vector<uint32_t> table(slots, kFree);  // open addressing: place numbers
  for (uint32_t v = 0; v < positions.size(); ++v) {
    size_t slot = hash(positions[v]) & (slots - 1);
    while (table[slot] != kFree && positions[places.first_vertex[table[slot]]] != positions[v])
      slot = (slot + 1) & (slots - 1);
    if (table[slot] == kFree) {
      table[slot] = static_cast<uint32_t>(places.first_vertex.size());
      places.first_vertex.push_back(v);
    }
    places.of_vertex[v] = table[slot];
  }
  return places;
}

}  // namespace promenade
