#pragma once
// What this process takes.

#include <cstdint>

namespace promenade {

/// Most memory that the process held so far, bytes; 0 where the system does not tell. Any thread.
uint64_t peak_rss_bytes();

}  // namespace promenade
