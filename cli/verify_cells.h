#pragma once
// Looking around in cells: is anything hidden that can be seen?

#include <string>

#include "cli/command.h"
#include "layout/model_io.h"
#include "preprocess/visibility/audit.h"

namespace promenade {

struct VerifyCellsOptions {
  uint32_t cells = 20;            ///< random ones; of stored cells each once before any twice
  std::filesystem::path model;    ///< its name, for messages
  std::string hiders;             ///< what they hide is checked instead of what the model stores; empty: the model's
  double pixel_error = 1;         ///< of the fronts, for a model without cells
  std::filesystem::path picture;  ///< the view with most misses; empty: none
  uint32_t skip_cells = 0;        ///< of these, that an earlier run has checked
  std::optional<double> seconds;  ///< no cell is begun later; nullopt: all are
  LookOptions looks;
};

/// Adds to the figures and prints a summary. Errors: reading the model; a hidden node that can be seen.
Status verify_cells(const VerifyCellsOptions& options, const ModelReader& reader, JobMonitor& monitor, Json& figures);

}  // namespace promenade
