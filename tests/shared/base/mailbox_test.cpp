#include "shared/base/mailbox.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace macula::base {
namespace {

using namespace std::chrono_literals;

TEST(Mailbox, HandsOutOnlyTheNewestValueAndThatOnce) {
  Mailbox<int> box;
  box.put(1);
  box.put(2);
  EXPECT_EQ(box.take(), 2);
  EXPECT_EQ(box.take(), std::nullopt);
}

TEST(Mailbox, WaitReturnsEmptyAfterTheTimeoutAndAfterClose) {
  Mailbox<int> box;
  EXPECT_EQ(box.wait(1ms), std::nullopt);
  box.close();
  EXPECT_EQ(box.wait(10s), std::nullopt);
}

TEST(Mailbox, WakesAWaitingThread) {
  Mailbox<int> box;
  std::jthread producer([&] { box.put(7); });
  EXPECT_EQ(box.wait(10s), 7);
}

TEST(Channel, KeepsOrderAndRefusesWhatExceedsItsCapacity) {
  Channel<int> channel(2);
  EXPECT_TRUE(channel.put(1));
  EXPECT_TRUE(channel.put(2));
  EXPECT_FALSE(channel.put(3));
  EXPECT_EQ(channel.take(), 1);
  EXPECT_EQ(channel.take(), 2);
  EXPECT_EQ(channel.take(), std::nullopt);
}

TEST(Channel, DrainsAfterCloseAndTakesNothingNew) {
  Channel<int> channel(4);
  ASSERT_TRUE(channel.put(1));
  channel.close();
  EXPECT_FALSE(channel.put(2));
  EXPECT_EQ(channel.wait(10s), 1);
  EXPECT_EQ(channel.wait(10s), std::nullopt);
}

}  // namespace
}  // namespace macula::base
