#include "runtime/window_renderer.h"

#include <fmt/format.h>

#include "runtime/calibration.h"
#include "runtime/cpu_renderer.h"

namespace promenade {
namespace {

/// Whether the CPU's renderer draws frames faster than the window's OpenGL: as measured here once.
bool cpu_is_faster(GlWindow& window) {
  const std::filesystem::path file = calibration_file("window");
  const std::string name = window.description();
  const Result<Calibration> known = calibrated(file, calibration_machine(name), [&]() -> Result<Calibration> {
    const Result<std::unique_ptr<GlRenderer>> gl = create_gl_renderer(window);
    if (!gl) return gl.error();
    return calibrate(**gl, name);
  });
  const std::string why = known ? reason_of(*known, file) : "auto: no OpenGL: " + known.error().message;
  const bool cpu = !known || known->cpu_is_faster();
  fmt::print(stderr, "renderer: {} ({})\n", cpu ? "cpu: visibility buffer" : name, why);
  return cpu;
}

}  // namespace

Result<WindowRenderer> make_window_renderer(RendererKind kind, GlWindow& window) {
  const bool on_cpu = kind == RendererKind::cpu || (kind == RendererKind::automatic && cpu_is_faster(window));
  WindowRenderer drawing;
  if (on_cpu) {
    drawing.renderer = create_cpu_renderer();
    return drawing;
  }
  Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(window);
  if (!renderer) return renderer.error();
  drawing.gl = renderer->get();
  drawing.renderer = std::move(*renderer);
  return drawing;
}

}  // namespace promenade
