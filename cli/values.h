#pragma once
// The words that options are written in.

#include <cstdint>
#include <string>
#include <utility>

#include "geometry/camera.h"
#include "geometry/result.h"

namespace promenade {

/// "4GiB", "256MiB", "512 KiB", "1000000", "2GB" to bytes. Units of 1024 end in iB, of 1000 in B.
Result<uint64_t> parse_bytes(const std::string& text);

/// "1280x720": each side 1 to 16384.
struct PixelSize {
  uint32_t width = 1280, height = 720;
};
Result<PixelSize> parse_size(const std::string& text);

/// "x,y,z,yaw,pitch" (metres, degrees), optionally ",roll".
Result<Pose> parse_pose(const std::string& text);

/// "chair=0.25": a name (it may hold "=") and a weight from 0 to 1.
Result<std::pair<std::string, double>> parse_weight(const std::string& text);

}  // namespace promenade
