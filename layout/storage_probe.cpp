#include "layout/storage_probe.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "layout/file_system.h"

namespace promenade {
namespace {

constexpr uint32_t kLeastBlock = 512, kLargestBlock = 1 << 20;  // whatever a file system claims
constexpr size_t kAlignment = 4096;                             // O_DIRECT asks for it in memory
constexpr uint32_t kWriteBytes = 1 << 20;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

struct Free {
  void operator()(std::byte* bytes) const { std::free(bytes); }
};
using Buffer = std::unique_ptr<std::byte, Free>;

Buffer aligned_buffer(size_t bytes) {
  return Buffer(
      static_cast<std::byte*>(std::aligned_alloc(kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment)));
}

/// The file that is read in: without a name, gone when it is closed.
class Probe {
 public:
  Probe(const std::filesystem::path& folder, int descriptor) : folder_(folder), file_(descriptor) {}

  Status fill(uint64_t bytes, JobMonitor& monitor) {
    const Buffer buffer = aligned_buffer(kWriteBytes);
    if (buffer == nullptr) return Error{"no memory to measure storage with"};
    // Bytes that nothing on the way can compress.
    std::mt19937 random(1);
    std::generate_n(reinterpret_cast<uint32_t*>(buffer.get()), kWriteBytes / sizeof(uint32_t), std::ref(random));
    for (uint64_t at = 0; at < bytes; at += kWriteBytes) {
      if (monitor.cancelled()) return Error{"interrupted"};
      for (uint32_t done = 0; done < kWriteBytes;) {
        const ssize_t written = ::write(file_.get(), buffer.get() + done, kWriteBytes - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return file_error(folder_, "write a file to measure with", errno);
        done += static_cast<uint32_t>(written);
      }
      monitor.progress("storage", at, bytes);
    }
    if (::fsync(file_.get()) != 0) return file_error(folder_, "sync", errno);
    bytes_ = bytes;
    return Done{};
  }

  void ask_for_direct_reads() {
    const int flags = ::fcntl(file_.get(), F_GETFL);
    direct_ = flags >= 0 && ::fcntl(file_.get(), F_SETFL, flags | O_DIRECT) == 0;
  }

  uint32_t block_bytes() const {
    struct stat info {};
    if (::fstat(file_.get(), &info) != 0) return kAlignment;
    return std::clamp(static_cast<uint32_t>(info.st_blksize), kLeastBlock, kLargestBlock);
  }

  /// Median time of reads of that size, seconds.
  Result<double> time_reads(uint32_t bytes, uint32_t count, JobMonitor& monitor) {
    const Buffer buffer = aligned_buffer(bytes);
    if (buffer == nullptr) return Error{"no memory to measure storage with"};
    std::mt19937_64 random(bytes);
    std::vector<double> times;
    times.reserve(count);
    while (times.size() < count) {
      if (monitor.cancelled()) return Error{"interrupted"};
      const uint64_t place = random() % (bytes_ / bytes) * bytes;
      if (!direct_) ::posix_fadvise(file_.get(), 0, 0, POSIX_FADV_DONTNEED);
      const auto start = std::chrono::steady_clock::now();
      const ssize_t read = ::pread(file_.get(), buffer.get(), bytes, static_cast<off_t>(place));
      times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      if (read == static_cast<ssize_t>(bytes)) continue;
      times.pop_back();
      if (read < 0 && errno == EINTR) continue;
      if (!direct_ || read >= 0) return file_error(folder_, "read the file to measure with", read < 0 ? errno : EIO);
      // Some file systems take the flag and refuse the read.
      const int flags = ::fcntl(file_.get(), F_GETFL);
      ::fcntl(file_.get(), F_SETFL, flags & ~O_DIRECT);
      direct_ = false;
    }
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
  }

 private:
  std::filesystem::path folder_;
  Descriptor file_;
  uint64_t bytes_ = 0;
  bool direct_ = false;
};

}  // namespace

StorageProfile profile_of_reads(uint32_t small_bytes, double small_s, uint32_t large_bytes, double large_s) {
  constexpr double kLeast = 1e-9;  // of clocks that stand still
  StorageProfile profile{"measured", 0, 0, small_bytes};
  profile.bytes_per_s = (double(large_bytes) - double(small_bytes)) / std::max(large_s - small_s, kLeast);
  profile.seek_s = std::max(small_s - double(small_bytes) / profile.bytes_per_s, kLeast);
  return profile;
}

Result<StorageProfile> measure_storage(const std::filesystem::path& folder, const ProbeOptions& options,
                                       JobMonitor& monitor) {
  std::string name = (folder / ".promenade-probe-XXXXXX").string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return file_error(folder, "make a file to measure with", errno);
  ::unlink(name.c_str());
  Probe probe(folder, descriptor);
  const uint64_t least = 2 * uint64_t(std::max(options.large_bytes, kLargestBlock));
  PROMENADE_TRY(probe.fill(std::max(options.file_bytes, least), monitor));
  probe.ask_for_direct_reads();
  const uint32_t block = probe.block_bytes();
  const Result<double> small_s = probe.time_reads(block, std::max(options.small_reads, 1U), monitor);
  if (!small_s) return small_s.error();
  const uint32_t large = std::max(options.large_bytes / block, 2U) * block;
  const Result<double> large_s = probe.time_reads(large, std::max(options.large_reads, 1U), monitor);
  if (!large_s) return large_s.error();
  return profile_of_reads(block, *small_s, large, *large_s);
}

}  // namespace promenade
