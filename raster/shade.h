#pragma once
// Colours for a visibility buffer: each pixel is shaded once, after all of them know what they show.
//
// colour = material x vertex colour x texture x light, in linear light, then sRGB. Light is Lambert's under a sun and a
// sky, evaluated at a triangle's corners and interpolated. Textures are trilinear; their derivatives come from the
// triangle. AlphaMode::blend is drawn as a screen door: of a surface with opacity 0.5 half of the pixels, in an ordered
// 8 x 8 pattern, so that no order of drawing matters and depth and ids stay those of what is seen.

#include <glm/vec3.hpp>

#include "raster/visibility.h"

namespace promenade {

struct ShadeOptions {
  unsigned threads = 0;  ///< 0: one a processor
  Simd simd = Simd::best;
  bool textures = true;  ///< false: materials' and vertices' colours only

  // Light; linear colours.
  glm::vec3 to_sun{0.40F, -0.55F, 0.73F};  ///< model space; need not be unit
  glm::vec3 sun{0.72F, 0.69F, 0.62F};
  glm::vec3 sky_ambient{0.30F, 0.34F, 0.40F};
  glm::vec3 ground_ambient{0.16F, 0.15F, 0.13F};

  // What is seen where nothing is; sRGB.
  bool sky = true;  ///< false: the plain colour
  glm::u8vec4 plain{0, 0, 0, 255};
  glm::u8vec4 zenith{84, 132, 196, 255};
  glm::u8vec4 horizon{200, 216, 232, 255};
  glm::u8vec4 below{120, 116, 108, 255};
};

/// The picture's colours, opaque sRGB, into `out` (resized only if its size differs). The buffer's items, meshes and
/// surfaces must still live. Meshes prepared without attributes are lit from nowhere in particular.
void shade(const VisibilityBuffer& buffer, const ShadeOptions& options, Image& out);

}  // namespace promenade
