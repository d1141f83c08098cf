// CPU time of the whole process and wall time since the last lap. One thread.
#pragma once

#include <chrono>
#include <ctime>

namespace macula::bench {

struct Lap {
  double cpu_ms = 0.0, wall_ms = 0.0;
};

class Stopwatch {
 public:
  Lap lap() {
    const Lap now = read();
    const Lap spent{now.cpu_ms - begin_.cpu_ms, now.wall_ms - begin_.wall_ms};
    begin_ = now;
    return spent;
  }

 private:
  static Lap read() {
    timespec cpu{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    return {1e3 * static_cast<double>(cpu.tv_sec) + 1e-6 * static_cast<double>(cpu.tv_nsec),
            std::chrono::duration<double, std::milli>(wall).count()};
  }
  Lap begin_ = read();
};

}  // namespace macula::bench
