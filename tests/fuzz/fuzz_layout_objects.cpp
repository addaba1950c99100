// Any bytes as objects.bin: must end in an error or in objects that can be searched for defects and, without any,
// posed. A frame's checksum stops random changes, so the owner and the sum are put right first.

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "codec/frame.h"
#include "layout/model.h"
#include "layout/objects_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace promenade;
  constexpr size_t kSumOffset = 24, kHeaderBytes = 32;
  const CellsOwner owner{1, 3};
  const std::vector<std::byte> content(std::as_bytes(std::span(data, size)).begin(),
                                       std::as_bytes(std::span(data, size)).end());
  std::vector<std::byte> file = encode_objects({}, owner);
  file.resize(kHeaderBytes);
  const std::vector<std::byte> frame = compress_frame(content, 1);
  const uint64_t sum = checksum(frame);
  std::memcpy(file.data() + kSumOffset, &sum, sizeof sum);
  file.insert(file.end(), frame.begin(), frame.end());
  const Result<ModelObjects> objects = decode_objects(file, owner);
  if (!objects || !find_defect(objects->animation).empty()) return 0;
  const std::vector<glm::dmat4> poses = poses_at(objects->animation, 0.5);
  for (uint32_t joint = 0; joint < poses.size(); ++joint)
    static_cast<void>(swept_box(objects->animation, joint, {glm::dvec3(0), glm::dvec3(1)}));
  return 0;
}
