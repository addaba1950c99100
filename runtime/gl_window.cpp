#include "runtime/gl_window.h"

// We load functions ourselves: without this GLFW would bring in gl.h.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>

#include "runtime/gl_functions.h"

namespace promenade {
namespace {

std::string glfw_reason() {
  const char* text = nullptr;
  return glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
}

class GlfwWindow final : public GlWindow {
 public:
  explicit GlfwWindow(GLFWwindow* window) : window_(window) {}
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow() override {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }

  Status make_current() override {
    glfwMakeContextCurrent(window_);
    return Done{};
  }
  Status load() {
    Result<GlFunctions> loaded =
        load_gl_functions([](const char* name) { return reinterpret_cast<GlProc>(glfwGetProcAddress(name)); });
    if (!loaded) return loaded.error();
    functions_ = *loaded;
    return Done{};
  }
  const GlFunctions& functions() const override { return functions_; }
  std::string_view kind() const override { return "window"; }

  GLFWwindow* handle() const override { return window_; }
  uint32_t width_px() const override { return size().first; }
  uint32_t height_px() const override { return size().second; }
  float scale() const override {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x > 0 ? x : 1;
  }
  bool closing() const override { return glfwWindowShouldClose(window_) == GLFW_TRUE; }
  void swap_and_poll() override {
    glfwSwapBuffers(window_);
    glfwPollEvents();
  }

 private:
  /// At least one pixel: a minimised window has none.
  std::pair<uint32_t, uint32_t> size() const {
    int width = 1, height = 1;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<uint32_t>(std::max(width, 1)), static_cast<uint32_t>(std::max(height, 1))};
  }

  GLFWwindow* window_;
  GlFunctions functions_;
};

}  // namespace

Result<std::unique_ptr<GlWindow>> create_gl_window(const std::string& title, uint32_t width_px, uint32_t height_px) {
  if (glfwInit() != GLFW_TRUE)
    return Error{fmt::format("no window: {}; without a display, use `promenade fly` or xvfb-run", glfw_reason())};
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* raw =
      glfwCreateWindow(static_cast<int>(width_px), static_cast<int>(height_px), title.c_str(), nullptr, nullptr);
  if (raw == nullptr) {
    const std::string reason = glfw_reason();
    glfwTerminate();
    return Error{fmt::format("no window with OpenGL 3.3: {}", reason)};
  }
  auto window = std::make_unique<GlfwWindow>(raw);
  PROMENADE_TRY(window->make_current());
  glfwSwapInterval(1);
  PROMENADE_TRY(window->load());
  return std::unique_ptr<GlWindow>(std::move(window));
}

}  // namespace promenade
