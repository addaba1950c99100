#pragma once
#include "cli/command.h"

namespace promenade {

/// `study codecs MODEL`: the bytes and the speed of every way to store what changes between neighbouring cells.
Command add_study_codecs(CLI::App& study);

}  // namespace promenade
