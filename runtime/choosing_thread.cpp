#include "runtime/choosing_thread.h"

#include <cassert>

namespace promenade {

ChoosingThread::ChoosingThread(FrameChooser& chooser, size_t most, std::function<void()> wake)
    : chooser_(chooser),
      wake_(std::move(wake)),
      wishes_(most),
      chosen_(most),
      free_(most + 1),
      took_(most),
      thread_([this] { loop(); }) {}

ChoosingThread::~ChoosingThread() {
  wishes_.close();
  chosen_.close();
  thread_.join();
}

void ChoosingThread::ask(FrameWish wish) { wishes_.put(std::move(wish)); }

std::unique_ptr<ChosenFrame> ChoosingThread::next() {
  std::optional<std::unique_ptr<ChosenFrame>> frame = chosen_.take();
  assert(frame);  // only the destructor closes the queue
  return std::move(*frame);
}

void ChoosingThread::learn(const FrameTook& took) { took_.put(took); }

void ChoosingThread::give_back(std::unique_ptr<ChosenFrame> frame) { free_.put(std::move(frame)); }

void ChoosingThread::loop() {
  while (const std::optional<FrameWish> wish = wishes_.take()) {
    while (const std::optional<FrameTook> took = took_.take_if_there()) chooser_.learn(*took);
    std::unique_ptr<ChosenFrame> frame = free_.take_if_there().value_or(nullptr);
    if (frame == nullptr) frame = std::make_unique<ChosenFrame>();
    chooser_.choose(*wish, *frame);
    wake_();
    if (!chosen_.put(std::move(frame))) return;
  }
}

}  // namespace promenade
