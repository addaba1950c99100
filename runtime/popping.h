#pragma once
// How much of a picture popped: changed from one frame to the next beyond what the camera's motion explains.

#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace promenade {

/// A frame as the renderer read it back: colours, and metres along the view axis (+infinity: no surface).
struct SeenFrame {
  Camera camera;
  Image color;
  std::vector<float> depth_m;
};

struct Popping {
  uint64_t compared = 0;      ///< pixels whose surface the frame before had in view, too
  uint64_t popped = 0;        ///< of these: a colour that the frame before had nowhere near the same place
  uint64_t popped_areas = 0;  ///< of these: the mean of the 8 x 8 pixels around has changed so
  double popped_share() const { return compared == 0 ? 0 : double(popped) / double(compared); }
  double popped_area_share() const { return compared == 0 ? 0 : double(popped_areas) / double(compared); }
};

/// Takes each pixel's surface point (by depth) back into the frame before. Where that frame saw the same surface (depth
/// within 2 %), the colour is compared with the range of the 3 x 3 pixels there, which motion, sampling and smoothed
/// edges explain; more than 24 of 255 outside it in any channel has popped. Surfaces that come into view are not
/// compared. Sizes must be equal, else nothing is. Pure; any thread.
///
/// A fade that hands the picture over pixel by pixel turns as many single pixels as a switch at once, only in other
/// frames: by single pixels their sums are the same. What an eye sees of it is the mean over the pattern: areas compare
/// the means of 8 x 8 pixels, the size of the pattern of fades, with the range of those half an area around; more than
/// 6 of 255 outside (a fiftieth, about what is just seen) has popped.
Popping popping_between(const SeenFrame& before, const SeenFrame& now);

}  // namespace promenade
