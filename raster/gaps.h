#pragma once
// Gaps between meshes that should meet, closed in the finished picture.
//
// Two nodes of different levels each lie within their error of the source's surface, and where they end they end at
// about the same line: fins (preprocess/fins.h) close what opens there, but for pixels whose centre hits a slit that
// rounding to 1/256 pixel left, and for what is coarser than its bound asks for. Such a pixel shows what lies far
// behind, between two surfaces that end on either side of it. It gets the triangle of the one that is nearer to it in
// the picture, if
// - the two, on opposite sides and no more than kGapReach pixels away, are of different items, at least one of which
//   may be off (RasterItem::error_m > 0), and neither has holes,
// - their triangles end no farther from the pixel's centre, together, than both errors are wide there, and rounding,
// - both surfaces, carried on to the pixel, are as far away as each other, give or take the errors and what their
//   depths change from pixel to pixel there.
// So slits between things that stand one behind the other stay, silhouettes stay where they are, and what is closed is
// never wider than what the front was chosen to be off by.

#include <cstdint>

#include "raster/visibility.h"

namespace promenade {

/// Closes the gaps of a picture drawn in perspective. Looks only at the picture as it was drawn, so that the result
/// does not depend on the number of threads or the processor. Returns how many pixels were closed.
uint64_t close_gaps(VisibilityBuffer::State& state, unsigned threads);

}  // namespace promenade
