#include "preprocess/work_folder.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <span>
#include <system_error>

#include "codec/frame.h"

namespace promenade {

namespace {

// magic, hash, payload bytes, checksum of the payload
constexpr uint64_t kMagic = 0x31'54'49'4e'55'4d'52'50;  // "PRMUNIT1"
constexpr size_t kHeaderBytes = 32;
using Header = std::array<uint64_t, kHeaderBytes / sizeof(uint64_t)>;

}  // namespace

Result<WorkFolder> WorkFolder::open(const std::filesystem::path& path, FileSystem& files) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code || !std::filesystem::is_directory(path, code))
    return Error{
        fmt::format("{}: cannot make the folder: {}", path.string(), code ? code.message() : "a file is there")};
  return WorkFolder(path, files);
}

std::optional<std::vector<std::byte>> WorkFolder::load(const std::string& unit, uint64_t hash) const {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path_of(unit), code)) return std::nullopt;
  Result<std::vector<std::byte>> bytes = read_file(path_of(unit), uint64_t(1) << 34, *files_);
  if (!bytes.ok() || bytes->size() < kHeaderBytes) return std::nullopt;
  Header header;
  std::memcpy(header.data(), bytes->data(), kHeaderBytes);
  if (header[0] != kMagic || header[1] != hash || header[2] != bytes->size() - kHeaderBytes) return std::nullopt;
  if (header[3] != checksum(std::span(*bytes).subspan(kHeaderBytes))) return std::nullopt;
  bytes->erase(bytes->begin(), bytes->begin() + kHeaderBytes);
  return std::move(*bytes);
}

Status WorkFolder::store(const std::string& unit, uint64_t hash, std::span<const std::byte> payload) const {
  Result<AtomicFile> file = AtomicFile::create(path_of(unit), *files_);
  if (!file.ok()) return file.error();
  const Header header{kMagic, hash, payload.size(), checksum(payload)};
  PROMENADE_TRY(file->write(std::as_bytes(std::span(header))));
  PROMENADE_TRY(file->write(payload));
  return file->commit();
}

Result<RandomAccessFile> WorkFolder::open_unit(const std::string& unit) const {
  return RandomAccessFile::open(path_of(unit), *files_);
}

Result<std::vector<std::byte>> WorkFolder::read(const RandomAccessFile& file, uint64_t offset, uint64_t bytes) const {
  std::vector<std::byte> into(static_cast<size_t>(bytes));
  PROMENADE_TRY(file.read(kHeaderBytes + offset, into));
  return into;
}

Status WorkFolder::remove() const {
  std::error_code code;
  std::filesystem::remove_all(path_, code);
  if (code) return Error{fmt::format("{}: cannot remove: {}", path_.string(), code.message())};
  return Done{};
}

}  // namespace promenade
