#pragma once
#include "runtime/gl_context.h"

namespace promenade {

/// Mesa's software rasteriser (llvmpipe) in memory: needs no display and no GPU.
Result<std::unique_ptr<GlContext>> create_osmesa_context();

}  // namespace promenade
