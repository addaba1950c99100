#pragma once
// The renderer on the CPU: the visibility buffer of raster/ behind the interface of renderer.h. Needs no context.

#include <memory>

#include "raster/visibility.h"
#include "runtime/renderer.h"

namespace promenade {

struct CpuRendererOptions {
  unsigned threads = 0;    ///< that draw a frame; 0: one a processor. The picture does not depend on it
  Simd simd = Simd::best;  ///< nor on this
  /// Antialias the borders between triangles (raster/shade.h, smooth_edges); costs a fifth to a quarter of a frame.
  bool smooth_edges = true;
  bool close_gaps = false;  ///< raster/gaps.h; costs a ninth to a seventh of a frame
  float anisotropy = 2;     ///< most samples along a slanted texel footprint; 1: off
};

/// Differs from OpenGL's pictures in this: edges are smoothed; light is evaluated at corners; of what is seen through
/// (AlphaMode::blend) the nearest three surfaces of each pixel are blended, sorted by pixel, those behind them are left
/// out. Items may come in any order.
std::unique_ptr<Renderer> create_cpu_renderer(const CpuRendererOptions& options = {});

}  // namespace promenade
