#pragma once
// The loader. The life of a request:
//
//   1. Selection (render thread) visits a node and prices it. ResidentSet::update() puts it into the priority list, or
//      moves it there.
//   2. Loader::step() takes the most important node that is not loaded and room for its next part (its textures that no
//      other node has brought, then its mesh). Less important nodes are evicted for it: what is still in the loader's
//      hands at once; what the renderer holds when the render thread next begins a frame, until when the loader waits.
//      If everything in memory matters more, nothing is loaded: `refused_memory`.
//      A node that lies right behind what was read last goes first if it matters nearly as much (along_share): reads
//      that follow each other on disk are one read to it.
//   3. It reads one piece (64 KiB) and returns. The next step asks the list again: if another node matters more by now,
//      this one is suspended with the bytes it has, and resumed from there when its turn comes back (unless they were
//      dropped for room).
//   4. With the last piece in, a step checks and decodes the part and stages it (interleaved vertices, mip maps)
//   outside
//      all locks. A part that fails is counted and its node never asked for again: its parent goes on standing in.
//   5. ResidentSet::upload() (render thread, within its time a frame) makes it a mesh or texture of the renderer; once
//      all parts of a node are there its flag is set, and the next selection may draw it.
//   6. It leaves when something more important needs its room. Roots never do. A texture leaves with the last node that
//      uses it.
//
// Source: [lakhia2004] section 4.3. Its bound, c_memory x sum of costs, was an estimate; here bytes are counted.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "runtime/far_store.h"
#include "runtime/loader_counts.h"
#include "runtime/resident_set.h"
#include "runtime/vlod_store.h"

namespace promenade {

struct LoaderOptions {
  uint64_t memory_bytes = uint64_t(256) << 20;  ///< hard bound on all that ResidentSet counts
  /// Bytes read between two looks at the priority list. Smaller: quicker to turn to what matters; larger: fewer calls.
  uint64_t piece_bytes = 64 << 10;
  std::optional<double> disk_mbps;  ///< emulate a disk of so many 10^6 bytes a second; nullopt: the disk as it is
  double disk_seek_ms = 0;          ///< emulated time for each read that does not go on where the last one ended
  /// A node is evicted only for one that matters more by this part: two that keep changing places do not chase each
  /// other through memory. 0: as published.
  double eviction_margin = 0.1;
  /// What lies behind the bytes read last is read next, without a seek, if it is wanted and matters at least this part
  /// of what matters most; 0: never, as published. Smaller: fewer seeks, more that comes early.
  double along_share = 0.25;
  /// Pictures with a longer side that nodes share are halved until they fit; 0: none is. nullopt: as far as those that
  /// a view cell sees need to fit into seven eighths of what the bound leaves for nodes: better all of them in half
  /// the resolution than half of them, for what lacks one picture is drawn as its ancestor.
  std::optional<uint32_t> texture_side;
};

/// Does the loading, a step at a time, on whatever single thread calls step().
class Loader {
 public:
  /// vlods, far: may be null. What is passed must outlive it.
  Loader(const ModelSource& source, const Renderer& renderer, ResidentSet& set, VlodStore* vlods,
         const LoaderOptions& options, FarStore* far = nullptr);

  enum class Outcome : uint8_t { worked, waiting, idle };
  struct Step {
    Outcome outcome = Outcome::idle;
    double busy_ms = 0;  ///< of the loader's time: what the step took, or what the emulated disk would have
    double owed_ms = 0;  ///< busy_ms less what has truly passed: what a thread must still sleep
  };
  /// One vLOD read, or one side of a far picture, or one piece of a part, or one part decoded and staged, or nothing to
  /// do. vLODs come first: they say what is wanted, and are small. Then what stands for most of the model.
  Step step();

 private:
  Step read_vlod();
  Step load_far();
  Step emulated(double taken_ms, uint64_t bytes);
  Step read(const ResidentSet::Task& task);
  Step decode(const ResidentSet::Task& task);

  const ModelSource& source_;
  const Renderer& renderer_;
  ResidentSet& set_;
  VlodStore* vlods_;
  FarStore* far_;
  LoaderOptions options_;
  static constexpr uint32_t kNoFile = 0xffffffffU;
  uint32_t last_file_ = kNoFile;  ///< where the emulated head stands
  uint64_t last_end_ = 0;
};

/// Runs a loader on a thread of low priority. Starts when constructed, stops when destroyed.
class LoaderThread {
 public:
  explicit LoaderThread(Loader& loader);
  ~LoaderThread();
  LoaderThread(const LoaderThread&) = delete;
  LoaderThread& operator=(const LoaderThread&) = delete;

  /// Without a limit it runs as it can (real time). With one: it may be busy for this long from now on and then pauses;
  /// what was left of an earlier grant is lost.
  void run_freely();
  void grant(double ms);
  /// Something changed (priorities, room): look again. Never waits for the thread, which has a low priority and may
  /// have lost its processor to others while it holds the mutex.
  void wake();
  /// Processor time that it has taken.
  double cpu_ms() const;
  /// Blocks until the loader has spent its grant, is idle or waits for the render thread.
  void wait();

 private:
  void loop();

  Loader& loader_;
  std::mutex mutex_;
  std::condition_variable changed_;
  double credit_ms_ = 0;  ///< guarded by mutex_
  bool free_ = true;      ///< guarded by mutex_: no limit
  bool quiet_ = false;    ///< guarded by mutex_: spent, idle or waiting
  bool stop_ = false;     ///< guarded by mutex_
  uint64_t seen_ = 0;     ///< guarded by mutex_: `wakes_` when it last looked
  std::atomic<uint64_t> wakes_{0};
  std::thread thread_;
};

}  // namespace promenade
