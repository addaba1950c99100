#include "cli/console.h"
#include "geometry/process_memory.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace promenade {
namespace {

using std::chrono::duration;

constexpr double kQuietSeconds = 1;       // shorter stages need no progress
constexpr double kRedrawSeconds = 0.1;    // a bar; faster only flickers
constexpr double kLineSeconds = 10;       // without a terminal: a log should stay short
constexpr uint64_t kWarningsInFull = 20;  // a broken source may warn once a face

std::atomic<bool> interrupt_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void on_interrupt(int signal_number) {
  if (interrupt_requested.exchange(true)) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
}

size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string human_duration(double seconds) {
  const auto s = static_cast<uint64_t>(std::llround(std::max(0.0, seconds)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

ConsoleMonitor::ConsoleMonitor()
    : terminal_(isatty(STDERR_FILENO) == 1), stage_start_(Clock::now()), last_drawn_(stage_start_) {}

ConsoleMonitor::~ConsoleMonitor() {
  end_stage(Clock::now());
  if (warnings_ > kWarningsInFull) fmt::print(stderr, "... and {} more warnings\n", warnings_ - kWarningsInFull);
}

void ConsoleMonitor::progress(std::string_view stage, uint64_t done, uint64_t total) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (stage != stage_) {
    end_stage(now);
    stage_ = stage;
    done_ = 0;
    stage_start_ = last_drawn_ = now;
  }
  // Threads report in any order; a bar never runs backwards.
  done_ = std::max(done_, done), total_ = total;
  const double wait = terminal_ ? (bar_shown_ ? kRedrawSeconds : kQuietSeconds) : kLineSeconds;
  if (duration<double>(now - last_drawn_).count() >= wait) draw(now);
}

void ConsoleMonitor::draw(Clock::time_point now) {
  last_drawn_ = now;
  const double elapsed = duration<double>(now - stage_start_).count();
  const double share = total_ > 0 ? std::min(1.0, double(done_) / double(total_)) : 0;
  std::string text = total_ > 0 ? fmt::format("{}: {} of {}", stage_, human_count(done_), human_count(total_))
                                : fmt::format("{}: {}", stage_, human_count(done_));
  if (share > 0.01) text += fmt::format(", {} left", human_duration(elapsed / share - elapsed));
  if (!terminal_) {
    fmt::print(stderr, "{}\n", text);
    line_shown_ = true;
    return;
  }
  const size_t columns = terminal_columns();
  constexpr size_t kBar = 28;
  const auto filled = static_cast<size_t>(share * double(kBar));
  std::string line = fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(kBar - filled, '.'), text);
  if (line.size() >= columns) line.resize(columns - 1);
  fmt::print(stderr, "\r\x1b[K{}", line);
  std::fflush(stderr);
  bar_shown_ = true;
}

void ConsoleMonitor::end_stage(Clock::time_point now) {
  const double elapsed = duration<double>(now - stage_start_).count();
  if (bar_shown_) fmt::print(stderr, "\r\x1b[K");
  if (!stage_.empty() && (bar_shown_ || line_shown_ || elapsed >= kQuietSeconds))
    fmt::print(stderr, "{}: {} in {:.1f} s\n", stage_, human_count(done_), elapsed);
  bar_shown_ = line_shown_ = false;
}

void ConsoleMonitor::warning(std::string_view message) {
  const std::lock_guard lock(mutex_);
  if (++warnings_ > kWarningsInFull) return;
  if (bar_shown_) fmt::print(stderr, "\r\x1b[K");
  fmt::print(stderr, "warning: {}\n", message);
}

bool ConsoleMonitor::cancelled() const { return interrupt_requested.load(std::memory_order_relaxed); }

std::string human_bytes(uint64_t bytes) {
  constexpr std::array kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto value = double(bytes);
  size_t unit = 0;
  for (; value >= 1024 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string human_count(uint64_t count) {
  if (count < 100'000) return fmt::format("{}", count);
  if (count < 1'000'000) return fmt::format("{:.0f} thousand", double(count) / 1e3);
  if (count < 1'000'000'000) return fmt::format("{:.2f} million", double(count) / 1e6);
  return fmt::format("{:.2f} billion", double(count) / 1e9);
}

}  // namespace promenade
