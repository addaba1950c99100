#pragma once
// OpenGL 3.3 core contexts behind one interface: in memory (OSMesa), on a GPU without a display (EGL), in a window.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/result.h"

namespace promenade {

struct GlFunctions;

/// A context and its entry points. Belongs to the thread on which it is current; made current on creation.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual Status make_current() = 0;
  /// Entry points of this context, loaded through its own lookup: libOSMesa and libGL export functions of the same
  /// names, and only the context's own will do (which is also why libepoxy, that knows GLX, EGL and WGL, is not used).
  virtual const GlFunctions& functions() const = 0;
  /// "osmesa", "egl" or "window".
  virtual std::string_view kind() const = 0;
  /// Version and renderer as OpenGL gives them, for reports.
  std::string description() const;
};

enum class OffscreenKind : uint8_t {
  automatic,  ///< EGL where it gives a hardware device, else OSMesa
  osmesa,
  egl,
};
std::string_view name_of(OffscreenKind kind);
std::optional<OffscreenKind> offscreen_kind_named(std::string_view name);

/// A context that draws into framebuffer objects only. Errors: what the library says, and what to install.
Result<std::unique_ptr<GlContext>> create_offscreen_context(OffscreenKind kind = OffscreenKind::automatic);

}  // namespace promenade
