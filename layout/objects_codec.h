#pragma once
// A model's objects to the bytes of objects.bin and back; see FORMAT.md.

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "layout/cells_io.h"
#include "layout/objects.h"

namespace promenade {

constexpr uint32_t kObjectsVersion = 2;

/// owner: the tables that node ids are of. The same objects give the same bytes. Pure; any thread.
std::vector<std::byte> encode_objects(const ModelObjects& objects, const CellsOwner& owner);

/// Safe on any bytes; allocates no more than a bounded multiple of them. What the entries say is not checked here:
/// find_defect(Model) does. Errors begin with the section and its offset. Pure; any thread.
Result<ModelObjects> decode_objects(std::span<const std::byte> bytes, const CellsOwner& owner);

}  // namespace promenade
