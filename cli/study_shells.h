#pragma once
#include "cli/command.h"

namespace promenade {

/// `study shells`: how large view cells may be around near geometry and far pictures, and what several shells of boxes
/// save: the plots and tables of [xiong1996] chapters 2 and 4. Needs no model.
Command add_study_shells(CLI::App& study);

}  // namespace promenade
