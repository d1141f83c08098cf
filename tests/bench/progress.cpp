#include "tests/bench/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace macula::bench {

std::string progress_line(const std::string& label, std::int64_t done, std::int64_t total,
                          int width) {
  const double share =
      total <= 0 ? 1.0
                 : std::clamp(static_cast<double>(done) / static_cast<double>(total), 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(share * width);
  char percent[16];
  std::snprintf(percent, sizeof percent, "%3d %%", static_cast<int>(share * 100.0));
  return label + " [" + std::string(filled, '#') +
         std::string(static_cast<std::size_t>(width) - filled, '.') + "] " + percent;
}

Progress::Progress(std::string label, std::int64_t total)
    : label_(std::move(label)), total_(total), visible_(isatty(STDERR_FILENO) == 1) {
  draw();
}

Progress::~Progress() {
  if (visible_) std::fputs("\r\x1b[K", stderr);
}

void Progress::advance(std::int64_t steps) {
  done_ += steps;
  draw();
}

void Progress::draw() {
  if (!visible_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_draw_) return;
  next_draw_ = now + std::chrono::milliseconds{100};
  std::fprintf(stderr, "\r%s", progress_line(label_, done_, total_).c_str());
  std::fflush(stderr);
}

}  // namespace macula::bench
