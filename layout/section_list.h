#pragma once
// Tables of entries in a file: the list at its front says where each begins and what it sums to. tables.bin and
// cells.bin share it; FORMAT.md has the bytes.

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "codec/byte_io.h"
#include "codec/frame.h"
#include "geometry/result.h"

namespace promenade {

/// A section as a format has it. Its number is its place in the format's list, from 1 on.
struct SectionKind {
  std::string_view name;
  uint32_t entry_bytes = 0;
};

/// A section as the list at a file's front has it.
struct SectionEntry {
  static constexpr uint64_t kBytes = 32;
  uint32_t number = 0;
  uint32_t entry_bytes = 0;
  uint64_t count = 0;
  uint64_t offset = 0;  ///< from the file's start
  uint64_t checksum = 0;
  uint64_t end() const { return offset + count * entry_bytes; }
};

inline SectionEntry get_section_entry(ByteReader& r) {
  SectionEntry e;
  e.number = r.get<uint32_t>(), e.entry_bytes = r.get<uint32_t>();
  e.count = r.get<uint64_t>(), e.offset = r.get<uint64_t>(), e.checksum = r.get<uint64_t>();
  return e;
}

constexpr uint64_t kSectionAlignment = 8;
/// Where the next section begins.
constexpr uint64_t aligned_section(uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

/// Sections on their way into a file, one behind the other.
class SectionWriter {
 public:
  /// offset: where the first of them begins in the file, a multiple of kSectionAlignment.
  explicit SectionWriter(uint64_t offset) : offset_(offset) {}

  /// put(ByteWriter&, entry) writes kind.entry_bytes. The section's line goes to the list.
  template <class Entry, class Put>
  void add(ByteWriter& list, const SectionKind& kind, const std::vector<Entry>& table, const Put& put) {
    while (bytes_.size() % kSectionAlignment != 0) bytes_.put(uint8_t(0));
    const size_t begin = bytes_.size();
    for (const Entry& entry : table) put(bytes_, entry);
    list.put(++number_), list.put(kind.entry_bytes), list.put(uint64_t(table.size()));
    list.put(offset_ + begin), list.put(checksum(bytes_.bytes().subspan(begin)));
  }
  std::vector<std::byte> take() { return bytes_.take(); }

 private:
  ByteWriter bytes_;
  uint64_t offset_;
  uint32_t number_ = 0;
};

/// Sections as a file has them, checked against the list. Safe on any bytes.
class SectionReader {
 public:
  /// bytes: the file's from offset to its end.
  SectionReader(std::span<const std::byte> bytes, uint64_t offset) : bytes_(bytes), offset_(offset), end_(offset) {}

  /// The next section, which must begin where the one before ends. get(ByteReader&, entry&) reads one entry.
  template <class Entry, class Get>
  Status read(const SectionEntry& listed, const SectionKind& kind, std::vector<Entry>& table, const Get& get) {
    const uint64_t due = aligned_section(end_);
    ++number_;
    if (listed.number != number_ || listed.entry_bytes != kind.entry_bytes || listed.offset != due)
      return Error{fmt::format("{} @{:#x}: section {} with entries of {} bytes, not {}, {}, @{:#x}", kind.name,
                               listed.offset, listed.number, listed.entry_bytes, number_, kind.entry_bytes, due)};
    const uint64_t at = due - offset_;
    if (at > bytes_.size() || listed.count > (bytes_.size() - at) / kind.entry_bytes)
      return Error{fmt::format("{} @{:#x}: {} entries of {} bytes reach beyond the end @{:#x}", kind.name,
                               listed.offset, listed.count, kind.entry_bytes, offset_ + bytes_.size())};
    const std::span<const std::byte> section = bytes_.subspan(at, listed.count * kind.entry_bytes);
    if (const uint64_t found = checksum(section); found != listed.checksum)
      return Error{
          fmt::format("{} @{:#x}: checksum {:016x} != {:016x}", kind.name, listed.offset, found, listed.checksum)};
    ByteReader reader(section);
    table.resize(listed.count);
    for (Entry& e : table) get(reader, e);
    end_ = listed.end();
    return Done{};
  }

  /// Nothing may follow the last section.
  Status finish() const {
    const uint64_t file_end = offset_ + bytes_.size();
    if (end_ == file_end) return Done{};
    return Error{fmt::format("end @{:#x}: {} bytes follow the last section", end_, file_end - end_)};
  }

 private:
  std::span<const std::byte> bytes_;
  uint64_t offset_;
  uint64_t end_;  ///< of the section that was read last
  uint32_t number_ = 0;
};

}  // namespace promenade
