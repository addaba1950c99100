#pragma once
// A model's tables to the bytes of tables.bin and back; see FORMAT.md.

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "layout/model.h"

namespace promenade {

constexpr uint32_t kTablesVersion = 1;

/// The same tables give the same bytes. Pure; any thread.
std::vector<std::byte> encode_tables(const ModelTables& tables);

/// Safe on any bytes; allocates no more than the entries that they hold. What the entries say is not checked here:
/// find_defect(Model) does. Errors begin with the section and its offset. Pure; any thread.
Result<ModelTables> decode_tables(std::span<const std::byte> bytes);

}  // namespace promenade
