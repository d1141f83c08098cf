#include "shared/net/frame_assembler.h"

#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

using Step = FrameAssembler::Step;

constexpr std::uint32_t kEpoch = 5;

/// An assembler in the middle of nothing, and frames of two slices of 100 and 50 bytes.
class Assembly : public ::testing::Test {
 protected:
  Assembly() { assembler_.start_epoch(kEpoch); }

  static FrameBegin directory(std::uint64_t frame) {
    FrameBegin begin = make_frame(kEpoch, frame, 100).begin;
    begin.slices.push_back(begin.slices[0]);
    begin.slices[1].size_bytes = 50;
    return begin;
  }
  Step begin(std::uint64_t frame) { return assembler_.begin(directory(frame), ClientTime{1ms}); }
  Step slice(std::uint64_t frame, std::uint32_t slice, std::uint32_t offset, std::size_t size,
             std::byte value = std::byte{1}) {
    return assembler_.slice({kEpoch, frame, slice, offset}, std::vector<std::byte>(size, value));
  }
  Step end(std::uint64_t frame) { return assembler_.end({kEpoch, frame}, ClientTime{2ms}); }
  void expect_discarded(std::uint64_t frame) {
    EXPECT_EQ(assembler_.acks().received, frame);
    EXPECT_FALSE(assembler_.is_receiving());
    EXPECT_FALSE(assembler_.take());
    EXPECT_EQ(assembler_.incomplete(), 1U);
  }

  FrameAssembler assembler_{Limits{}};
};

TEST_F(Assembly, AFrameIsWhatItsSlicesSay) {
  EXPECT_EQ(begin(1), Step::Advanced);
  EXPECT_EQ(slice(1, 0, 0, 60), Step::Advanced);
  EXPECT_EQ(assembler_.acks().receiving, 1U);
  EXPECT_EQ(assembler_.acks().receiving_bytes, 60U);
  EXPECT_EQ(assembler_.acks().received, 0U);
  EXPECT_EQ(slice(1, 0, 60, 40, std::byte{2}), Step::Advanced);
  EXPECT_EQ(slice(1, 1, 0, 50), Step::Advanced);
  EXPECT_EQ(end(1), Step::Completed);
  EXPECT_EQ(assembler_.acks().received, 1U);
  EXPECT_EQ(assembler_.acks().receiving, 0U);
  const auto frame = assembler_.take();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->payloads[0].size(), 100U);
  EXPECT_EQ(frame->payloads[0][59], std::byte{1});
  EXPECT_EQ(frame->payloads[0][60], std::byte{2});
  EXPECT_EQ(frame->first_byte, ClientTime{1ms});
  EXPECT_EQ(frame->last_byte, ClientTime{2ms});
  EXPECT_FALSE(assembler_.take());
}

TEST_F(Assembly, ASliceOutOfOrderDiscardsTheFrame) {
  begin(1);
  EXPECT_EQ(slice(1, 1, 0, 50), Step::Discarded);
  expect_discarded(1);
  EXPECT_EQ(slice(1, 0, 0, 100), Step::Ignored);
  EXPECT_EQ(end(1), Step::Ignored);
}

TEST_F(Assembly, ADuplicateSliceDiscardsTheFrame) {
  begin(1);
  slice(1, 0, 0, 60);
  EXPECT_EQ(slice(1, 0, 0, 60), Step::Discarded);
  expect_discarded(1);
}

TEST_F(Assembly, AnOverlapOrAGapDiscardsTheFrame) {
  begin(1);
  slice(1, 0, 0, 60);
  EXPECT_EQ(slice(1, 0, 59, 41), Step::Discarded);
  begin(2);
  slice(2, 0, 0, 60);
  EXPECT_EQ(slice(2, 0, 61, 39), Step::Discarded);
  EXPECT_EQ(assembler_.acks().received, 2U);
}

TEST_F(Assembly, MoreBytesThanTheDirectorySaysDiscardTheFrame) {
  begin(1);
  EXPECT_EQ(slice(1, 0, 0, 101), Step::Discarded);
  begin(2);
  slice(2, 0, 0, 100);
  slice(2, 1, 0, 50);
  EXPECT_EQ(slice(2, 2, 0, 1), Step::Discarded);
}

TEST_F(Assembly, AnEmptySliceDiscardsTheFrame) {
  begin(1);
  EXPECT_EQ(slice(1, 0, 0, 0), Step::Discarded);
  expect_discarded(1);
}

TEST_F(Assembly, AnEndBeforeAllSlicesDiscardsTheFrame) {
  begin(1);
  slice(1, 0, 0, 100);
  EXPECT_EQ(end(1), Step::Discarded);
  expect_discarded(1);
}

