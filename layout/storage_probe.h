#pragma once
// A profile of the storage that a folder is on, measured.

#include <filesystem>

#include "geometry/job_monitor.h"
#include "geometry/result.h"
#include "layout/read_cost.h"

namespace promenade {

struct ProbeOptions {
  uint64_t file_bytes = uint64_t(256) << 20;  ///< of the file that is read in; more: farther seeks, less cache
  uint32_t small_reads = 256;                 ///< of one block each, at random places
  uint32_t large_reads = 32;                  ///< of large_bytes each, at random places
  uint32_t large_bytes = 4 << 20;
};

/// Writes a file without a name into the folder, syncs it, and reads in it at random places past the system's cache:
/// with O_DIRECT, or, where the file system refuses that, after posix_fadvise has dropped the file's pages. Seek and
/// bandwidth are those of the line through the medians of small and large reads; the block is the file system's. What
/// caches below the system (a disk's own, a virtual machine's host's) it cannot drop: their speed is part of what is
/// measured. Takes the file's size in that folder and some seconds. The name is "measured". Errors: the folder's, the
/// disk's; a cancelled monitor.
Result<StorageProfile> measure_storage(const std::filesystem::path& folder, const ProbeOptions& options,
                                       JobMonitor& monitor);

/// The line through two points: what a read of `small_bytes` and one of `large_bytes` take, in seconds. Pure.
StorageProfile profile_of_reads(uint32_t small_bytes, double small_s, uint32_t large_bytes, double large_s);

}  // namespace promenade
