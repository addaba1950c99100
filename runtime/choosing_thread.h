#pragma once
// Choosing frames on a thread of its own, while those chosen before are drawn. Source: [funkhouser1993] chapter 6: the
// pipeline (UVD)(R) with a queue between its stages.
//
//   ask() -> wishes -> the thread: FrameChooser::choose() -> chosen -> next(), drawing, learn()
//
// Frames are chosen and drawn in the order in which they are asked for. What a frame took is learnt from when the
// thread next chooses one: as many frames late as there are on the way.

#include <functional>
#include <memory>
#include <thread>

#include "runtime/bounded_queue.h"
#include "runtime/frame_chooser.h"
#include "runtime/thread_time.h"

namespace promenade {

/// Thread: all functions on the render thread. Starts when constructed, stops when destroyed.
class ChoosingThread {
 public:
  /// most: frames on the way at once, asked for and not yet learnt from; >= 1. wake: called when a frame is chosen, on
  /// the thread. chooser must outlive it; nobody else calls it meanwhile.
  ChoosingThread(FrameChooser& chooser, size_t most, std::function<void()> wake);
  ~ChoosingThread();
  ChoosingThread(const ChoosingThread&) = delete;
  ChoosingThread& operator=(const ChoosingThread&) = delete;

  void ask(FrameWish wish);
  /// Waits for the frame that was asked for first. There must be one.
  std::unique_ptr<ChosenFrame> next();
  /// What a frame took that next() gave: once for each, in their order.
  void learn(const FrameTook& took);
  /// Its memory is used again.
  void give_back(std::unique_ptr<ChosenFrame> frame);
  /// Processor time that it has taken.
  double cpu_ms() const { return cpu_ms_of(thread_); }

 private:
  void loop();

  FrameChooser& chooser_;
  const std::function<void()> wake_;
  BoundedQueue<FrameWish> wishes_;
  BoundedQueue<std::unique_ptr<ChosenFrame>> chosen_, free_;
  BoundedQueue<FrameTook> took_;
  std::thread thread_;
};

}  // namespace promenade
