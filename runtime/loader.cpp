#include "runtime/loader.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "runtime/decode_part.h"
#include "runtime/thread_time.h"

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// [lakhia2004] section 4.2: "at a low operating system priority".
constexpr int kNiceness = 10;
// A waiting loader looks again after so long even if nobody wakes it.
constexpr std::chrono::milliseconds kIdleWait(20);

}  // namespace

Loader::Loader(const ModelSource& source, const Renderer& renderer, ResidentSet& set, VlodStore* vlods,
               const LoaderOptions& options, FarStore* far)
    : source_(source), renderer_(renderer), set_(set), vlods_(vlods), far_(far), options_(options) {}

Loader::Step Loader::step() {
  if (vlods_ != nullptr)
    if (const Step step = read_vlod(); step.outcome == Outcome::worked) return step;
  if (far_ != nullptr)
    if (const Step step = load_far(); step.outcome == Outcome::worked) return step;
  const ResidentSet::Task task = set_.next_task(std::max<uint64_t>(1, options_.piece_bytes));
  switch (task.next) {
    case ResidentSet::Next::read:
      return read(task);
    case ResidentSet::Next::decode:
      return decode(task);
    case ResidentSet::Next::waiting:
      return {Outcome::waiting, 0, 0};
    case ResidentSet::Next::idle:
      break;
  }
  return {};
}

Loader::Step Loader::read_vlod() {
  const Clock::time_point begin = Clock::now();
  const VlodStore::Step step = vlods_->load_next();
  if (!step.worked) return {};
  return emulated(ms_since(begin), step.bytes);
}

Loader::Step Loader::load_far() {
  // Decoding is counted by the processor, as for nodes.
  const double begin_ms = own_cpu_ms();
  const FarStore::Step step = far_->load_next();
  if (!step.worked) return {};
  return emulated(own_cpu_ms() - begin_ms, step.bytes);
}

/// A read elsewhere of so many bytes.
Loader::Step Loader::emulated(double taken_ms, uint64_t bytes) {
  double emulated_ms = options_.disk_seek_ms;
  if (options_.disk_mbps) emulated_ms += double(bytes) / (*options_.disk_mbps * 1e6) * 1e3;
  last_file_ = kNoFile;
  const double busy_ms = std::max(taken_ms, emulated_ms);
  return {Outcome::worked, busy_ms, busy_ms - taken_ms};
}

Loader::Step Loader::read(const ResidentSet::Task& task) {
  const Clock::time_point begin = Clock::now();
  const SegmentRecord& segment = source_.model().tables.segments[task.part];
  const uint64_t at = segment.offset + task.offset;
  const bool contiguous = segment.file == last_file_ && at == last_end_;
  const Status status = source_.read_piece(task.part, task.offset, task.into);
  last_file_ = segment.file;
  last_end_ = at + task.into.size();
  if (status.ok())
    set_.finish_read(task, contiguous);
  else
    set_.fail(task, status.error());
  const double taken_ms = ms_since(begin);
  double emulated_ms = contiguous ? 0 : options_.disk_seek_ms;
  if (options_.disk_mbps) emulated_ms += double(task.into.size()) / (*options_.disk_mbps * 1e6) * 1e3;
  const double busy_ms = std::max(taken_ms, emulated_ms);
  return {Outcome::worked, busy_ms, busy_ms - taken_ms};
}

Loader::Step Loader::decode(const ResidentSet::Task& task) {
  // By the processor: on a busy machine the clock on the wall counts other programs, and a paced loader would be
  // charged for them.
  const double begin_ms = own_cpu_ms();
  StagedPart staged;
  const Status status = decode_part(source_, renderer_, task.node, set_.texture_of_part(task.part),
                                    set_.texture_limit(), task.stored, staged);
  if (!status.ok())
    set_.fail(task, status.error());
  else if (staged.mesh)
    set_.finish_mesh(task, std::move(staged.mesh));
  else
    set_.finish_texture(task, std::move(staged.texture));
  return {Outcome::worked, own_cpu_ms() - begin_ms, 0};
}

LoaderThread::LoaderThread(Loader& loader) : loader_(loader), thread_([this] { loop(); }) {}

LoaderThread::~LoaderThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LoaderThread::run_freely() {
  {
    const std::lock_guard lock(mutex_);
    free_ = true;
    quiet_ = false;
    ++wakes_;
  }
  changed_.notify_all();
}

void LoaderThread::grant(double ms) {
  {
    const std::lock_guard lock(mutex_);
    free_ = false;
    // A debt (a decode that took longer than was left) is carried over; what was left is not.
    credit_ms_ = std::min(credit_ms_, 0.0) + ms;
    quiet_ = false;
    ++wakes_;
  }
  changed_.notify_all();
}

void LoaderThread::wake() {
  ++wakes_;
  // Where this comes between its look at `wakes_` and its sleep it sleeps for kIdleWait.
  changed_.notify_all();
}

void LoaderThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stop_ || (quiet_ && seen_ == wakes_); });
}

double LoaderThread::cpu_ms() const { return cpu_ms_of(thread_); }

void LoaderThread::loop() {
  // Refused without rights on some systems: then it runs at the usual priority.
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness));
  std::unique_lock lock(mutex_);
  while (!stop_) {
    seen_ = wakes_;
    Loader::Step step;
    const bool allowed = free_ || credit_ms_ > 0;
    if (allowed) {
      lock.unlock();
      step = loader_.step();
      lock.lock();
      credit_ms_ -= step.busy_ms;
    }
    if (allowed && step.outcome == Loader::Outcome::worked) {
      // The emulated disk is still busy: sleep, unless told to stop.
      if (step.owed_ms > 0)
        changed_.wait_for(lock, std::chrono::duration<double, std::milli>(step.owed_ms), [this] { return stop_; });
      continue;
    }
    if (seen_ != wakes_) continue;  // something changed while it looked
    quiet_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, kIdleWait, [this] { return stop_ || seen_ != wakes_; });
  }
  quiet_ = true;
  changed_.notify_all();
}

}  // namespace promenade
