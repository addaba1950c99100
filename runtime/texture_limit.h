#pragma once
// How large pictures are kept when memory is short.

#include <cstdint>

#include "runtime/model_source.h"
#include "runtime/renderer.h"

namespace promenade {

/// Up to which size pictures that nodes share are kept: a side, or kAnySide. Atlases, made for one coarser node as that
/// needs them, are kept whole.
struct TextureLimit {
  uint32_t side_px = kAnySide;
  uint32_t of(const TextureRecord& texture) const {
    return (texture.flags & TextureRecord::kAtlas) != 0 ? kAnySide : side_px;
  }
};

/// The largest power of two to which shared pictures must be halved so that those of any one view cell fit into `bytes`
/// at once, as far as cells looked at here and there tell; kAnySide: they do as they are, or there are no cells. Never
/// below 64: smaller ones show nothing. Reads up to 64 vLODs; one that cannot be read does not count.
TextureLimit texture_limit_for(const ModelSource& source, uint64_t bytes);
/// What a picture within the limit takes, about: four bytes a texel, five with opacity, and a third more for mip
/// levels.
uint64_t limited_bytes(const TextureRecord& texture, const TextureLimit& limit);

/// The renderer's bound for a picture within the limit.
uint64_t limited_bytes_bound(const TextureRecord& texture, const Renderer& renderer, const TextureLimit& limit);

}  // namespace promenade
