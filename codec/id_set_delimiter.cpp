// Where a number ends. A coded number is 11 (for 1), or ends in 0, or ends in 011; inside it no three ones meet.
// Between two stands 11 and the next begins with a 1, so three ones or more mean an end, but not where in them it is:
// the paper guesses and, when the guess turns out wrong, repairs it. The whole run of ones tells it at once. It holds
// the end of the number before (0 or 2 ones), a delimiter (2), four for each number 1 in between, and the beginning of
// the next longer number (1 or 2): odd or even gives the last of these, what is left over after fours the first.
#include "codec/id_set_delimiter.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/id_runs.h"

namespace promenade {
namespace {

constexpr unsigned kDelimiterOnes = 2;
constexpr unsigned kOnesOfNumberOne = 4;  // itself and a delimiter

/// A number of at least 2, without the delimiter.
void put_word(BitWriter& writer, uint32_t number) {
  unsigned ones = 0;  // at the end of what was put
  uint32_t last = 0, before = 0;
  const auto put = [&](uint32_t bit) {
    writer.put(bit, 1);
    before = last, last = bit;
    ones = bit != 0 ? ones + 1 : 0;
  };
  for (auto i = static_cast<unsigned>(std::bit_width(number)); i-- > 0;) {
    put(number >> i & 1U);
    if (ones == 2) put(0);
  }
  if (last == 1 && before == 0) put(1);
}

Error broken(size_t count) { return Error{fmt::format("broken code after {} ids", count)}; }

}  // namespace

void encode_delimited(std::span<const uint32_t> numbers, std::vector<std::byte>& bytes) {
  BitWriter writer(bytes);
  for (const uint32_t number : numbers) {
    if (number == 1)
      writer.put(3, 2);
    else
      put_word(writer, number);
    writer.put(3, 2);
  }
  // The last delimiter is followed by what begins a number and never ends.
  writer.put(2, 2);
}

DelimitedReader::Next DelimitedReader::next(uint32_t& number) {
  if (!started_) {
    started_ = true;
    const uint64_t ones = bits_.get_unary();
    if (bits_.overrun() || ones == 0) return Next::broken;
    word_ones_ = ones % 2 == 1 ? 1 : 2;
    if ((ones - word_ones_) % kOnesOfNumberOne != 0) return Next::broken;
    ones_left_ = (ones - word_ones_) / kOnesOfNumberOne;
  }
  if (ones_left_ > 0) {
    --ones_left_;
    number = 1;
    return Next::number;
  }
  return read_word(number);
}

DelimitedReader::Next DelimitedReader::read_word(uint32_t& number) {
  // A word that begins with one 1, then has nothing but zeros to the end of the bytes, is the end.
  constexpr unsigned kMostBits = 32;
  uint64_t value = word_ones_ == 1 ? 2 : 3;  // the zero of "10" belongs to it, that of "110" was put in
  while (true) {
    if (word_ones_ == 1 && value == 2 && bits_.at_padding()) return Next::end;
    const uint64_t ones = bits_.get_unary();
    if (bits_.overrun()) return Next::broken;
    if (ones > kDelimiterOnes) {
      const unsigned next_ones = ones % 2 == 1 ? 1 : 2;
      const uint64_t rest = ones - next_ones - kDelimiterOnes, mine = rest % kOnesOfNumberOne;
      if (mine != 0 && mine != 2) return Next::broken;
      if (mine == 2) value = value << 1 | 1U;
      ones_left_ = rest / kOnesOfNumberOne;
      word_ones_ = next_ones;
      if (value >> kMostBits != 0) return Next::broken;
      number = static_cast<uint32_t>(value);
      return Next::number;
    }
    value = ones == 0 ? value << 1 : (ones == 1 ? value << 2 | 2U : value << 2 | 3U);
    if (value >> (kMostBits + 1) != 0) return Next::broken;
  }
}

void encode_delimiter_ids(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  std::vector<uint32_t> numbers;
  numbers.reserve(ids.size());
  uint32_t free = 0;
  for (const uint32_t id : ids) numbers.push_back(id - free + 1), free = id + 1;
  encode_delimited(numbers, bytes);
}

Result<size_t> decode_delimiter_ids(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  DelimitedReader reader(bytes);
  uint64_t free = 0;
  size_t count = 0;
  for (uint32_t number = 0;;) {
    const DelimitedReader::Next next = reader.next(number);
    if (next == DelimitedReader::Next::end) return count;
    const uint64_t id = free + number - 1;
    if (next == DelimitedReader::Next::broken || id >= universe || count == into.size()) return broken(count);
    into[count++] = static_cast<uint32_t>(id);
    free = id + 1;
  }
}

void encode_delimiter_runs(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  std::vector<uint32_t> numbers;
  for_each_gap_run(ids, [&](uint32_t gap, uint32_t more) { numbers.push_back(gap + 1), numbers.push_back(more + 1); });
  encode_delimited(numbers, bytes);
}

Result<size_t> decode_delimiter_runs(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  DelimitedReader reader(bytes);
  RunSink sink(into, universe);
  while (true) {
    uint32_t gap = 0, length = 0;
    const DelimitedReader::Next next = reader.next(gap);
    if (next == DelimitedReader::Next::end) return sink.count();
    if (next == DelimitedReader::Next::broken || reader.next(length) != DelimitedReader::Next::number ||
        !sink.add(gap - 1, length - 1))
      return broken(sink.count());
  }
}

}  // namespace promenade
