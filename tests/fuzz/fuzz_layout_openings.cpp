// Any bytes as the content of openings.bin: must end in an error or in openings within their faces. A frame's checksum
// stops random changes, so the sums are put right first.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "codec/frame.h"
#include "layout/openings.h"
#include "tests/layout/cell_fixtures.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace promenade;
  constexpr size_t kFrameSumOffset = 32, kSumOffset = 40, kHeaderBytes = 48;
  const CellTables cells = three_cells();
  Openings none;
  none.regions = *regions_of(cells);
  none.first.assign(2 * none.regions.faces.size() + 1, 0);
  std::vector<std::byte> file = encode_openings(none, 1);
  file.resize(kHeaderBytes);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  const std::vector<std::byte> frame = compress_frame(bytes, 1);
  const uint64_t frame_sum = checksum(frame);
  std::memcpy(file.data() + kFrameSumOffset, &frame_sum, sizeof frame_sum);
  const uint64_t sum = checksum(std::span(file).first(kSumOffset));
  std::memcpy(file.data() + kSumOffset, &sum, sizeof sum);
  file.insert(file.end(), frame.begin(), frame.end());
  const Result<Openings> openings = decode_openings(file, cells, 1);
  if (!openings) return 0;
  for (uint32_t face = 0; face < openings->regions.faces.size(); ++face)
    for (const bool up : {false, true})
      for (const Box& box : openings->of(face, up))
        if (!rectangle_of(openings->regions, openings->regions.faces[face]).grown(kOpeningSlackM).contains(box))
          std::abort();
  return 0;
}
