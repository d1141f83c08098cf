#include "shared/base/free_memory.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "shared/base/resident.h"

namespace macula::base {
namespace {

double resident_mb() {
  return static_cast<double>(resident_bytes()) / (1024.0 * 1024.0);
}

/// Blocks too small for a mapping of their own, below one that stays.
TEST(FreeMemory, GoesBackToTheSystemAlthoughSomethingAboveItStays) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers have an allocator of their own";
#endif
  const double before = resident_mb();
  std::vector<std::unique_ptr<char[]>> blocks;
  for (int i = 0; i < 2048; ++i) {
    blocks.push_back(std::make_unique<char[]>(32768));
    blocks.back()[0] = 1;
  }
  const auto stays = std::make_unique<char[]>(32768);
  blocks.clear();
  const double kept = resident_mb();
  return_free_memory();
  EXPECT_GT(kept, before + 40.0) << "what the test is about";
  EXPECT_LT(resident_mb(), before + 8.0);
}

}  // namespace
}  // namespace macula::base
