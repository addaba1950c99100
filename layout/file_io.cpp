#include "layout/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "layout/file_system.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;

constexpr size_t kBufferBytes = size_t(1) << 18;  // one system call for many small writes

/// Repeats a call that a signal interrupted.
template <class Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result == -EINTR) result = call();
  return result;
}

/// Linux releases the descriptor even when close() is interrupted, so that is no failure and must not be repeated.
int close_once(FileSystem& files, int descriptor) {
  const int result = files.close(descriptor);
  return result == -EINTR ? 0 : result;
}

Status write_fully(FileSystem& files, int descriptor, const fs::path& path, uint64_t offset,
                   std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const int64_t n = uninterrupted([&] { return files.write_at(descriptor, offset, bytes); });
    if (n < 0) return file_error(path, fmt::format("write {} bytes at byte {}", bytes.size(), offset), int(-n));
    if (n == 0) return file_error(path, fmt::format("write {} bytes at byte {}", bytes.size(), offset), ENOSPC);
    bytes = bytes.subspan(static_cast<size_t>(n));
    offset += static_cast<uint64_t>(n);
  }
  return Done{};
}

Status read_fully(FileSystem& files, int descriptor, const fs::path& path, uint64_t offset, std::span<std::byte> into) {
  while (!into.empty()) {
    const int64_t n = uninterrupted([&] { return files.read_at(descriptor, offset, into); });
    if (n < 0) return file_error(path, fmt::format("read {} bytes at byte {}", into.size(), offset), int(-n));
    if (n == 0)
      return Error{fmt::format("{}: ends at byte {}, {} more bytes are needed; the file is truncated", path.string(),
                               offset, into.size())};
    into = into.subspan(static_cast<size_t>(n));
    offset += static_cast<uint64_t>(n);
  }
  return Done{};
}

/// Opens a regular file for reading; a pipe or a folder is refused, not waited for.
Result<int> open_regular(FileSystem& files, const fs::path& path, FileInfo& info) {
  const int descriptor = uninterrupted([&] { return files.open(path, O_RDONLY | O_NONBLOCK); });
  if (descriptor < 0) return file_error(path, "open", -descriptor);
  if (const int result = uninterrupted([&] { return files.info(descriptor, info); }); result < 0) {
    close_once(files, descriptor);
    return file_error(path, "ask for the size", -result);
  }
  if (!info.regular) {
    close_once(files, descriptor);
    return Error{
        fmt::format("{}: is {}; a file is needed here", path.string(), info.folder ? "a folder" : "no regular file")};
  }
  return descriptor;
}

}  // namespace

struct AtomicFile::State {
  FileSystem* files = nullptr;
  fs::path final_path;
  fs::path partial_path;
  int descriptor = -1;
  uint64_t flushed_bytes = 0;
  std::vector<std::byte> buffer;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (descriptor >= 0) close_once(*files, descriptor);
    if (!partial_path.empty()) files->remove(partial_path);
  }

  Status flush() {
    PROMENADE_TRY(write_fully(*files, descriptor, partial_path, flushed_bytes, buffer));
    flushed_bytes += buffer.size();
    buffer.clear();
    return Done{};
  }
};

AtomicFile::AtomicFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;
AtomicFile& AtomicFile::operator=(AtomicFile&&) noexcept = default;
AtomicFile::~AtomicFile() = default;

Result<AtomicFile> AtomicFile::create(const fs::path& final_path, FileSystem& files) {
  if (!final_path.has_filename()) return Error{fmt::format("{}: is no file name", final_path.string())};
  FileInfo info;
  if (uninterrupted([&] { return files.info(final_path, info); }) >= 0 && info.folder)
    return Error{fmt::format("{}: is a folder; choose another name for the file", final_path.string())};
  auto state = std::make_unique<State>();
  state->files = &files;
  const fs::path partial = folder_of(final_path) / ("." + final_path.filename().string() + ".partial");
  state->descriptor = uninterrupted([&] { return files.open(partial, O_RDWR | O_CREAT | O_TRUNC); });
  if (state->descriptor < 0) return file_error(final_path, "create", -state->descriptor);
  state->final_path = final_path;
  state->partial_path = partial;
  return AtomicFile(std::move(state));
}

Status AtomicFile::write(std::span<const std::byte> bytes) {
  State& s = *state_;
  if (s.buffer.size() + bytes.size() > kBufferBytes) PROMENADE_TRY(s.flush());
  if (bytes.size() > kBufferBytes) {
    PROMENADE_TRY(write_fully(*s.files, s.descriptor, s.partial_path, s.flushed_bytes, bytes));
    s.flushed_bytes += bytes.size();
    return Done{};
  }
  s.buffer.insert(s.buffer.end(), bytes.begin(), bytes.end());
  return Done{};
}

Status AtomicFile::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  State& s = *state_;
  if (bytes.size() > size() || offset > size() - bytes.size())
    return Error{fmt::format("{}: {} bytes at byte {} reach beyond the {} bytes written so far",
                             s.partial_path.string(), bytes.size(), offset, size())};
  PROMENADE_TRY(s.flush());
  return write_fully(*s.files, s.descriptor, s.partial_path, offset, bytes);
}

