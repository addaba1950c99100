#include "preprocess/import_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <span>

namespace promenade {

namespace {

constexpr size_t kPieceBytes = size_t(1) << 20;
constexpr size_t kMaxLineBytes = size_t(1) << 30;  // a CityJSON file of one line is read otherwise

constexpr std::string_view kSpace = " \t\r\n\v\f";

}  // namespace

Result<LineReader> LineReader::open(const std::filesystem::path& path, const std::string& name) {
  Result<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file.ok()) return file.error();
  return LineReader(*std::move(file), name);
}

/// Drops what was read and appends the next piece; false: nothing left or an error.
bool LineReader::fill() {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(position_));
  buffer_at_ += position_;
  position_ = 0;
  const uint64_t at = buffer_at_ + buffer_.size();
  const uint64_t left = file_.size() - std::min(at, file_.size());
  if (left == 0 || !status_.ok()) return false;
  if (buffer_.size() > kMaxLineBytes) {
    status_ = Error{
        fmt::format("{}: line {} is longer than {} bytes; the file is broken", name_, number_ + 1, kMaxLineBytes)};
    return false;
  }
  const size_t had = buffer_.size();
  // Doubling what there is keeps long lines linear.
  const auto wanted = static_cast<size_t>(std::min<uint64_t>(left, std::max(kPieceBytes, had)));
  buffer_.resize(had + wanted);
  status_ = file_.read(at, std::as_writable_bytes(std::span(buffer_).subspan(had)));
  return status_.ok();
}

bool LineReader::next(std::string_view& line) {
  size_t searched = 0;
  for (;;) {
    const char* begin = buffer_.data() + position_;
    const size_t there = buffer_.size() - position_;
    const void* end = there > searched ? std::memchr(begin + searched, '\n', there - searched) : nullptr;
    if (end == nullptr) {
      searched = there;
      if (fill()) continue;
      if (!status_.ok() || there == 0) return false;
    }
    begin = buffer_.data() + position_;
    size_t length =
        end == nullptr ? buffer_.size() - position_ : static_cast<size_t>(static_cast<const char*>(end) - begin);
    position_ += length + (end == nullptr ? 0 : 1);
    if (length > 0 && begin[length - 1] == '\r') --length;
    line = std::string_view(begin, length);
    ++number_;
    return true;
  }
}

std::string_view take_word(std::string_view& line) {
  const size_t begin = line.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  const size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

namespace {

template <class T>
bool parse(std::string_view word, T& value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

bool parse_number(std::string_view word, double& value) { return parse(word, value); }
bool parse_number(std::string_view word, int64_t& value) { return parse(word, value); }

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

}  // namespace promenade