TEST_F(Assembly, ANewFrameDiscardsTheUnfinishedOneAndAcknowledgesIt) {
  begin(1);
  slice(1, 0, 0, 100);
  EXPECT_EQ(begin(2), Step::Discarded);
  EXPECT_EQ(assembler_.acks().received, 1U);
  EXPECT_EQ(assembler_.acks().receiving, 2U);
  slice(2, 0, 0, 100);
  slice(2, 1, 0, 50);
  EXPECT_EQ(end(2), Step::Completed);
  EXPECT_EQ(assembler_.incomplete(), 1U);
}

// A FrameBegin that fails its checks never reaches the assembler; its slices tell that it existed,
// and without an acknowledgement its credit would be gone.
TEST_F(Assembly, AFrameWhoseBeginWasRefusedIsAcknowledgedByItsSlices) {
  EXPECT_EQ(slice(3, 0, 0, 100), Step::Discarded);
  expect_discarded(3);
  EXPECT_EQ(slice(3, 1, 0, 50), Step::Ignored);
  EXPECT_EQ(end(3), Step::Ignored);
  EXPECT_EQ(begin(4), Step::Advanced);
}

TEST_F(Assembly, AFrameGivenUpIsAcknowledged) {
  EXPECT_EQ(assembler_.give_up(), Step::Ignored);
  begin(1);
  slice(1, 0, 0, 60);
  EXPECT_EQ(assembler_.give_up(), Step::Discarded);
  expect_discarded(1);
}

TEST_F(Assembly, OldFramesAndOtherEpochsAreIgnored) {
  begin(2);
  slice(2, 0, 0, 100);
  slice(2, 1, 0, 50);
  end(2);
  EXPECT_EQ(begin(2), Step::Ignored);
  EXPECT_EQ(begin(1), Step::Ignored);
  FrameBegin foreign = directory(9);
  foreign.epoch = kEpoch + 1;
  EXPECT_EQ(assembler_.begin(foreign, {}), Step::Ignored);
  EXPECT_EQ(assembler_.slice({kEpoch + 1, 9, 0, 0}, std::vector<std::byte>(9)), Step::Ignored);
  EXPECT_EQ(assembler_.acks().received, 2U);
}

TEST_F(Assembly, ANewEpochStartsFromNothing) {
  begin(7);
  assembler_.start_epoch(kEpoch + 1);
  EXPECT_EQ(assembler_.acks().epoch, kEpoch + 1);
  EXPECT_EQ(assembler_.acks().received, 0U);
  EXPECT_EQ(assembler_.incomplete(), 0U);
  EXPECT_FALSE(assembler_.is_receiving());
}

// Announced sizes alone take no memory: 64 MiB promised, nothing held.
TEST_F(Assembly, MemoryFollowsTheBytesThatCame) {
  FrameBegin huge = directory(1);
  huge.slices[0].size_bytes = 60U << 20;
  huge.slices[1].size_bytes = 1;
  ASSERT_EQ(assembler_.begin(huge, {}), Step::Advanced);
  ASSERT_EQ(slice(1, 0, 0, 1000), Step::Advanced);
  EXPECT_EQ(assembler_.acks().receiving_bytes, 1000U);
}

TEST_F(Assembly, AGridLeftOutIsTheOneThatCameBefore) {
  const auto whole = [&](std::uint64_t frame, std::uint64_t grid_frame) {
    FrameBegin leaving_out = directory(frame);
    const PixelGrid grid = leaving_out.views[0].grid;
    leaving_out.views[0].grid_frame = grid_frame;
    if (grid_frame != 0) leaving_out.views[0].grid = {};
    if (assembler_.begin(leaving_out, ClientTime{1ms}) != Step::Advanced) return false;
    slice(frame, 0, 0, 100);
    slice(frame, 1, 0, 50);
    end(frame);
    const auto taken = assembler_.take();
    return taken && taken->begin.views[0].grid == grid && taken->begin.views[0].grid_frame == 0;
  };
  EXPECT_TRUE(whole(1, 0));
  EXPECT_TRUE(whole(2, 1));
  EXPECT_FALSE(assembler_.acks().need_key);
  EXPECT_FALSE(whole(3, 2)) << "frame 2 brought none";
  EXPECT_TRUE(assembler_.acks().need_key);
  EXPECT_EQ(assembler_.acks().received, 3U);
}

TEST_F(Assembly, AKeyIsNeededFromALossUntilAKeyFrameIsWhole) {
  const auto whole = [&](std::uint64_t frame, bool is_key) {
    FrameBegin begin = directory(frame);
    begin.is_key = is_key;
    assembler_.begin(begin, ClientTime{1ms});
    slice(frame, 0, 0, 100);
    slice(frame, 1, 0, 50);
    end(frame);
  };
  whole(1, true);
  EXPECT_FALSE(assembler_.acks().need_key);
  begin(2);
  assembler_.give_up();
  EXPECT_TRUE(assembler_.acks().need_key);
  whole(3, false);
  EXPECT_TRUE(assembler_.acks().need_key);
  whole(4, true);
  EXPECT_FALSE(assembler_.acks().need_key);
}

}  // namespace
}  // namespace macula::net
