#include "cli/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

extern char** environ;

namespace promenade {

Result<std::unique_ptr<VideoWriter>> VideoWriter::start(const std::filesystem::path& file, uint32_t width_px,
                                                        uint32_t height_px, double frames_per_s) {
  // Beside its place and with its ending, from which ffmpeg takes the format.
  const std::filesystem::path unfinished =
      file.parent_path() / fmt::format(".{}.{}{}", file.stem().string(), getpid(), file.extension().string());
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return Error{fmt::format("video: no pipe: {}", std::strerror(errno))};
  // yuv420p is what players play; it needs even sides.
  std::vector<std::string> words = {"ffmpeg",
                                    "-y",
                                    "-loglevel",
                                    "error",
                                    "-f",
                                    "rawvideo",
                                    "-pix_fmt",
                                    "rgba",
                                    "-s",
                                    fmt::format("{}x{}", width_px, height_px),
                                    "-r",
                                    fmt::format("{:.3f}", frames_per_s),
                                    "-i",
                                    "-",
                                    "-vf",
                                    "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                    "-pix_fmt",
                                    "yuv420p",
                                    "file:" + unfinished.string()};
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (failed != 0) {
    close(ends[1]);
    return Error{failed == ENOENT ? "video: there is no ffmpeg: install Debian's package \"ffmpeg\""
                                  : fmt::format("video: ffmpeg: {}", std::strerror(failed))};
  }
  std::signal(SIGPIPE, SIG_IGN);  // an ffmpeg that gives up is an error of write(), not our end
  return std::unique_ptr<VideoWriter>(
      new VideoWriter(file, unfinished, ends[1], process, size_t(width_px) * height_px * 4));
}

VideoWriter::~VideoWriter() {
  if (process_ > 0) static_cast<void>(wait());
  std::error_code gone;  // it is, once it has its name
  std::filesystem::remove(unfinished_, gone);
}

Status VideoWriter::add(const Image& frame) {
  const auto* bytes = reinterpret_cast<const char*>(frame.pixels.data());
  if (frame.pixels.size() * sizeof(frame.pixels[0]) != frame_bytes_)
    return Error{fmt::format("video: a frame of {} x {} pixels among others", frame.width, frame.height)};
  for (size_t done = 0; done < frame_bytes_;) {
    const ssize_t written = write(pipe_, bytes + done, frame_bytes_ - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return Error{"video: ffmpeg has given up: its message is above"};
    done += static_cast<size_t>(written);
  }
  return Done{};
}

Status VideoWriter::finish() {
  PROMENADE_TRY(wait());
  std::error_code failed;
  std::filesystem::rename(unfinished_, file_, failed);
  if (failed) return Error{fmt::format("{}: {}", file_.string(), failed.message())};
  return Done{};
}

Status VideoWriter::wait() {
  close(pipe_);
  int status = 0;
  const pid_t process = process_;
  process_ = 0;
  while (waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return Error{fmt::format("video: ffmpeg: {}", std::strerror(errno))};
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return Done{};
  return Error{"video: ffmpeg failed: its message is above"};
}

}  // namespace promenade
