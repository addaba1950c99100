#pragma once
// The few programs that surfaces, their node ids and the sky are drawn with.

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "geometry/result.h"
#include "runtime/gl_functions.h"

namespace promenade {

/// What a surface program does. Variants rather than branches: discard switches early depth tests off, and a software
/// rasteriser pays for every texture that it samples.
struct SurfaceVariant {
  bool textured = false;
  bool masked = false;
  bool ids = false;     ///< writes the node's id instead of a colour
  bool fading = false;  ///< only at the pixels of a part of an ordered pattern
};

/// A linked program and where its uniforms are; -1: it has none of that name.
struct GlProgram {
  GLuint id = 0;
  GLint clip_from_mesh = -1, eye_from_mesh = -1, model_from_mesh_normal = -1;
  GLint has_normals = -1, has_colors = -1;
  GLint base_color = -1, alpha_cutoff = -1, opaque = -1, picture = -1, node = -1, fade = -1;
  GLint to_sun = -1, sun = -1, sky_ambient = -1, ground_ambient = -1;
  GLint forward = -1, right = -1, up = -1, zenith = -1, horizon = -1, below = -1, depth = -1;
};

/// Vertex attribute numbers.
constexpr GLuint kPositionAttribute = 0, kNormalAttribute = 1, kColorAttribute = 2, kTexcoordAttribute = 3;

/// Errors: the compiler's or linker's own words.
Result<GlProgram> build_surface_program(const GlFunctions& gl, const SurfaceVariant& variant);
Result<GlProgram> build_sky_program(const GlFunctions& gl);

}  // namespace promenade
