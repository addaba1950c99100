#pragma once
// How near a picture is to the one that it should be: in pixels, in holes, in colour.

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "geometry/closest_point.h"
#include "raster/view.h"

namespace promenade {

/// A picture with its depths, rows from the top. Depths: metres along the view axis, infinity where nothing is.
struct DepthPicture {
  std::span<const float> depth_m;
  std::span<const glm::u8vec4> color;  ///< sRGB; empty: colours are not compared
};

/// Sums over views.
class PictureErrors {
 public:
  /// Least difference of a channel, of 255, that counts.
  static constexpr int kColorDifference = 16;

  /// Holds what was drawn against the reference. Both pictures are as large as the view says; `surface` is what was
  /// drawn (model space, as the view). Any number of processors; the sums do not depend on it. One thread at a time.
  void add(const RasterView& view, const DepthPicture& reference, const DepthPicture& drawn,
           const ClosestPointTree& surface);

  /// Points of the reference, one a pixel that shows something.
  uint64_t points() const { return points_; }
  /// Pixel error: for each point of the reference, the distance in the picture to the projection of the closest point
  /// of what was drawn. Quantiles are exact to 1/64 pixel, rounded up; the largest is exact. 0 without points.
  double quantile_px(double share) const;
  double largest_px() const { return largest_px_; }
  /// Pixels that show nothing although the reference and each of its eight neighbours there show something.
  uint64_t background_pixels() const { return background_pixels_; }
  /// Pixels whose colour differs by more than kColorDifference, in some channel, from that of each of the reference's
  /// nine pixels around.
  uint64_t pixels_of_other_color() const { return other_color_; }
  uint64_t pixels() const { return pixels_; }

 private:
  static constexpr size_t kBinsAPixel = 64, kBins = 256 * kBinsAPixel;
  struct Row;
  std::vector<uint64_t> histogram_ = std::vector<uint64_t>(kBins);  ///< the last bin: all beyond
  uint64_t points_ = 0, background_pixels_ = 0, other_color_ = 0, pixels_ = 0;
  double largest_px_ = 0;
};

}  // namespace promenade
