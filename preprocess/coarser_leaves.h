#pragma once
// Nodes between a textured leaf and its parent: the leaf's triangles with smaller textures. A simple wall is all or
// nothing to the simplifier, but its picture need not be held whole in memory by whoever sees it from afar.

#include <cstdint>
#include <vector>

#include "preprocess/node_unit.h"
#include "preprocess/texture_store.h"

namespace promenade {

/// By texture of the leaf: which version (0: the whole one) a node shows whose texels are kTextureStep^power times as
/// large as the leaf's finest, as far as its textures are finer than that and have smaller versions. Pure.
std::vector<uint32_t> texture_versions(const UnitNode& leaf, uint32_t power, const TextureStore& textures);

/// The leaf's record with those versions: their texels are in its errors. Pure.
NodeRecord coarser_record(const UnitNode& leaf, uint32_t power, const TextureStore& textures);

/// Bit i: a node of power i is worth having, which is when it is well below its parent's error (parent: null at a root)
/// and takes at most half the memory of the next finer one. Bit 0, the leaf itself, is always set. Pure.
uint32_t worthwhile_powers(const UnitNode& leaf, const NodeRecord* parent, const TextureStore& textures);

}  // namespace promenade
