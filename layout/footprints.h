#pragma once
// Prisms that are known to be solid: what a source tells of its buildings.

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

namespace promenade {

/// A prism: everything over its plan from base to top is solid.
struct Footprint {
  float base_m = 0, top_m = 0;
  uint32_t loops_end = 0;  ///< its loops end here among all; they begin where the footprint's before it end
  bool operator==(const Footprint&) const = default;
};

/// Plans are given as loops: outlines counter-clockwise, holes in them clockwise. Model space, metres.
struct Footprints {
  std::vector<Footprint> all;
  std::vector<uint32_t> loop_ends;  ///< by loop: its points end here
  std::vector<glm::vec2> points;

  bool empty() const { return all.empty(); }
  uint32_t first_loop(size_t footprint) const { return footprint == 0 ? 0 : all[footprint - 1].loops_end; }
  std::span<const glm::vec2> loop(size_t number) const {
    const uint32_t first = number == 0 ? 0 : loop_ends[number - 1];
    return {points.data() + first, loop_ends[number] - first};
  }
  void append(const Footprints& others);
  /// What is wrong with it, of untrusted data; empty: nothing.
  std::string defect() const;
  bool operator==(const Footprints&) const = default;
};

}  // namespace promenade
