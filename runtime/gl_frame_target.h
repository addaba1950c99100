#pragma once
// What frames are drawn into: colour, depth and node ids of one size, off screen.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "runtime/gl_functions.h"

namespace promenade {

/// Two framebuffers (sRGB colour; 32-bit ids) over one depth buffer of 32-bit floats. Thread: the context's.
class GlFrameTarget {
 public:
  explicit GlFrameTarget(const GlFunctions& gl) : gl_(gl) {}
  GlFrameTarget(const GlFrameTarget&) = delete;
  GlFrameTarget& operator=(const GlFrameTarget&) = delete;
  ~GlFrameTarget();

  /// Errors: a size that the driver does not take.
  Status resize(uint32_t width, uint32_t height);
  static uint64_t bytes(uint32_t width, uint32_t height) { return uint64_t(width) * height * (4 + 4 + 4); }

  void bind_color() const;
  void bind_ids() const;
  Image read_color() const;
  /// As stored: 0 to 1.
  std::vector<float> read_depth() const;
  std::vector<uint32_t> read_ids() const;
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  GLuint color_framebuffer() const { return framebuffers_[0]; }

 private:
  void release();

  const GlFunctions& gl_;
  uint32_t width_ = 0, height_ = 0;
  GLuint framebuffers_[2] = {0, 0};
  GLuint buffers_[3] = {0, 0, 0};  // colour, ids, depth
};

}  // namespace promenade
