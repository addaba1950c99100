#include "runtime/gl_frame_target.h"

#include <fmt/format.h>

#include <algorithm>

namespace promenade {
namespace {

/// OpenGL's rows start at the bottom.
template <class Pixel>
void flip_rows(std::vector<Pixel>& pixels, uint32_t width, uint32_t height) {
  for (uint32_t y = 0; y < height / 2; ++y)
    std::swap_ranges(pixels.begin() + std::ptrdiff_t(y) * width, pixels.begin() + std::ptrdiff_t(y + 1) * width,
                     pixels.begin() + std::ptrdiff_t(height - 1 - y) * width);
}

}  // namespace

GlFrameTarget::~GlFrameTarget() { release(); }

void GlFrameTarget::release() {
  if (framebuffers_[0] == 0) return;
  gl_.delete_framebuffers(2, framebuffers_);
  gl_.delete_renderbuffers(3, buffers_);
  framebuffers_[0] = 0;
  width_ = height_ = 0;
}

Status GlFrameTarget::resize(uint32_t width, uint32_t height) {
  if (width == width_ && height == height_ && framebuffers_[0] != 0) return Done{};
  GLint most = 0;
  gl_.get_integerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  if (width == 0 || height == 0 || width > static_cast<uint32_t>(most) || height > static_cast<uint32_t>(most))
    return Error{fmt::format("OpenGL: a picture of {} x {} pixels; 1 to {} a side are possible", width, height, most)};
  release();
  gl_.gen_framebuffers(2, framebuffers_);
  gl_.gen_renderbuffers(3, buffers_);
  static constexpr GLenum kFormats[] = {GL_SRGB8_ALPHA8, GL_R32UI, GL_DEPTH_COMPONENT32F};
  for (size_t i = 0; i < 3; ++i) {
    gl_.bind_renderbuffer(GL_RENDERBUFFER, buffers_[i]);
    gl_.renderbuffer_storage(GL_RENDERBUFFER, kFormats[i], static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  }
  for (size_t i = 0; i < 2; ++i) {
    gl_.bind_framebuffer(GL_FRAMEBUFFER, framebuffers_[i]);
    gl_.framebuffer_renderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[i]);
    gl_.framebuffer_renderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[2]);
    const GLenum status = gl_.check_framebuffer_status(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
      return Error{fmt::format("OpenGL: no framebuffer of {} x {} pixels (status {:#x})", width, height, status)};
  }
  width_ = width;
  height_ = height;
  return Done{};
}

void GlFrameTarget::bind_color() const {
  gl_.bind_framebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
  gl_.viewport(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_));
}

void GlFrameTarget::bind_ids() const {
  gl_.bind_framebuffer(GL_FRAMEBUFFER, framebuffers_[1]);
  gl_.viewport(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_));
}

Image GlFrameTarget::read_color() const {
  Image image{width_, height_, std::vector<glm::u8vec4>(size_t(width_) * height_)};
  bind_color();
  gl_.pixel_storei(GL_PACK_ALIGNMENT, 1);
  gl_.read_pixels(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), GL_RGBA, GL_UNSIGNED_BYTE,
                  image.pixels.data());
  flip_rows(image.pixels, width_, height_);
  return image;
}

std::vector<float> GlFrameTarget::read_depth() const {
  std::vector<float> depth(size_t(width_) * height_);
  bind_color();
  gl_.pixel_storei(GL_PACK_ALIGNMENT, 1);
  gl_.read_pixels(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), GL_DEPTH_COMPONENT, GL_FLOAT,
                  depth.data());
  flip_rows(depth, width_, height_);
  return depth;
}

std::vector<uint32_t> GlFrameTarget::read_ids() const {
  std::vector<uint32_t> ids(size_t(width_) * height_);
  bind_ids();
  gl_.pixel_storei(GL_PACK_ALIGNMENT, 1);
  gl_.read_pixels(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), GL_RED_INTEGER, GL_UNSIGNED_INT,
                  ids.data());
  flip_rows(ids, width_, height_);
  return ids;
}

}  // namespace promenade
