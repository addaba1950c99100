#pragma once
// Running a library that cannot be trusted with broken files in a process of its own.

#include <functional>
#include <string>

#include "geometry/result.h"
#include "preprocess/import_readers.h"

namespace promenade {

/// Runs `read` in a forked child, with bounded memory and processor time, and hands back the scene that it made.
/// A crash, a hang or an exhausted memory of the child becomes an error that names the file. Cancellation ends the
/// child.
Result<ReadScene> read_isolated(const std::string& name, const std::function<Result<ReadScene>()>& read,
                                JobMonitor& monitor);

}  // namespace promenade
