// A progress bar on stderr for long work, drawn only where a person is watching (a terminal) and at
// most ten times a second. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace macula::bench {

/// "label [#####.....]  50 %": `done` of `total`, clamped; `width` characters inside the brackets.
std::string progress_line(const std::string& label, std::int64_t done, std::int64_t total,
                          int width = 40);

class Progress {
 public:
  Progress(std::string label, std::int64_t total);
  /// Leaves the line empty again.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::int64_t steps = 1);

 private:
  void draw();

  std::string label_;
  std::int64_t total_;
  std::int64_t done_ = 0;
  bool visible_;
  std::chrono::steady_clock::time_point next_draw_{};
};

}  // namespace macula::bench
