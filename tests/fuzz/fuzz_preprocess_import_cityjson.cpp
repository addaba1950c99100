// Any bytes as CityJSON.

#include "tests/fuzz/fuzz_preprocess_import.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return promenade::fuzz_import(".json", data, size);
}
