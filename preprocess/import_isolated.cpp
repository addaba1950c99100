// The child writes its scene to a pipe, field by field; parent and child are one program, so no version is needed. The
// parent believes nothing: sizes are bounded by what comes, and meshes are checked like those of any reader.

#include "preprocess/import_isolated.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <span>
#include <type_traits>

namespace promenade {

namespace {

constexpr rlim_t kChildCpuSeconds = 600;          // longest import of a real file, many times over
constexpr rlim_t kChildBytes = rlim_t(16) << 30;  // of address space; bounds hostile files
constexpr size_t kPieceBytes = size_t(1) << 20;
constexpr int kPollMs = 100;

// Sanitizers' shadow memory takes terabytes of address space: with them it is not bounded. g++ defines macros, clang
// has features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kBoundAddressSpace = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kBoundAddressSpace = false;
#else
constexpr bool kBoundAddressSpace = true;
#endif
#else
constexpr bool kBoundAddressSpace = true;
#endif

/// Appends values; buffered, into a descriptor.
class PipeWriter {
 public:
  explicit PipeWriter(int descriptor) : descriptor_(descriptor) {}

  void bytes(std::span<const std::byte> data) {
    buffer_.insert(buffer_.end(), data.begin(), data.end());
    if (buffer_.size() >= kPieceBytes) flush();
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void value(const T& v) { bytes(std::as_bytes(std::span(&v, 1))); }
  template <class T>
  void list(const std::vector<T>& v) {
    value(uint64_t(v.size()));
    bytes(std::as_bytes(std::span(v)));
  }
  void string(const std::string& s) {
    value(uint64_t(s.size()));
    bytes(std::as_bytes(std::span(s)));
  }
  bool flush() {
    size_t done = 0;
    while (ok_ && done < buffer_.size()) {
      const ssize_t n = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
      if (n > 0)
        done += static_cast<size_t>(n);
      else if (errno != EINTR)
        ok_ = false;
    }
    buffer_.clear();
    return ok_;
  }

 private:
  int descriptor_;
  std::vector<std::byte> buffer_;
  bool ok_ = true;
};

/// Takes values off; a short or absurd input makes ok() false and values empty.
class PipeReader {
 public:
  explicit PipeReader(std::span<const std::byte> data) : data_(data) {}

  bool ok() const { return ok_; }
  template <class T>
  T value() {
    T out{};
    if (data_.size() < sizeof(T)) {
      ok_ = false;
      return out;
    }
    std::memcpy(static_cast<void*>(&out), data_.data(), sizeof(T));
    data_ = data_.subspan(sizeof(T));
    return out;
  }
  template <class T>
  void list(std::vector<T>& out) {
    const auto size = value<uint64_t>();
    if (size > data_.size() / sizeof(T)) {
      ok_ = false;
      return;
    }
    out.resize(static_cast<size_t>(size));
    if (size != 0) std::memcpy(static_cast<void*>(out.data()), data_.data(), out.size() * sizeof(T));
    data_ = data_.subspan(out.size() * sizeof(T));
  }
  std::string string() {
    std::vector<char> chars;
    list(chars);
    return {chars.begin(), chars.end()};
  }
  /// A count of things that take at least a byte each.
  uint64_t count() {
    const auto n = value<uint64_t>();
    if (n <= data_.size()) return n;
    ok_ = false;
    return 0;
  }

