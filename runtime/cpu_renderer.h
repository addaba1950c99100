#pragma once
// The renderer on the CPU: the visibility buffer of raster/ behind the interface of renderer.h. Needs no context.

#include <memory>

#include "raster/visibility.h"
#include "runtime/renderer.h"

namespace promenade {

struct CpuRendererOptions {
  unsigned threads = 0;    ///< that draw a frame; 0: one a processor. The picture does not depend on it
  Simd simd = Simd::best;  ///< nor on this
};

/// Differs from OpenGL's pictures in this: AlphaMode::blend is a screen door (shade.h) and needs no order; light is
/// evaluated at corners; textures are trilinear without anisotropy; edges are not smoothed. Items may come in any
/// order.
std::unique_ptr<Renderer> create_cpu_renderer(const CpuRendererOptions& options = {});

}  // namespace promenade
