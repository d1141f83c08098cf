#include "shared/base/result.h"

#include <gtest/gtest.h>

#include "shared/base/check.h"
#include "shared/base/clock.h"
#include "shared/base/text.h"

namespace macula::base {
namespace {

Result<int> parse(int value) {
  if (value < 0) return bad_input("-1 is negative", "row 3", "0 or more");
  return value;
}

TEST(Error, MessageNamesPlaceFaultAndRemedyOnOneLine) {
  const Result<int> failed = parse(-1);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message(), "row 3: -1 is negative (0 or more)");
}

TEST(Error, BadInputExitsWithTwoAndEverythingElseWithOne) {
  EXPECT_EQ(parse(-1).error().exit_status(), 2);
  const Result<int> broken = runtime_error("the disk is full");
  EXPECT_EQ(broken.error().exit_status(), 1);
  EXPECT_EQ(broken.error().message(), "the disk is full");
}

TEST(Check, AbortsAndPrintsTheConditionThatFailed) {
  EXPECT_DEATH(MACULA_CHECK(1 + 1 == 3, "arithmetic"), "1 \\+ 1 == 3 .*arithmetic");
}

TEST(Clock, ManualClockMovesOnlyWhenTold) {
  ManualClock clock;
  const auto before = clock.now();
  EXPECT_EQ(clock.now(), before);
  clock.advance(std::chrono::milliseconds{5});
  EXPECT_EQ(clock.now() - before, std::chrono::milliseconds{5});
}

TEST(Text, ConcatJoinsPartsOfAnyPrintableType) {
  EXPECT_EQ(concat("frame ", 3, " took ", 2.5, " ms"), "frame 3 took 2.5 ms");
}

}  // namespace
}  // namespace macula::base
