#pragma once
// What `build --far-pictures` and `far` share.

#include "cli/command.h"
#include "preprocess/far/far_units.h"

namespace promenade {

/// --far-bound, --far-box and the others that say what pictures are to be made. group: of options.
void add_far_options(CLI::App& group, FarOptions& options);
Json json_of(const FarFigures& figures);
/// A line for people.
void print_far(const FarFigures& figures);

}  // namespace promenade
