#pragma once
#include "cli/command.h"

namespace promenade {

/// `study geometry MODEL`: what each way of coding a model's meshes costs, on the model's own nodes.
Command add_study_geometry(CLI::App& study);

}  // namespace promenade
