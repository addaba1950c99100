#pragma once
// The renderer on OpenGL 3.3.

#include <memory>

#include "runtime/gl_context.h"
#include "runtime/renderer.h"

namespace promenade {

struct GlRendererOptions {
  float anisotropy = 8;  ///< most samples along a slanted texel footprint, where the driver can; 1: off
  /// Reversed depth with an infinite far plane where the driver can (glClipControl): even precision at any distance.
  bool reversed_depth = true;
};

/// A renderer that also shows its picture in the window that its context draws to.
class GlRenderer : public Renderer {
 public:
  /// Copies the last frame to the context's default framebuffer, scaled to the given size in pixels.
  virtual void present(uint32_t width_px, uint32_t height_px) = 0;
};

/// context must be current, outlive the renderer and stay on this thread. Errors: a shader that the driver refuses.
Result<std::unique_ptr<GlRenderer>> create_gl_renderer(GlContext& context, const GlRendererOptions& options = {});

}  // namespace promenade
