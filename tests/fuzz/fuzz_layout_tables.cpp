// Any bytes as tables.bin and as manifest.json: must end in an error or in tables that can be searched for defects.

#include <cstdint>
#include <span>
#include <string_view>

#include "layout/manifest.h"
#include "layout/tables_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace promenade;
  Result<StoredManifest> stored = parse_manifest(std::string_view(reinterpret_cast<const char*>(data), size));
  Result<ModelTables> tables = decode_tables(std::as_bytes(std::span(data, size)));
  Model model;
  if (stored) model.manifest = std::move(stored->manifest);
  if (tables) model.tables = std::move(*tables);
  static_cast<void>(find_defect(model));
  return 0;
}
