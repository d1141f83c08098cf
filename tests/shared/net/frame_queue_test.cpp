#include "shared/net/frame_queue.h"

#include <gtest/gtest.h>

namespace macula::net {
namespace {

ReceivedFrame frame(std::uint64_t id, bool is_key) {
  ReceivedFrame received;
  received.begin.frame = id;
  received.begin.is_key = is_key;
  return received;
}

TEST(FrameQueue, FramesThatLeanOnOthersComeInOrder) {
  FrameQueue queue;
  for (std::uint64_t id = 1; id <= 5; ++id) queue.put(frame(id, id == 1));
  for (std::uint64_t id = 1; id <= 5; ++id) EXPECT_EQ(queue.wait(Nanoseconds{0})->begin.frame, id);
  EXPECT_FALSE(queue.wait(Nanoseconds{0}));
}

TEST(FrameQueue, AKeyFrameReplacesWhatNobodyTook) {
  FrameQueue queue;
  for (std::uint64_t id = 1; id <= 3; ++id) queue.put(frame(id, true));
  EXPECT_EQ(queue.wait(Nanoseconds{0})->begin.frame, 3U);
  EXPECT_FALSE(queue.wait(Nanoseconds{0}));
}

TEST(FrameQueue, ADecoderTooFarBehindStartsAnewFromAKeyFrame) {
  FrameQueue queue;
  std::uint64_t id = 1;
  while (id <= FrameQueue::kMost) EXPECT_EQ(queue.put(frame(id++, false)), FrameQueue::Put::Kept);
  EXPECT_EQ(queue.put(frame(id++, false)), FrameQueue::Put::Overflowed);
  EXPECT_FALSE(queue.wait(Nanoseconds{0}));
  queue.put(frame(id, true));
  EXPECT_EQ(queue.wait(Nanoseconds{0})->begin.frame, id);
}

}  // namespace
}  // namespace macula::net
