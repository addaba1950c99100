#pragma once
// A window with an OpenGL context, through GLFW.

#include <memory>
#include <string>

#include "runtime/gl_context.h"

struct GLFWwindow;

namespace promenade {

/// Thread: the main one.
class GlWindow : public GlContext {
 public:
  virtual GLFWwindow* handle() const = 0;
  virtual uint32_t width_px() const = 0;  ///< of the framebuffer
  virtual uint32_t height_px() const = 0;
  virtual float scale() const = 0;  ///< of letters and lines: 2 where the display's pixels are half as large as usual
  virtual bool closing() const = 0;
  /// Shows what was drawn and takes in events; waits for the display where it can.
  virtual void swap_and_poll() = 0;
};

/// Errors: no display, or one without OpenGL 3.3.
Result<std::unique_ptr<GlWindow>> create_gl_window(const std::string& title, uint32_t width_px, uint32_t height_px);

}  // namespace promenade