 private:
  std::span<const std::byte> data_;
  bool ok_ = true;
};

void write_scene(PipeWriter& out, const ReadScene& read) {
  out.value(read.up), out.value(read.unit_m), out.value(read.sides_unknown);
  const Scene& scene = read.scene;
  out.value(uint64_t(scene.meshes.size()));
  for (const Mesh& mesh : scene.meshes) {
    out.list(mesh.positions), out.list(mesh.normals), out.list(mesh.texcoords), out.list(mesh.colors);
    out.list(mesh.indices), out.list(mesh.materials);
  }
  out.list(scene.materials);
  out.value(uint64_t(scene.textures.size()));
  for (const SourceTexture& texture : scene.textures) out.string(texture.name), out.list(texture.encoded);
  out.value(uint64_t(scene.instances.size()));
  for (const SceneInstance& i : scene.instances)
    out.value(i.mesh), out.value(i.world_from_mesh), out.string(i.name), out.string(i.class_name);
  out.value(uint64_t(scene.report.counts.size()));
  for (const auto& [key, count] : scene.report.counts) out.string(key), out.value(count);
  out.value(uint64_t(scene.report.warnings.size()));
  for (const std::string& warning : scene.report.warnings) out.string(warning);
}

ReadScene read_scene(PipeReader& in) {
  ReadScene read;
  read.up = in.value<UpAxis>(), read.unit_m = in.value<double>(), read.sides_unknown = in.value<bool>();
  Scene& scene = read.scene;
  for (uint64_t n = in.count(); n > 0 && in.ok(); --n) {
    Mesh& mesh = scene.meshes.emplace_back();
    in.list(mesh.positions), in.list(mesh.normals), in.list(mesh.texcoords), in.list(mesh.colors);
    in.list(mesh.indices), in.list(mesh.materials);
  }
  in.list(scene.materials);
  for (uint64_t n = in.count(); n > 0 && in.ok(); --n) {
    SourceTexture& texture = scene.textures.emplace_back();
    texture.name = in.string();
    in.list(texture.encoded);
  }
  for (uint64_t n = in.count(); n > 0 && in.ok(); --n) {
    SceneInstance& i = scene.instances.emplace_back();
    i.mesh = in.value<uint32_t>(), i.world_from_mesh = in.value<glm::dmat4>();
    i.name = in.string(), i.class_name = in.string();
  }
  for (uint64_t n = in.count(); n > 0 && in.ok(); --n) {
    const std::string key = in.string();
    scene.report.counts[key] = in.value<uint64_t>();
  }
  for (uint64_t n = in.count(); n > 0 && in.ok(); --n) scene.report.warnings.push_back(in.string());
  return read;
}

/// In the child: reads, writes, and leaves without running anything of the parent's.
[[noreturn]] void run_child(int descriptor, const std::function<Result<ReadScene>()>& read) {
  const rlimit cpu{kChildCpuSeconds, kChildCpuSeconds};
  const rlimit memory{kChildBytes, kChildBytes};
  const rlimit core{0, 0};
  setrlimit(RLIMIT_CPU, &cpu);
  setrlimit(RLIMIT_CORE, &core);
  if (kBoundAddressSpace) setrlimit(RLIMIT_AS, &memory);
  // A crash is the parent's to report; whatever handlers were inherited would speak as well.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
  PipeWriter out(descriptor);
  try {
    const Result<ReadScene> result = read();
    out.value(result.ok());
    if (result.ok())
      write_scene(out, *result);
    else
      out.string(result.error().message);
  } catch (const std::exception&) {
    _exit(1);
  }
  _exit(out.flush() ? 0 : 1);
}

/// All that comes until the child closes its end; false: cancelled.
bool receive(int descriptor, std::vector<std::byte>& data, JobMonitor& monitor) {
  for (;;) {
    if (monitor.cancelled()) return false;
    pollfd waiting{descriptor, POLLIN, 0};
    if (::poll(&waiting, 1, kPollMs) <= 0) continue;
    const size_t had = data.size();
    data.resize(had + kPieceBytes);
    const ssize_t n = ::read(descriptor, data.data() + had, kPieceBytes);
    data.resize(had + static_cast<size_t>(std::max<ssize_t>(n, 0)));
    if (n == 0 || (n < 0 && errno != EINTR)) return true;
  }
}

}  // namespace

Result<ReadScene> read_isolated(const std::string& name, const std::function<Result<ReadScene>()>& read,
                                JobMonitor& monitor) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return Error{fmt::format("{}: no pipe: {}", name, std::strerror(errno))};
  const pid_t child = ::fork();
  if (child < 0) {
    const int error = errno;
    ::close(ends[0]), ::close(ends[1]);
    return Error{fmt::format("{}: no process: {}", name, std::strerror(error))};
  }
  if (child == 0) {
    ::close(ends[0]);
    run_child(ends[1], read);
  }
  ::close(ends[1]);
  std::vector<std::byte> data;
  const bool whole = receive(ends[0], data, monitor);
  ::close(ends[0]);
  if (!whole) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!whole) return Error{"interrupted"};
  PipeReader in(data);
  const bool sound = in.value<bool>();
  const bool left_well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (left_well && in.ok() && sound) {
    ReadScene scene = read_scene(in);
    if (in.ok()) return scene;
  } else if (left_well && in.ok()) {
    if (std::string message = in.string(); in.ok()) return Error{message};
  }
  return Error{fmt::format("{}: the reader of this format gave up on it ({}); the file is broken or too large", name,
                           WIFSIGNALED(status) ? ::strsignal(WTERMSIG(status)) : "out of memory")};
}

}  // namespace promenade
