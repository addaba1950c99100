#pragma once
// From a segment's stored bytes to what the renderer uploads, with every claim of the tables checked.

#include <cstddef>
#include <memory>
#include <span>

#include "geometry/result.h"
#include "runtime/model_source.h"
#include "runtime/renderer.h"
#include "runtime/texture_limit.h"

namespace promenade {

/// One of the two.
struct StagedPart {
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
};

/// texture: its index, or kNoTexture for the node's mesh. Errors: whatever the decoder says; a mesh or picture larger
/// than the tables claim (it would break the memory bound); a material out of range; a texture that the node does not
/// list. Any thread.
Status decode_part(const ModelSource& source, const Renderer& renderer, NodeId node, uint32_t texture,
                   const TextureLimit& limit, std::span<const std::byte> stored, StagedPart& staged);

/// Heap bytes of a decoded mesh or picture at most, from what the tables claim.
uint64_t decoded_bytes_bound(const NodeRecord& node);
uint64_t decoded_bytes_bound(const TextureRecord& texture);

}  // namespace promenade
