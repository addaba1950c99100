// Any bytes as a picture: must end in an error or in as many pixels as its size says.

#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/image_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace promenade;
  const Result<Image> image = decode_image(std::as_bytes(std::span(data, size)), "fuzz", uint64_t(1) << 20);
  if (image && image->pixels.size() != size_t(image->width) * image->height) std::abort();
  return 0;
}
