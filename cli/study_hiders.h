#pragma once
#include "cli/command.h"

namespace promenade {

/// `study hiders MODEL`: what each hider and chain costs and is worth.
Command add_study_hiders(CLI::App& study);

}  // namespace promenade
