#pragma once
// What a long job and its caller say to each other while it runs.

#include <cstdint>
#include <string_view>

namespace promenade {

/// Progress out, cancellation in. A job calls these from any of its threads, so an implementation must be safe for
/// that. The base class ignores everything: a job without an audience.
class JobMonitor {
 public:
  virtual ~JobMonitor() = default;

  /// stage: what is being done ("simplify", "write"); done of total units of it. total 0: not known yet.
  virtual void progress(std::string_view stage, uint64_t done, uint64_t total) {
    static_cast<void>(stage), static_cast<void>(done), static_cast<void>(total);
  }

  /// Something that the user should know and that does not stop the job.
  virtual void warning(std::string_view message) { static_cast<void>(message); }

  /// True once the user asked to stop (Ctrl-C): the job cleans up and returns Error{"interrupted"}.
  virtual bool cancelled() const { return false; }
};

}  // namespace promenade
