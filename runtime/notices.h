#pragma once
// What the window says over the picture, panel or not: what has just happened, and that a path is recorded or replayed.

#include <chrono>
#include <string>

namespace promenade {

/// One thread; draw() between Panels::begin() and end().
class Notices {
 public:
  /// Shown for some seconds at the window's foot. Empty: nothing.
  void say(std::string text);
  /// state: shown in the corner as long as it is given; empty: nothing.
  void draw(const std::string& state) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::string text_;
  Clock::time_point said_;
};

}  // namespace promenade
