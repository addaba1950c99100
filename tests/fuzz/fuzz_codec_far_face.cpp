// Any bytes as one side of a far picture, alone and told against another's.
#include "codec/far_face.h"

namespace {

promenade::FarFace striped(uint32_t levels) {
  promenade::FarFace face;
  face.grid.levels = levels;
  face.colors = {face.grid.side(), face.grid.side(), {}};
  face.colors.pixels.resize(face.grid.vertices());
  for (size_t i = 0; i < face.colors.pixels.size(); ++i)
    face.colors.pixels[i] = {uint8_t(i * 7), uint8_t(i / 3), 50, uint8_t(i % 5 != 0 ? 255 : 0)};
  return face;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  static_cast<void>(promenade::decode_far_face(bytes));
  constexpr uint32_t kLargest = 6;
  static const std::array<promenade::FarFace, kLargest + 1> faces = {striped(0), striped(1), striped(2), striped(3),
                                                                     striped(4), striped(5), striped(6)};
  const uint32_t levels = size > 5 ? data[5] % (kLargest + 1) : 0;
  promenade::FarReference reference;
  reference.sides = {&faces[levels], nullptr, &faces[levels], &faces[levels], nullptr, &faces[levels]};
  reference.offset = {0.3, -0.1, 0.2};
  static_cast<void>(promenade::decode_far_face(bytes, size % 6, &reference));
  return 0;
}
