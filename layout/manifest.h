#pragma once
// A model's manifest to the text of manifest.json and back; see FORMAT.md.

#include <cstdint>
#include <string>
#include <string_view>

#include "geometry/result.h"
#include "layout/model.h"

namespace promenade {

/// A manifest and what ties it to its tables.
struct StoredManifest {
  ModelManifest manifest;
  uint64_t tables_checksum = 0;  ///< XXH3 of the whole of tables.bin
};

/// Readable JSON that ends with a checksum of all that stands before it.
std::string manifest_text(const StoredManifest& stored);

/// Errors name the field. A newer version is refused before its checksum is looked at. Safe on any text.
Result<StoredManifest> parse_manifest(std::string_view text);

}  // namespace promenade
