#pragma once
// Where somebody can stand in a cell: places for the eyes of pictures that check what is seen.

#include <optional>
#include <span>

#include "geometry/random.h"
#include "geometry/result.h"
#include "raster/visibility.h"

namespace promenade {

/// Random eyes of one cell, every second one on its boundary. None inside something solid: who looks at the backs of
/// one-sided surfaces in most directions stands where nobody stands. None below the ground or a roof, and none nearer
/// to a surface than the corners of a picture's near plane (kNearM). One thread at a time.
class EyeFinder {
 public:
  /// The camera's near plane for pictures from these eyes.
  static constexpr double kNearM = 0.005;

  /// items: what stands around the cell (model space), to live as long as the finder. oriented: two-sided surfaces face
  /// outwards as well, so that who looks at their backs is inside or below, too.
  EyeFinder(const Box& cell, std::span<const RasterItem> items, bool oriented, Random random);

  /// Another eye; nullopt: none found in a dozen tries. Deterministic. Errors: drawing.
  Result<std::optional<glm::dvec3>> next();

 private:
  enum class Free : uint8_t { unknown, yes, no };
  glm::dvec3 place();
  Status is_solid(const glm::dvec3& eye, bool& solid);

  Box cell_;
  std::span<const RasterItem> items_;
  bool oriented_;
  Random random_;
  uint32_t found_ = 0;    ///< eyes asked for so far
  bool touched_ = false;  ///< some box of an item reaches into the cell
  Free free_ = Free::unknown;
  VisibilityBuffer fronts_, both_;
};

/// A stream of numbers that belongs to a cell.
Random numbers_of(uint64_t seed, const Box& cell);

/// A picture from an eye in any direction, 60 degrees, steep ones rarer.
RasterView random_view(const glm::dvec3& eye, uint32_t side_px, Random& random);

}  // namespace promenade
