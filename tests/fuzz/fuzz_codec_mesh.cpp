// Any bytes as a mesh: must end in an error or in a sound mesh. The first byte says whether the rest is a whole mesh or
// the payload of one, so that changes get behind the frame.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "codec/frame.h"
#include "codec/geometry_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace promenade;
  constexpr size_t kHeaderBytes = 24;
  std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  std::vector<std::byte> packed;
  if (!bytes.empty() && bytes[0] == std::byte{'p'} && bytes.size() > kHeaderBytes) {
    packed.assign(bytes.begin() + 1, bytes.begin() + 1 + kHeaderBytes);
    const std::vector<std::byte> frame = compress_frame(bytes.subspan(1 + kHeaderBytes), 1);
    packed.insert(packed.end(), frame.begin(), frame.end());
    bytes = packed;
  }
  const Result<Mesh> mesh = decode_mesh(bytes, uint64_t(1) << 22);
  if (mesh && !find_defect(*mesh).empty()) std::abort();
  return 0;
}
