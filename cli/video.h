#pragma once
// Frames to a video file, by Debian's ffmpeg as a program of its own.

#include <sys/types.h>

#include <filesystem>
#include <memory>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Pipes frames to ffmpeg, which takes the format from the file's ending. The file gets its name when it is whole. One
/// thread.
class VideoWriter {
 public:
  /// Errors: no ffmpeg (the message says which package has it), no more processes.
  static Result<std::unique_ptr<VideoWriter>> start(const std::filesystem::path& file, uint32_t width_px,
                                                    uint32_t height_px, double frames_per_s);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// frame: of the size given. Errors: ffmpeg has given up (its own message is on standard error).
  Status add(const Image& frame);
  /// Ends the video and names it; without it there is none. Errors: ffmpeg's exit status, the file's name.
  Status finish();

 private:
  VideoWriter(std::filesystem::path file, std::filesystem::path unfinished, int pipe, pid_t process, size_t frame_bytes)
      : file_(std::move(file)),
        unfinished_(std::move(unfinished)),
        pipe_(pipe),
        process_(process),
        frame_bytes_(frame_bytes) {}
  Status wait();

  std::filesystem::path file_, unfinished_;
  int pipe_;
  pid_t process_;
  size_t frame_bytes_;
};

}  // namespace promenade
