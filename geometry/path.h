#pragma once
// Recorded camera paths.

#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"
#include "geometry/result.h"

namespace promenade {

/// Keys in ascending time; linear between them; before the first and after the last the pose stands still.
/// Yaw is interpolated as the numbers say (350 to 370 turns by 20 degrees, 350 to 10 by -340).
struct CameraPath {
  struct Key {
    double t_s = 0;
    Pose pose;
  };
  double fps = 30;  ///< (0, 1000]
  std::vector<Key> keys;

  double duration_s() const { return keys.empty() ? 0 : keys.back().t_s - keys.front().t_s; }
  /// Frames that a recording at `fps` has; at least 1 for a path with keys.
  uint32_t frame_count() const;
};

Pose pose_at(const CameraPath& path, double t_s);
Pose pose_of_frame(const CameraPath& path, uint32_t frame);

/// Stands stay_s (at least a frame) at one place of the path after the other, the next as far on in its time as makes
/// the last stay end with it, and jumps between them: what teleports are tried with. It lasts `seconds`; 0: as long as
/// the path.
CameraPath stops_along(const CameraPath& path, double stay_s, double seconds);

/// Reads {"fps": 30, "keys": [{"t", "eye": [x,y,z], "yaw_deg", "pitch_deg", "roll_deg"?}]}. Unknown names are ignored.
/// Refuses: no keys, times that do not ascend, numbers that are not finite. `name` is what the message calls the text.
Result<CameraPath> parse_path(std::string_view json, const std::string& name);
std::string to_json(const CameraPath& path);

}  // namespace promenade
