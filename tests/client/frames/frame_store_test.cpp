#include "client/frames/frame_store.h"

#include <gtest/gtest.h>
#include <thread>

namespace macula::frames {
namespace {

FramePtr frame(std::uint32_t epoch, std::uint64_t number) {
  auto made = std::make_shared<DecodedFrame>();
  made->begin.epoch = epoch;
  made->begin.frame = number;
  return made;
}

TEST(FrameOrder, CountsUpWithinAnEpoch) {
  FrameOrder order;
  EXPECT_TRUE(order.advance({7, 3}));
  EXPECT_FALSE(order.advance({7, 3}));
  EXPECT_FALSE(order.advance({7, 2}));
  EXPECT_TRUE(order.advance({7, 10}));
}

TEST(FrameOrder, TakesANewEpochWhateverItsNumberAndNeverTheOldOneAgain) {
  FrameOrder order;
  EXPECT_TRUE(order.advance({7, 30}));
  EXPECT_TRUE(order.advance({2, 1}));
  EXPECT_FALSE(order.advance({7, 31}));
  EXPECT_TRUE(order.advance({9, 1}));
  EXPECT_FALSE(order.advance({2, 5}));
  EXPECT_EQ(order.newest(), (FrameId{9, 1}));
}

TEST(FrameStore, KeepsTheNewestAndTheOneBefore) {
  FrameStore store;
  EXPECT_EQ(store.newest(), nullptr);
  EXPECT_EQ(store.put(frame(1, 1)), FrameStore::Admission::Newest);
  EXPECT_EQ(store.previous(), nullptr);
  EXPECT_EQ(store.put(frame(1, 4)), FrameStore::Admission::Newest);
  EXPECT_EQ(store.newest()->id(), (FrameId{1, 4}));
  EXPECT_EQ(store.previous()->id(), (FrameId{1, 1}));
}

TEST(FrameStore, NeverGoesBack) {
  FrameStore store;
  store.put(frame(1, 4));
  EXPECT_EQ(store.put(frame(1, 3)), FrameStore::Admission::Refused);
  EXPECT_EQ(store.newest()->id(), (FrameId{1, 4}));
}

TEST(FrameStore, KeepsItsPictureAcrossAChangeOfEpoch) {
  FrameStore store;
  store.put(frame(9, 100));
  EXPECT_EQ(store.put(frame(4, 1)), FrameStore::Admission::Newest);
  EXPECT_EQ(store.previous()->id(), (FrameId{9, 100}));
  EXPECT_EQ(store.put(frame(9, 101)), FrameStore::Admission::Refused);
}

TEST(FrameStore, WaitsForAFrameThatWasNotSeen) {
  FrameStore store;
  store.put(frame(1, 1));
  EXPECT_EQ(store.wait_newer(FrameId{1, 1}, units::from_ms(1.0)), nullptr);
  std::jthread later([&store] { store.put(frame(1, 2)); });
  const FramePtr seen = store.wait_newer(FrameId{1, 1}, units::from_s(30.0));
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(seen->id(), (FrameId{1, 2}));
}

TEST(FrameStore, WakesWaitersWhenClosed) {
  FrameStore store;
  std::jthread later([&store] { store.close(); });
  EXPECT_EQ(store.wait_newer(std::nullopt, units::from_s(3600.0)), nullptr);
}

// Two producers race with rising frames; a reader must never see the number fall.
TEST(FrameStore, NeverGoesBackUnderRacingProducers) {
  FrameStore store;
  const auto produce = [&store] {
    for (std::uint64_t n = 1; n <= 2000; ++n) store.put(frame(1, n));
  };
  std::jthread a(produce), b(produce);
  std::uint64_t last = 0;
  while (last < 2000) {
    const FramePtr newest = store.newest();
    if (!newest) continue;
    ASSERT_GE(newest->begin.frame, last);
    last = newest->begin.frame;
  }
}

}  // namespace
}  // namespace macula::frames
