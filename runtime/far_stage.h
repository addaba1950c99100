#pragma once
// A side of a far picture on its way into a renderer.

#include <array>
#include <memory>
#include <optional>

#include "codec/far_face.h"
#include "codec/far_mesh.h"
#include "runtime/model_source.h"
#include "runtime/renderer.h"

namespace promenade {

struct StagedFarSide {
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
  uint64_t triangles = 0;
  uint64_t bytes_read = 0;
};

/// The key picture that was decoded last: sides of the cells around it are told against it. One thread.
class FarKey {
 public:
  /// The picture at a place of the grid; read unless it is the last one. Valid until the next call. Errors: there is
  /// none, one that is told against another itself, reading.
  Result<const FarReference*> at(const ModelSource& source, uint64_t place);
  /// What it takes at most.
  static uint64_t byte_size(const FarTables& tables);

 private:
  std::optional<uint64_t> place_;
  std::array<std::optional<FarFace>, 6> sides_;
  FarReference reference_;
};

/// Where a cell's side stands.
FarPlace place_of_far_side(const FarTables& tables, FarCellId cell, uint32_t face);

/// Reads, checks and decodes a side of a cell, with what it is told against. key: the thread's own.
Result<FarFace> read_far_side(const ModelSource& source, FarCellId cell, uint32_t face, FarKey& key);

/// Reads, checks, decodes and stages a side of a cell. What is drawn of it looks as it was drawn under Lighting{}: its
/// colours are lit already, so its normals all face that sun and what this gives is divided out. key: the thread's own.
Result<StagedFarSide> stage_far_side(const ModelSource& source, const Renderer& renderer, FarCellId cell, uint32_t face,
                                     FarKey& key);

/// What a side's mesh and texture take at most, staged or uploaded each, and what decoding takes besides, without a
/// key.
struct FarSideBytes {
  uint64_t staged = 0, decoding = 0;
};
FarSideBytes far_side_bytes(const ModelSource& source, const Renderer& renderer, uint32_t face);

}  // namespace promenade
