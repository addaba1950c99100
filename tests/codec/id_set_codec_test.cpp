#include "codec/id_set_codec.h"

#include <gtest/gtest.h>

#include <map>

#include "codec/id_set_delimiter.h"
#include "codec/id_set_rivals.h"
#include "tests/codec/id_set_fixtures.h"
#include "tests/golden.h"

namespace promenade {
namespace {

using Ids = std::vector<uint32_t>;

std::vector<std::byte> encoded(const IdSetCodec& codec, const Ids& ids, uint32_t universe) {
  std::vector<std::byte> bytes;
  codec.encode(ids, universe, bytes);
  return bytes;
}

class EveryIdSetCodec : public testing::TestWithParam<IdSetCodec> {
 protected:
  void expect_round_trip(const Ids& ids, uint32_t universe) {
    const std::vector<std::byte> bytes = encoded(GetParam(), ids, universe);
    Ids into(ids.size() + 3, 77);
    const Result<size_t> count = GetParam().decode(bytes, universe, into);
    ASSERT_TRUE(count.ok()) << count.error().message << ", " << ids.size() << " ids of " << universe;
    ASSERT_EQ(*count, ids.size());
    into.resize(*count);
    ASSERT_EQ(into, ids);
  }
  /// Any bytes give an error or a set.
  void expect_set_or_error(std::span<const std::byte> bytes, uint32_t universe, size_t room) {
    Ids into(room);
    const Result<size_t> count = GetParam().decode(bytes, universe, into);
    if (!count) return;
    ASSERT_LE(*count, room);
    for (size_t i = 0; i < *count; ++i) {
      ASSERT_LT(into[i], universe);
      ASSERT_TRUE(i == 0 || into[i - 1] < into[i]);
    }
  }
};

TEST_P(EveryIdSetCodec, brings_back_every_set_of_eleven_ids) {
  for (uint32_t universe : {1U, 5U, 11U})
    for (uint32_t bits = 0; bits < 1U << universe; ++bits) {
      Ids ids;
      for (uint32_t i = 0; i < universe; ++i)
        if ((bits >> i & 1U) != 0) ids.push_back(i);
      ASSERT_NO_FATAL_FAILURE(expect_round_trip(ids, universe));
    }
}

TEST_P(EveryIdSetCodec, brings_back_random_sets) {
  Random random(1);
  for (const uint32_t universe : {100U, 5000U, 1U << 20, 0x7fffffffU, 0xffffffffU})
    for (const uint32_t count : {1U, 10U, 90U, 1000U})
      for (const uint32_t run : {1U, 6U, 200U})
        ASSERT_NO_FATAL_FAILURE(expect_round_trip(random_ids(random, universe, count % universe, run), universe));
  expect_round_trip({0}, 0xffffffffU);
  expect_round_trip({0xfffffffeU}, 0xffffffffU);
  expect_round_trip({0, 0xfffffffeU}, 0xffffffffU);
}

TEST_P(EveryIdSetCodec, appends_to_what_is_there) {
  std::vector<std::byte> bytes(3, std::byte{9});
  GetParam().encode(Ids{4, 5, 6, 90}, 100, bytes);
  EXPECT_EQ(std::vector<std::byte>(bytes.begin() + 3, bytes.end()), encoded(GetParam(), {4, 5, 6, 90}, 100));
}

TEST_P(EveryIdSetCodec, refuses_more_ids_than_there_is_room_for) {
  Random random(2);
  const Ids ids = random_ids(random, 3000, 200, 4);
  const std::vector<std::byte> bytes = encoded(GetParam(), ids, 3000);
  for (const size_t room : {size_t(0), size_t(1), ids.size() / 2, ids.size() - 1}) {
    Ids into(room);
    EXPECT_FALSE(GetParam().decode(bytes, 3000, into).ok());
  }
}

TEST_P(EveryIdSetCodec, refuses_ids_beyond_the_universe) {
  const std::vector<std::byte> bytes = encoded(GetParam(), {7, 8, 500, 501}, 1000);
  Ids into(10);
  // To Elias-Fano the universe is a part of the code: under a smaller one the bytes are some other set, or none.
  if (GetParam().name != "elias-fano") {
    EXPECT_FALSE(GetParam().decode(bytes, 501, into).ok());
  }
  for (uint32_t universe = 0; universe < 1000; ++universe)
    ASSERT_NO_FATAL_FAILURE(expect_set_or_error(bytes, universe, 10));
}

TEST_P(EveryIdSetCodec, gives_a_set_or_an_error_for_every_truncation) {
  Random random(3);
  const std::vector<std::byte> bytes = encoded(GetParam(), random_ids(random, 4000, 150, 3), 4000);
  for (size_t size = 0; size < bytes.size(); ++size)
    ASSERT_NO_FATAL_FAILURE(expect_set_or_error(std::span(bytes).first(size), 4000, 200));
}

TEST_P(EveryIdSetCodec, gives_a_set_or_an_error_for_any_bytes) {
  Random random(4);
  const std::vector<std::byte> good = encoded(GetParam(), random_ids(random, 70000, 150, 3), 70000);
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::byte> bytes = good;
    if (i % 2 == 0) bytes.resize(random() % 60);
    for (uint32_t k = i % 2 == 0 ? 60 : 1 + random() % 3; k > 0 && !bytes.empty(); --k)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    for (const uint32_t universe : {0U, 1U, 501U, 70000U, 0xffffffffU})
      ASSERT_NO_FATAL_FAILURE(expect_set_or_error(bytes, universe, 300));
  }
}

std::string test_name(const testing::TestParamInfo<IdSetCodec>& info) {
  std::string name(info.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(IdSets, EveryIdSetCodec, testing::ValuesIn(id_set_codecs().begin(), id_set_codecs().end()),
                         test_name);

TEST(IdSetCodecs, are_found_by_name) {
  ASSERT_NE(find_id_set_codec("rice"), nullptr);
  EXPECT_EQ(find_id_set_codec("rice")->name, "rice");
  EXPECT_EQ(find_id_set_codec("lzw"), nullptr);
}

/// Sizes are exact: a change is a reviewed difference.
TEST(IdSetCodecs, keep_their_sizes) {
  std::string text;
  for (const uint32_t count : {20U, 100U, 1000U})
    for (const IdSetCodec& codec : id_set_codecs()) {
      Random random(5);
      size_t bytes = 0;
      for (int i = 0; i < 40; ++i) bytes += encoded(codec, random_ids(random, 1U << 20, count, 6), 1U << 20).size();
      // zstd and CRoaring may change with their versions.
      if (codec.name != "zstd" && codec.name != "roaring")
        text += std::string(codec.name) + " " + std::to_string(count) + " ids: " + std::to_string(bytes) + "\n";
    }
  expect_golden("id_set_sizes.txt", text);
}

std::string bits_of(std::span<const std::byte> bytes) {
  std::string bits;
  for (const std::byte b : bytes)
    for (int i = 7; i >= 0; --i) bits += (std::to_integer<unsigned>(b) >> i & 1U) != 0 ? '1' : '0';
  return bits;
}

/// A coded number from FORMAT.md, by text.
std::string delimited_word(uint32_t number) {
  if (number == 1) return "11";
  std::string digits, word;
  for (; number > 0; number /= 2) digits.insert(digits.begin(), number % 2 == 1 ? '1' : '0');
  for (size_t i = 0; i < digits.size(); ++i) {
    const bool pair = digits[i] == '1' && i + 1 < digits.size() && digits[i + 1] == '1';
    word += pair ? "110" : digits.substr(i, 1);
    i += pair ? 1 : 0;
  }
  if (word.ends_with("01")) word += "1";
  return word;
}

/// Every way in which the bits can be read: the slow decoder.
void read_all(const std::string& bits, size_t at, const std::map<std::string, uint32_t>& words, Ids& numbers,
              std::vector<Ids>& found) {
  const std::string_view rest = std::string_view(bits).substr(at);
  if (rest.starts_with("10") && rest.size() < 10 && rest.find('1', 1) == std::string_view::npos)
    found.push_back(numbers);
  for (const auto& [word, number] : words) {
    if (!rest.starts_with(word + "11")) continue;
    numbers.push_back(number);
    read_all(bits, at + word.size() + 2, words, numbers, found);
    numbers.pop_back();
  }
}

TEST(DelimiterCode, can_be_read_in_one_way_only) {
  constexpr uint32_t kMost = 15;
  std::map<std::string, uint32_t> words;
  for (uint32_t n = 1; n <= 4 * kMost; ++n) words[delimited_word(n)] = n;
  EXPECT_EQ(words.size(), 4 * kMost);
  Ids numbers;
  const auto check_all = [&](const auto& self, uint32_t more) -> void {
    std::vector<std::byte> bytes;
    encode_delimited(numbers, bytes);
    std::string expected;
    for (const uint32_t n : numbers) expected += delimited_word(n) + "11";
    ASSERT_EQ(bits_of(bytes).substr(0, expected.size() + 2), expected + "10");
    std::vector<Ids> found;
    Ids stack;
    read_all(bits_of(bytes), 0, words, stack, found);
    ASSERT_EQ(found, std::vector<Ids>{numbers});
    DelimitedReader reader(bytes);
    uint32_t number = 0;
    for (const uint32_t n : numbers) {
      ASSERT_EQ(reader.next(number), DelimitedReader::Next::number);
      ASSERT_EQ(number, n);
    }
    ASSERT_EQ(reader.next(number), DelimitedReader::Next::end);
    if (more == 0) return;
    for (uint32_t n = 1; n <= kMost; ++n) {
      numbers.push_back(n);
      ASSERT_NO_FATAL_FAILURE(self(self, more - 1));
      numbers.pop_back();
    }
  };
  check_all(check_all, 3);
}

TEST(DelimiterCode, brings_back_long_lists_of_ones_and_others) {
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    Ids numbers(random() % 200);
    for (uint32_t& n : numbers) n = random() % 3 != 0 ? 1 : 1 + (random() >> (random() % 32)) / 2;
    std::vector<std::byte> bytes;
    encode_delimited(numbers, bytes);
    DelimitedReader reader(bytes);
    uint32_t number = 0;
    for (const uint32_t n : numbers) {
      ASSERT_EQ(reader.next(number), DelimitedReader::Next::number);
      ASSERT_EQ(number, n);
    }
    ASSERT_EQ(reader.next(number), DelimitedReader::Next::end);
  }
}

TEST(DelimiterCode, has_the_bytes_of_the_example) {
  std::vector<std::byte> bytes;
  encode_delimited(Ids{1, 2, 3, 5}, bytes);
  EXPECT_EQ(bytes, (std::vector<std::byte>{std::byte{0xfb}, std::byte{0xdd}, std::byte{0xf0}}));
}

TEST(ZstdFrames, bring_back_many_sets) {
  Random random(7);
  std::vector<Ids> sets(40);
  for (size_t i = 1; i < sets.size(); ++i) sets[i] = random_ids(random, 5000, 1 + random() % 100, 3);
  const std::vector<std::byte> bytes = encode_zstd_frame(sets);
  Ids ids(10000), ends(sets.size());
  ASSERT_TRUE(decode_zstd_frame(bytes, 5000, ids, ends).ok());
  for (size_t i = 0; i < sets.size(); ++i) {
    const size_t begin = i == 0 ? 0 : ends[i - 1];
    EXPECT_EQ(Ids(ids.begin() + static_cast<std::ptrdiff_t>(begin), ids.begin() + ends[i]), sets[i]);
  }
  EXPECT_FALSE(decode_zstd_frame(bytes, 4000, ids, ends).ok());
  EXPECT_FALSE(decode_zstd_frame(bytes, 5000, ids, std::span(ends).first(39)).ok());
  EXPECT_FALSE(decode_zstd_frame(bytes, 5000, std::span(ids).first(10), ends).ok());
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_zstd_frame(std::span(bytes).first(size), 5000, ids, ends).ok());
}

}  // namespace
}  // namespace promenade
