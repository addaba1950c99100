// Any bytes as one side of a far picture.
#include "codec/far_face.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static_cast<void>(promenade::decode_far_face(std::as_bytes(std::span(data, size))));
  return 0;
}
