#pragma once
#include "cli/command.h"

namespace promenade {

/// `study orders MODEL`: what steps between cells cost to read, with the nodes in any order on any kind of storage.
Command add_study_orders(CLI::App& study);

}  // namespace promenade