uint64_t AtomicFile::size() const { return state_->flushed_bytes + state_->buffer.size(); }

Status AtomicFile::commit() {
  State& s = *state_;
  if (s.descriptor < 0) return Error{fmt::format("{}: was published already", s.final_path.string())};
  PROMENADE_TRY(s.flush());
  if (const int result = uninterrupted([&] { return s.files->sync(s.descriptor); }); result < 0)
    return file_error(s.partial_path, "sync", -result);
  if (const int result = close_once(*s.files, std::exchange(s.descriptor, -1)); result < 0)
    return file_error(s.partial_path, "close", -result);
  if (const int result = uninterrupted([&] { return s.files->rename(s.partial_path, s.final_path); }); result < 0)
    return file_error(s.final_path, "publish under this name", -result);
  s.partial_path.clear();
  return sync_folder(folder_of(s.final_path), *s.files);
}

Status write_file(const fs::path& path, std::span<const std::byte> bytes, FileSystem& files) {
  Result<AtomicFile> file = AtomicFile::create(path, files);
  if (!file) return file.error();
  PROMENADE_TRY(file->write(bytes));
  return file->commit();
}

Status write_file(const fs::path& path, std::string_view text, FileSystem& files) {
  return write_file(path, std::as_bytes(std::span(text)), files);
}

Result<std::vector<std::byte>> read_file(const fs::path& path, uint64_t max_bytes, FileSystem& files) {
  const Result<RandomAccessFile> file = RandomAccessFile::open(path, files);
  if (!file) return file.error();
  if (file->size() > max_bytes)
    return Error{
        fmt::format("{}: has {} bytes, more than the {} allowed here", path.string(), file->size(), max_bytes)};
  std::vector<std::byte> bytes(file->size());
  PROMENADE_TRY(file->read(0, bytes));
  return bytes;
}

Result<std::string> read_text_file(const fs::path& path, uint64_t max_bytes) {
  const Result<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file) return file.error();
  if (file->size() > max_bytes)
    return Error{
        fmt::format("{}: has {} bytes, more than the {} allowed here", path.string(), file->size(), max_bytes)};
  std::string text(file->size(), '\0');
  PROMENADE_TRY(file->read(0, std::as_writable_bytes(std::span(text))));
  return text;
}

struct RandomAccessFile::State {
  FileSystem* files = nullptr;
  fs::path path;
  int descriptor = -1;
  uint64_t bytes = 0;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (descriptor >= 0) close_once(*files, descriptor);
  }
};

RandomAccessFile::RandomAccessFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
RandomAccessFile::RandomAccessFile(RandomAccessFile&&) noexcept = default;
RandomAccessFile& RandomAccessFile::operator=(RandomAccessFile&&) noexcept = default;
RandomAccessFile::~RandomAccessFile() = default;

Result<RandomAccessFile> RandomAccessFile::open(const fs::path& path, FileSystem& files) {
  auto state = std::make_unique<State>();
  state->files = &files;
  state->path = path;
  FileInfo info;
  const Result<int> descriptor = open_regular(files, path, info);
  if (!descriptor) return descriptor.error();
  state->descriptor = *descriptor;
  state->bytes = info.bytes;
  return RandomAccessFile(std::move(state));
}

uint64_t RandomAccessFile::size() const { return state_->bytes; }

Status RandomAccessFile::read(uint64_t offset, std::span<std::byte> into) const {
  return read_fully(*state_->files, state_->descriptor, state_->path, offset, into);
}

FileLock::FileLock(int descriptor, fs::path path) : descriptor_(descriptor), path_(std::move(path)) {}
FileLock::FileLock(FileLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}
FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  return *this;
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  // Removed while still locked, so that nobody who waits for the name gets a lock on a file that is going away unseen:
  // acquire() looks whether its file still bears the name. A file that holds something is not ours to remove.
  struct stat status = {};
  if (::fstat(descriptor_, &status) == 0 && status.st_size == 0) ::unlink(path_.c_str());
  ::close(descriptor_);
}

Result<FileLock> FileLock::acquire(const fs::path& path, const std::string& what) {
  constexpr int kAttempts = 100;  // each lost only to a holder that let go in the same instant
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int descriptor = uninterrupted([&] { return real_file_system().open(path, O_RDWR | O_CREAT); });
    if (descriptor < 0) return file_error(path, "open the lock", -descriptor);
    FileLock lock(descriptor, path);
    const int locked = uninterrupted([&] { return ::flock(descriptor, LOCK_EX | LOCK_NB) < 0 ? -errno : 0; });
    if (locked < 0) {
      ::close(std::exchange(lock.descriptor_, -1));  // the file is the holder's
      if (locked != -EWOULDBLOCK) return file_error(path, "lock", -locked);
      return Error{
          fmt::format("{}: is in use by another process (lock {}); wait until it is done", what, path.string())};
    }
    struct stat ours = {};
    struct stat named = {};
    if (::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
        ours.st_dev == named.st_dev)
      return lock;
    ::close(std::exchange(lock.descriptor_, -1));
  }
  return Error{fmt::format("{}: the lock {} keeps changing hands; try again", what, path.string())};
}

}  // namespace promenade
