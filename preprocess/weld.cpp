#include "preprocess/weld.h"

#include <algorithm>
#include <array>
#include <bit>

namespace promenade {

namespace {

constexpr uint32_t kFree = 0xffffffffU;
constexpr size_t kAhead = 16;  // vertices: a table larger than the cache answers late

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
  std::array<uint32_t, kAhead> hashes{};      // of the next vertices: what they will look up is on its way
  const auto foresee = [&](size_t v) {
    hashes[v % kAhead] = hash(positions[v]);
    __builtin_prefetch(&table[hashes[v % kAhead] & (slots - 1)]);
  };
  for (size_t v = 0; v < std::min(kAhead, positions.size()); ++v) foresee(v);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    size_t slot = hashes[v % kAhead] & (slots - 1);
    if (v + kAhead < positions.size()) foresee(v + kAhead);
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
