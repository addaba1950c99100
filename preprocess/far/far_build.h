#pragma once
// Far pictures for a model that stands already.

#include <filesystem>

#include "layout/file_io.h"
#include "preprocess/far/far_units.h"

namespace promenade {

/// Makes the model's far pictures, or makes them anew, without building it again; it is whole at every moment.
/// memory_bytes: a bound, about; jobs: threads, 0: as many as cores. Interrupted or killed: the model is as before, the
/// work done so far stays in MODEL.work and is taken up again. Errors: as of build_model.
Result<FarFigures> add_far_pictures(const std::filesystem::path& model, const FarOptions& options,
                                    uint64_t memory_bytes, uint32_t jobs, JobMonitor& monitor,
                                    FileSystem& files = real_file_system());

}  // namespace promenade
