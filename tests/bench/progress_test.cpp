#include "tests/bench/progress.h"

#include <gtest/gtest.h>

namespace macula::bench {
namespace {

TEST(Progress, DrawsTheShareDone) {
  EXPECT_EQ(progress_line("rows", 0, 4, 8), "rows [........]   0 %");
  EXPECT_EQ(progress_line("rows", 1, 4, 8), "rows [##......]  25 %");
  EXPECT_EQ(progress_line("rows", 4, 4, 8), "rows [########] 100 %");
}

TEST(Progress, StaysInsideItsBrackets) {
  EXPECT_EQ(progress_line("rows", 9, 4, 8), "rows [########] 100 %");
  EXPECT_EQ(progress_line("rows", -1, 4, 8), "rows [........]   0 %");
  EXPECT_EQ(progress_line("rows", 0, 0, 8), "rows [########] 100 %") << "nothing to do is done";
}

TEST(Progress, IsSilentWhereNobodyWatches) {
  testing::internal::CaptureStderr();  // a file, not a terminal
  {
    Progress progress("rows", 2);
    progress.advance();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace macula::bench
