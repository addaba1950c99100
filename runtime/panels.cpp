#include "runtime/panels.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cmath>

#include "runtime/panel_look.h"

namespace promenade {

Panels::Panels(GlWindow& window) : gl_(window.functions()) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leave no file behind
  set_panel_look(window.scale());
  ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Panels::~Panels() {
  gl_.delete_framebuffers(1, &framebuffer_);
  gl_.delete_textures(1, &texture_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Panels::begin() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Panels::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Panels::show(const Image& picture) {
  if (texture_ == 0) gl_.gen_textures(1, &texture_), gl_.gen_framebuffers(1, &framebuffer_);
  gl_.bind_texture(GL_TEXTURE_2D, texture_);
  gl_.pixel_storei(GL_UNPACK_ALIGNMENT, 1);
  const auto width = static_cast<GLsizei>(picture.width), height = static_cast<GLsizei>(picture.height);
  gl_.bind_framebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  if (picture.width == width_px_ && picture.height == height_px_) {
    gl_.tex_sub_image_2d(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture.pixels.data());
  } else {
    gl_.tex_parameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);  // it has no mip maps
    // Bytes as they are: neither the texture nor the window's framebuffer converts.
    gl_.tex_image_2d(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, picture.pixels.data());
    gl_.framebuffer_texture_2d(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    width_px_ = picture.width, height_px_ = picture.height;
  }
  gl_.bind_texture(GL_TEXTURE_2D, 0);
  // A copy, not a surface with a texture: where OpenGL draws on the processor it takes a part of the time.
  const ImVec2 size = ImGui::GetIO().DisplaySize, scale = ImGui::GetIO().DisplayFramebufferScale;
  const auto shown_width = static_cast<GLint>(std::lround(size.x * scale.x)),
             shown_height = static_cast<GLint>(std::lround(size.y * scale.y));
  const bool same = shown_width == width && shown_height == height;
  gl_.bind_framebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_.blit_framebuffer(0, 0, width, height, 0, shown_height, shown_width, 0, GL_COLOR_BUFFER_BIT,
                       same ? GL_NEAREST : GL_LINEAR);  // the picture's first row is its top
  gl_.bind_framebuffer(GL_READ_FRAMEBUFFER, 0);
}

}  // namespace promenade
