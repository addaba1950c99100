#pragma once
#include "cli/command.h"

namespace promenade {

/// `study policies MODEL`: one path with any number of policies, compared frame by frame.
Command add_study_policies(CLI::App& study);

}  // namespace promenade
