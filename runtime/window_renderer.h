#pragma once
// Who draws into a window: its OpenGL or the CPU.

#include <memory>

#include "runtime/gl_renderer.h"
#include "runtime/gl_window.h"

namespace promenade {

struct WindowRenderer {
  std::unique_ptr<Renderer> renderer;
  GlRenderer* gl = nullptr;  ///< the same, if it draws with the window's OpenGL
};

/// Of the kind asked for; `automatic` is the faster, as measured here once and stored (says which on standard error).
/// Thread: the window's. Errors: those of create_gl_renderer.
Result<WindowRenderer> make_window_renderer(RendererKind kind, GlWindow& window);

}  // namespace promenade
