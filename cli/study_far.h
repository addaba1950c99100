#pragma once
#include "cli/command.h"

namespace promenade {

/// study far: what far pictures take, alone and told against a neighbour's.
Command add_study_far(CLI::App& study);

}  // namespace promenade
