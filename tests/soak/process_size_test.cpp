#include "tests/soak/process_size.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace macula::soak {
namespace {

/// 10 MB and 3 MB an hour more, every two minutes for an hour; at every fifth moment something else
/// is held, too.
TEST(ProcessSize, TheSlopeOfALeakIsFoundUnderNoise) {
  std::vector<ProcessSize> sizes;
  for (int i = 0; i < 30; ++i) {
    const double at_s = 120.0 * i;
    sizes.push_back({at_s, 10.0 + 3.0 * at_s / 3600.0 + (i % 5 == 4 ? 36.0 : 0.0), 0, 0});
  }
  EXPECT_NEAR(resident_slope_mb_per_h(sizes), 3.0, 1e-3);
}

TEST(ProcessSize, SeesADescriptorAndAMegabyte) {
  const ProcessSize before = size_of(::getpid(), 0.0);
  const int file = ::open("/dev/null", O_RDONLY);
  std::vector<char> memory(64U << 20, 1);
  const ProcessSize after = size_of(::getpid(), 1.0);
  ::close(file);
  EXPECT_EQ(after.descriptors, before.descriptors + 1);
  EXPECT_GE(after.threads, 1);
  EXPECT_GT(after.resident_mb, before.resident_mb + 60.0 * memory[1]);
}

}  // namespace
}  // namespace macula::soak
