#pragma once
#include "runtime/gl_context.h"

namespace promenade {

/// A GPU without a display, through EGL devices. libEGL is opened at run time: a machine without it can do without.
/// hardware_only: refuse software devices (there OSMesa is the better known way).
Result<std::unique_ptr<GlContext>> create_egl_context(bool hardware_only);

}  // namespace promenade
