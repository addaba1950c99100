#pragma once
// Dear ImGui over a window: panels, and pictures that were not drawn by OpenGL.

#include <cstdint>

#include "geometry/mesh.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_window.h"

namespace promenade {

/// Dear ImGui for as long as it lives; one at a time. Thread: the main one.
class Panels {
 public:
  explicit Panels(GlWindow& window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Takes in events; panels are drawn between begin() and end().
  void begin();
  /// Draws what was said since begin() into the window.
  void end();
  /// Fills the window with a picture, behind all panels; what was drawn into it before is gone. Between begin() and
  /// end(); the picture may go afterwards.
  void show(const Image& picture);

 private:
  const GlFunctions& gl_;
  GLuint texture_ = 0, framebuffer_ = 0;
  uint32_t width_px_ = 0, height_px_ = 0;  ///< of the texture
};

}  // namespace promenade
