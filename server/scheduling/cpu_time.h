// Processor time of the calling thread: what a stage costs, however busy the machine is.
#pragma once

#include <ctime>

namespace macula::scheduling {

inline double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace macula::scheduling
