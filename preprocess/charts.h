#pragma once
// Cutting a mesh into flat charts and packing those into an atlas.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Triangles that are laid flat together, seen along one direction: none overlaps another, and none is tilted by more
/// than 45 degrees (those without area: any).
struct Chart {
  glm::vec3 origin{0};          ///< where the chart's coordinates are 0
  glm::vec3 right{0}, down{0};  ///< unit, at right angles
  glm::vec2 size_m{0};          ///< of the box around its triangles
  std::vector<uint32_t> triangles;

  /// Metres from the box's corner, within [0, size_m] for points of its triangles.
  glm::vec2 flat(const glm::vec3& p) const;
};

/// Every triangle in one chart, charts grown over shared edges from the largest triangles outwards. Deterministic.
std::vector<Chart> make_charts(const Mesh& mesh);

struct AtlasOptions {
  double texel_m = 0.1;         ///< wanted, > 0
  uint32_t max_side_px = 1024;  ///< of the atlas
  uint32_t padding_px = 2;      ///< around each chart
};

/// Where a chart lies in the atlas, padding included.
struct AtlasPlace {
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

struct AtlasLayout {
  uint32_t width = 0, height = 0;
  double texel_m = 0;              ///< as wanted, or larger so that all fits
  uint32_t padding_px = 0;         ///< as wanted, or less where that is what it took
  std::vector<AtlasPlace> places;  ///< by chart

  /// Texels from the atlas's corner for metres in a chart. The chart's box begins at the centre of a texel, so that
  /// filters find texels of its own around every point of it.
  glm::vec2 texels(size_t chart, const glm::vec2& flat_m) const;
};

/// Error: too many charts for the largest atlas. Deterministic.
Result<AtlasLayout> pack_charts(std::span<const Chart> charts, const AtlasOptions& options);

}  // namespace promenade
