#include "runtime/gl_context.h"

#include <fmt/format.h>

#include "runtime/egl_context.h"
#include "runtime/gl_functions.h"
#include "runtime/osmesa_context.h"

namespace promenade {

std::string GlContext::description() const {
  const auto text = [this](GLenum name) {
    const GLubyte* value = functions().get_string(name);
    return std::string(value == nullptr ? "?" : reinterpret_cast<const char*>(value));
  };
  return fmt::format("{}: OpenGL {}, {}", kind(), text(GL_VERSION), text(GL_RENDERER));
}

std::string_view name_of(OffscreenKind kind) {
  switch (kind) {
    case OffscreenKind::automatic:
      return "automatic";
    case OffscreenKind::osmesa:
      return "osmesa";
    case OffscreenKind::egl:
      return "egl";
  }
  return "";
}

std::optional<OffscreenKind> offscreen_kind_named(std::string_view name) {
  for (const OffscreenKind kind : {OffscreenKind::automatic, OffscreenKind::osmesa, OffscreenKind::egl})
    if (name_of(kind) == name) return kind;
  return std::nullopt;
}

Result<std::unique_ptr<GlContext>> create_offscreen_context(OffscreenKind kind) {
  if (kind == OffscreenKind::osmesa) return create_osmesa_context();
  if (kind == OffscreenKind::egl) return create_egl_context(false);
  if (Result<std::unique_ptr<GlContext>> hardware = create_egl_context(true); hardware) return hardware;
  return create_osmesa_context();
}

}  // namespace promenade
