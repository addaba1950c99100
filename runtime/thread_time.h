#pragma once
// Processor time of threads.

#include <thread>

namespace promenade {

/// Of the calling thread, milliseconds; 0 where the system does not tell.
double own_cpu_ms();
/// Of a thread that has not been joined. Any thread.
double cpu_ms_of(const std::thread& thread);
/// Of all threads of the process.
double process_cpu_ms();

}  // namespace promenade
