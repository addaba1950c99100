#include <fmt/format.h>

#include <bit>

#include "codec/adaptive_huffman.h"
#include "codec/bit_io.h"
#include "codec/id_runs.h"
#include "codec/id_set_delimiter.h"
#include "codec/id_set_rivals.h"

namespace promenade {
namespace {

constexpr uint32_t kEnd = 33;  // in the place of a gap's length
constexpr std::byte kByDelimiter{0}, kByHuffman{1};

void put_number(AdaptiveHuffman& lengths, BitWriter& writer, uint32_t value) {
  const auto length = static_cast<unsigned>(std::bit_width(value));
  lengths.put(writer, length);
  if (length > 1) writer.put(value, length - 1);  // the highest bit is a one
}

uint32_t get_rest(BitReader& reader, uint32_t length) {
  if (length <= 1) return length;
  return 1U << (length - 1) | reader.get(length - 1);
}

}  // namespace

void encode_huffman(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  BitWriter writer(bytes);
  AdaptiveHuffman gaps, runs;
  for_each_gap_run(ids, [&](uint32_t gap, uint32_t more) {
    put_number(gaps, writer, gap);
    put_number(runs, writer, more);
  });
  gaps.put(writer, kEnd);
}

Result<size_t> decode_huffman(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  BitReader reader(bytes);
  AdaptiveHuffman gaps, runs;
  RunSink sink(into, universe);
  while (true) {
    const uint32_t gap_length = gaps.get(reader);
    if (gap_length == kEnd && reader.at_padding()) return sink.count();
    if (gap_length == kEnd || reader.overrun()) break;
    const uint32_t gap = get_rest(reader, gap_length), run_length = runs.get(reader);
    if (run_length == kEnd) break;
    const uint32_t more = get_rest(reader, run_length);
    if (reader.overrun() || !sink.add(gap, more)) break;
  }
  return Error{fmt::format("broken code after {} ids", sink.count())};
}

void encode_paper(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes) {
  std::vector<std::byte> by_delimiter = {kByDelimiter}, by_huffman = {kByHuffman};
  encode_delimiter_runs(ids, universe, by_delimiter);
  encode_huffman(ids, universe, by_huffman);
  const std::vector<std::byte>& shorter = by_huffman.size() < by_delimiter.size() ? by_huffman : by_delimiter;
  bytes.insert(bytes.end(), shorter.begin(), shorter.end());
}

Result<size_t> decode_paper(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  if (bytes.empty() || bytes[0] > kByHuffman) return Error{"no code's number in the first byte"};
  return bytes[0] == kByDelimiter ? decode_delimiter_runs(bytes.subspan(1), universe, into)
                                  : decode_huffman(bytes.subspan(1), universe, into);
}

}  // namespace promenade
