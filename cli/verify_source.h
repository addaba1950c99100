#pragma once
// A model's pictures held against its untouched source's: pixel error, holes, colours.

#include <vector>

#include "cli/command.h"
#include "cli/values.h"
#include "layout/model_io.h"
#include "preprocess/import.h"
#include "runtime/policy.h"

namespace promenade {

struct VerifySourceOptions {
  std::vector<std::filesystem::path> sources;
  ImportOptions import;
  uint32_t views =
      20;  ///< in random directions from random eyes in view cells (without cells: on the ground, in the air)
  uint64_t seed = 1;
  std::filesystem::path path;  ///< a recorded path: views evenly along it instead; empty: none
  PixelSize size;
  double vertical_fov_deg = 60;
  double pixel_error = 1;
  Policy policy = Policy::static_error;
  std::filesystem::path
      picture;  ///< the view with most pixels of another colour: source, model, and where; empty: none
};

/// Adds to the figures and prints a summary. Draws with the CPU renderer. Errors: reading the model or the source; a
/// source that is not the model's (another number of triangles).
Status verify_source(const VerifySourceOptions& options, const ModelReader& reader, JobMonitor& monitor, Json& figures);

}  // namespace promenade
