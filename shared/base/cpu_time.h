// CPU time of the calling thread: what work cost, however busy the machine was meanwhile.
#pragma once

#include <time.h>

#include <chrono>

namespace macula::base {

inline std::chrono::nanoseconds thread_cpu_time() {
  timespec used{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return std::chrono::seconds{used.tv_sec} + std::chrono::nanoseconds{used.tv_nsec};
}
/// The same in milliseconds, for sums over many stages.
inline double thread_cpu_ms() {
  return std::chrono::duration<double, std::milli>(thread_cpu_time()).count();
}

}  // namespace macula::base
