#pragma once
// Colours for a visibility buffer: each pixel is shaded once, after all of them know what they show.
//
// colour = material x vertex colour x texture x light, in linear light, then sRGB. Light is Lambert's under a sun and a
// sky, evaluated at a triangle's corners and interpolated. Textures are trilinear and anisotropic; their derivatives
// come from the triangle. What is seen through (AlphaMode::blend) is either part of the picture, as a screen door (of a
// surface with opacity 0.5 half of the pixels, in an ordered 8 x 8 pattern: no order of drawing, nothing sorted), or
// blended over it afterwards, layer by layer. The whole of it:
//
//   solid.draw(view, items, {.draw_blended = false});   layers[0].draw_layer(solid, nullptr, items); ...
//   shade(solid, options, picture);   smooth_edges(solid, options, picture);   blend_layers(layers, options, picture);

#include <glm/vec3.hpp>

#include "raster/visibility.h"

namespace promenade {

struct ShadeOptions {
  unsigned threads = 0;  ///< 0: one a processor
  Simd simd = Simd::best;
  bool textures = true;  ///< false: materials' and vertices' colours only
  /// Most samples along a texture's footprint where it is longer than wide, 1 to 16; 1: trilinear only. Costs only
  /// where a textured surface is seen at a slant.
  float anisotropy = 2;
  /// smooth_edges: least difference (of a channel, sRGB, 1 to 255) between pixels of different triangles for their
  /// border to be smoothed. Smaller: smoother, dearer.
  int edge_difference = 16;
  /// smooth_edges: the largest share of the picture's pixels that is smoothed; where more differ so much (overviews of
  /// little triangles), those that differ most. Bounds the time; a pixel takes as long as shading ten. 1: all.
  float most_smoothed = 0.04F;
  uint32_t least_smoothed_px = 30000;  ///< but so many pixels in any picture

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

/// The picture that shade made of the buffer, with the borders between differently coloured triangles antialiased:
/// where a pixel's neighbours show other triangles, 16 places in it are asked which of these triangles covers them
/// nearest (their own edges, depths and holes), and the colours that the pixels have are mixed. Fading meshes and
/// screen doors keep their pixels.
void smooth_edges(const VisibilityBuffer& buffer, const ShadeOptions& options, Image& picture);
/// The same of `in`, which stays as it is; `in` and `out` are two images.
void smooth_edges(const VisibilityBuffer& buffer, const ShadeOptions& options, const Image& in, Image& out);

/// Blends layers of VisibilityBuffer::draw_layer, the nearest first, all of one picture and the same items, over it.
void blend_layers(std::span<const VisibilityBuffer* const> layers, const ShadeOptions& options, Image& picture);

}  // namespace promenade
