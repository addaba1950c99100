#include "codec/id_set_rivals.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "codec/bit_io.h"
#include "codec/byte_io.h"
#include "codec/id_runs.h"
#include "codec/varint.h"

namespace promenade {
namespace {

Error broken(size_t count) { return Error{fmt::format("broken code after {} ids", count)}; }

/// The parameter that makes the Rice codes of the numbers shortest.
unsigned best_rice_parameter(std::span<const uint32_t> numbers) {
  unsigned best = 0;
  uint64_t least = ~uint64_t(0);
  for (unsigned k = 0; k < 32; ++k) {
    uint64_t bits = 0;
    for (const uint32_t n : numbers) bits += (n >> k) + 1 + k;
    if (bits < least) best = k, least = bits;
  }
  return best;
}

void put_rice(BitWriter& writer, uint32_t number, unsigned k) {
  writer.put_unary(number >> k);
  writer.put(number, k);
}

uint64_t get_rice(BitReader& reader, unsigned k) {
  const uint64_t high = reader.get_unary();
  return high << k | reader.get(k);
}

constexpr unsigned kRiceParameterBits = 5;

}  // namespace

void encode_raw(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  ByteWriter writer;
  for (const uint32_t id : ids) writer.put(id);
  bytes.insert(bytes.end(), writer.bytes().begin(), writer.bytes().end());
}

Result<size_t> decode_raw(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  const size_t count = bytes.size() / sizeof(uint32_t);
  if (bytes.size() % sizeof(uint32_t) != 0 || count > into.size())
    return Error{fmt::format("{} bytes are no set of at most {} ids", bytes.size(), into.size())};
  uint64_t free = 0;
  for (size_t i = 0; i < count; ++i) {
    uint32_t id = 0;
    for (size_t k = 0; k < sizeof(id); ++k) id |= std::to_integer<uint32_t>(bytes[4 * i + k]) << (8 * k);
    if (id < free || id >= universe) return broken(i);
    into[i] = id;
    free = uint64_t(id) + 1;
  }
  return count;
}

void encode_varint(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  for_each_gap_run(ids, [&](uint32_t gap, uint32_t more) { put_varint(bytes, gap), put_varint(bytes, more); });
}

Result<size_t> decode_varint(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  VarintReader reader(bytes);
  RunSink sink(into, universe);
  while (!reader.at_end()) {
    uint32_t gap = 0, more = 0;
    if (!reader.get(gap) || !reader.get(more) || !sink.add(gap, more)) return broken(sink.count());
  }
  return sink.count();
}

void encode_rice(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  std::vector<uint32_t> gaps, runs;
  for_each_gap_run(ids, [&](uint32_t gap, uint32_t more) { gaps.push_back(gap), runs.push_back(more); });
  const unsigned of_gaps = best_rice_parameter(gaps), of_runs = best_rice_parameter(runs);
  BitWriter writer(bytes);
  writer.put(of_gaps, kRiceParameterBits);
  writer.put(of_runs, kRiceParameterBits);
  for (size_t i = 0; i < gaps.size(); ++i) {
    writer.put(1, 1);
    put_rice(writer, gaps[i], of_gaps);
    put_rice(writer, runs[i], of_runs);
  }
  writer.put(0, 1);
}

Result<size_t> decode_rice(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  BitReader reader(bytes);
  RunSink sink(into, universe);
  const unsigned of_gaps = reader.get(kRiceParameterBits), of_runs = reader.get(kRiceParameterBits);
  while (reader.get(1) != 0) {
    const uint64_t gap = get_rice(reader, of_gaps), more = get_rice(reader, of_runs);
    if (reader.overrun() || !sink.add(gap, more)) return broken(sink.count());
  }
  if (!reader.at_padding()) return broken(sink.count());
  return sink.count();
}

void encode_elias_fano(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes) {
  put_varint(bytes, static_cast<uint32_t>(ids.size()));
  if (ids.empty()) return;
  const auto low_bits = static_cast<unsigned>(std::bit_width(universe / static_cast<uint32_t>(ids.size())) - 1);
  BitWriter writer(bytes);
  uint32_t high = 0;
  for (const uint32_t id : ids) {
    writer.put_unary((id >> low_bits) - high);
    high = id >> low_bits;
  }
  for (const uint32_t id : ids) writer.put(id, low_bits);
}

Result<size_t> decode_elias_fano(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  VarintReader head(bytes);
  uint32_t count = 0;
  if (!head.get(count) || count > into.size() || count > universe) return broken(0);
  if (count == 0) return head.at_end() ? Result<size_t>(size_t(0)) : Result<size_t>(broken(0));
  const auto low_bits = static_cast<unsigned>(std::bit_width(universe / count) - 1);
  BitReader reader(bytes.subspan(head.offset()));
  uint64_t high = 0;
  for (uint32_t i = 0; i < count; ++i) {
    high += reader.get_unary();
    if (reader.overrun() || high > universe >> low_bits) return broken(i);
    into[i] = static_cast<uint32_t>(high << low_bits);
  }
  uint64_t free = 0;
  for (uint32_t i = 0; i < count; ++i) {
    into[i] |= reader.get(low_bits);
    if (into[i] < free || into[i] >= universe) return broken(i);
    free = uint64_t(into[i]) + 1;
  }
  if (!reader.at_padding()) return broken(count);
  return count;
}

}  // namespace promenade
