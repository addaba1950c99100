#include "layout/file_system.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "layout/file_io.h"

namespace promenade {
namespace {

template <class Value>
Value value_or_errno(Value value) {
  return value < 0 ? static_cast<Value>(-errno) : value;
}

void fill(const struct stat& status, FileInfo& info) {
  info.bytes = static_cast<uint64_t>(status.st_size);
  info.regular = S_ISREG(status.st_mode);
  info.folder = S_ISDIR(status.st_mode);
}

std::string_view remedy(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "; free some space or choose another folder";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; check the permissions";
    case ENOENT:
    case ENOTDIR:
      return "; check the name";
    case EMFILE:
    case ENFILE:
      return "; raise the limit of open files (ulimit -n)";
    case EIO:
      return "; the disk reports a fault";
    default:
      return "";
  }
}

}  // namespace

int FileSystem::open(const std::filesystem::path& path, int flags) {
  return value_or_errno(::open(path.c_str(), flags | O_CLOEXEC, 0644));
}

int64_t FileSystem::read_at(int descriptor, uint64_t offset, std::span<std::byte> into) {
  return value_or_errno(int64_t(::pread(descriptor, into.data(), into.size(), static_cast<off_t>(offset))));
}

int64_t FileSystem::write_at(int descriptor, uint64_t offset, std::span<const std::byte> bytes) {
  return value_or_errno(int64_t(::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset))));
}

int FileSystem::sync(int descriptor) { return value_or_errno(::fsync(descriptor)); }

int FileSystem::close(int descriptor) { return value_or_errno(::close(descriptor)); }

int FileSystem::info(int descriptor, FileInfo& info) {
  struct stat status = {};
  const int result = value_or_errno(::fstat(descriptor, &status));
  fill(status, info);
  return result;
}

int FileSystem::info(const std::filesystem::path& path, FileInfo& info) {
  struct stat status = {};
  const int result = value_or_errno(::stat(path.c_str(), &status));
  fill(status, info);
  return result;
}

int FileSystem::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  return value_or_errno(::rename(from.c_str(), to.c_str()));
}

int FileSystem::link(const std::filesystem::path& from, const std::filesystem::path& to) {
  return value_or_errno(::link(from.c_str(), to.c_str()));
}

int FileSystem::make_folder(const std::filesystem::path& path) { return value_or_errno(::mkdir(path.c_str(), 0755)); }

int FileSystem::remove(const std::filesystem::path& path) { return value_or_errno(std::remove(path.c_str())); }

FileSystem& real_file_system() {
  static FileSystem files;
  return files;
}

Error file_error(const std::filesystem::path& path, std::string_view action, int error_number) {
  return Error{fmt::format("{}: cannot {}: {}{}", path.string(), action, std::generic_category().message(error_number),
                           remedy(error_number))};
}

Status sync_folder(const std::filesystem::path& folder, FileSystem& files) {
  int descriptor = 0;
  do descriptor = files.open(folder, O_RDONLY | O_DIRECTORY);
  while (descriptor == -EINTR);
  if (descriptor < 0) return file_error(folder, "open the folder", -descriptor);
  int result = 0;
  do result = files.sync(descriptor);
  while (result == -EINTR);
  files.close(descriptor);
  // Network and union filesystems answer so when folders need no sync of their own.
  if (result < 0 && result != -EINVAL && result != -ENOTSUP) return file_error(folder, "sync the folder", -result);
  return Done{};
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  return folder.empty() ? std::filesystem::path(".") : folder;
}

}  // namespace promenade
