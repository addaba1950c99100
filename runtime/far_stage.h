#pragma once
// A side of a far picture on its way into a renderer.

#include <memory>

#include "runtime/model_source.h"
#include "runtime/renderer.h"

namespace promenade {

struct StagedFarSide {
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
  uint64_t triangles = 0;
  uint64_t bytes_read = 0;
};

/// Reads, checks, decodes and stages a side of a cell. What is drawn of it looks as it was drawn under Lighting{}: its
/// colours are lit already, so its normals all face that sun and what this gives is divided out. Any thread.
Result<StagedFarSide> stage_far_side(const ModelSource& source, const Renderer& renderer, FarCellId cell,
                                     uint32_t face);

/// What a side's mesh and texture take at most, staged or uploaded each, and what decoding takes besides.
struct FarSideBytes {
  uint64_t staged = 0, decoding = 0;
};
FarSideBytes far_side_bytes(const ModelSource& source, const Renderer& renderer, uint32_t face);

}  // namespace promenade
