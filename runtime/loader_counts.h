#pragma once
#include <cstdint>

namespace promenade {

/// Everything that loading did or refused to do, each cause counted.
struct LoaderCounts {
  uint64_t bytes_read = 0;
  uint64_t bytes_read_useful =
      0;                ///< of segments whose node was drawn before they left memory, and all vLODs and far pictures
  uint64_t pieces = 0;  ///< calls to the disk
  uint64_t reads = 0;   ///< runs of pieces that lie one behind the other in a file
  uint64_t nodes_loaded = 0, textures_loaded = 0;
  uint64_t nodes_along = 0;  ///< taken before more important ones, because they lay where the last read ended
  uint64_t nodes_evicted = 0;
  uint64_t loads_suspended = 0;     ///< a more important node came up between two pieces
  uint64_t loads_resumed = 0;       ///< bytes read earlier were used
  uint64_t partials_dropped = 0;    ///< suspended loads given up for room
  uint64_t staged_dropped = 0;      ///< decoded, then given up for room before the upload
  uint64_t waits_for_eviction = 0;  ///< room was on its way: the render thread had to let go first
  uint64_t refused_memory = 0;      ///< everything in memory mattered more
  uint64_t refused_too_large = 0;   ///< would not fit even alone beside the roots
  uint64_t failed_reads = 0, failed_decodes = 0, failed_uploads = 0;
  uint64_t vlods_loaded = 0, vlod_bytes_read = 0;  ///< what cells see; their bytes are in bytes_read, too
  uint64_t far_sides_loaded = 0, far_sides_uploaded = 0, far_bytes_read = 0;  ///< their bytes are in bytes_read, too
  uint64_t idle_steps = 0;                                                    ///< nothing was wanted
};

}  // namespace promenade
