#include "datasets/glb_spool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace promenade {
namespace {

constexpr size_t kBufferBytes = size_t(1) << 20;

Error system_error(const std::string& name, const char* doing) {
  return Error{fmt::format("{}: {}: {}", name, doing, std::generic_category().message(errno))};
}

/// A file without a name in the folder; where the file system cannot make one, a named file that loses its name at
/// once.
int open_nameless(const std::filesystem::path& beside) {
  const std::filesystem::path folder = beside.has_parent_path() ? beside.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return descriptor;
  std::string name = (folder / ("." + beside.filename().string() + ".spool.XXXXXX")).string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

GlbSpool::GlbSpool(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {
  buffer_.reserve(kBufferBytes);
}

GlbSpool::GlbSpool(GlbSpool&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      name_(std::move(other.name_)),
      written_(other.written_),
      buffer_(std::move(other.buffer_)) {}

GlbSpool& GlbSpool::operator=(GlbSpool&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(name_, other.name_);
  std::swap(written_, other.written_);
  std::swap(buffer_, other.buffer_);
  return *this;
}

GlbSpool::~GlbSpool() {
  // Nothing to check: the bytes have no name and nobody will read them.
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<GlbSpool> GlbSpool::create(const std::filesystem::path& beside) {
  const int descriptor = open_nameless(beside);
  if (descriptor < 0) return system_error(beside.string(), "cannot make a temporary file in its folder");
  return GlbSpool(descriptor, beside.string());
}

Status GlbSpool::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const size_t room = kBufferBytes - buffer_.size();
    const size_t count = std::min(room, bytes.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    bytes = bytes.subspan(count);
    if (buffer_.size() == kBufferBytes) PROMENADE_TRY(flush());
  }
  return Done{};
}

Status GlbSpool::flush() {
  for (size_t at = 0; at < buffer_.size();) {
    const ssize_t count = ::write(descriptor_, buffer_.data() + at, buffer_.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(name_, "writing its temporary file failed");
    at += static_cast<size_t>(count);
  }
  written_ += buffer_.size();
  buffer_.clear();
  return Done{};
}

Status GlbSpool::read_back(const std::function<Status(std::span<const std::byte>)>& take) {
  PROMENADE_TRY(flush());
  std::vector<std::byte> piece(kBufferBytes);
  for (uint64_t at = 0; at < written_;) {
    const ssize_t count = ::pread(descriptor_, piece.data(), piece.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(name_, "reading its temporary file failed");
    if (count == 0) return Error{fmt::format("{}: its temporary file was cut short at byte {}", name_, at)};
    PROMENADE_TRY(take(std::span(piece).first(static_cast<size_t>(count))));
    at += static_cast<uint64_t>(count);
  }
  return Done{};
}

}  // namespace promenade
