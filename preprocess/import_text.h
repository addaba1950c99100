#pragma once
// Text files read line by line, and numbers in them.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/result.h"
#include "layout/file_io.h"

namespace promenade {

/// Lines of a file (ended by LF, CR LF or the end). Holds one piece of the file, or one line if that is longer.
class LineReader {
 public:
  static Result<LineReader> open(const std::filesystem::path& path, const std::string& name);

  /// The next line without its end; valid until the next call. False at the end of the file, or when reading fails:
  /// then status() says why.
  bool next(std::string_view& line);
  uint64_t line_number() const { return number_; }
  /// Where the line after the last one starts: for formats with a text header.
  uint64_t byte_after() const { return buffer_at_ + position_; }
  uint64_t file_bytes() const { return file_.size(); }
  const Status& status() const { return status_; }

 private:
  LineReader(RandomAccessFile file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}
  bool fill();

  RandomAccessFile file_;
  std::string name_;
  std::vector<char> buffer_;
  uint64_t buffer_at_ = 0;  ///< place of the buffer in the file
  size_t position_ = 0;     ///< of the next line in the buffer
  uint64_t number_ = 0;
  Status status_ = Done{};
};

/// Takes the next word (up to white space) off the front; empty at the end.
std::string_view take_word(std::string_view& line);
/// The whole word as a number; false: it is none. "nan" and "inf" are numbers.
bool parse_number(std::string_view word, double& value);
bool parse_number(std::string_view word, int64_t& value);
std::string_view trimmed(std::string_view text);

}  // namespace promenade
