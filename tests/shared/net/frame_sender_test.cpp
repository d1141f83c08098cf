#include "shared/net/frame_sender.h"

#include "shared/net/wire.h"
#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

/// A sink that takes `room` messages, and what it took.
struct Wire {
  int room = 1'000'000;
  bool is_gone = false;
  std::vector<Message> envelopes;
  std::vector<std::size_t> sizes;

  SendOutcome take(const Outgoing& out) {
    if (is_gone) return SendOutcome::Unreachable;
    if (room == 0) return SendOutcome::Full;
    --room;
    const auto bytes = std::as_bytes(std::span(out.envelope.data(), out.envelope.size()));
    envelopes.push_back(*decode_envelope(bytes));
    if (out.payload) sizes.push_back(out.size);
    return SendOutcome::Sent;
  }
};

class Sending : public ::testing::Test {
 protected:
  FrameSender make(const ServerDelays& delays = {}) { return {PeerId{1}, delays, Limits{}}; }
  std::vector<FrameSent> progress(FrameSender& sender, std::chrono::milliseconds at) {
    std::vector<FrameSent> ended;
    sender.progress(
        {SteadyTime{at}, [at] { return ServerTime{at}; }},
        [this](const Outgoing& out) { return wire_.take(out); }, ended);
    return ended;
  }
  void add(FrameSender& sender, std::uint64_t frame, std::size_t bytes,
           std::chrono::milliseconds at = 0ms) {
    sender.add(make_frame(1, frame, bytes), ServerTime{at}, SteadyTime{at});
  }
  Wire wire_;
};

TEST_F(Sending, BeginSlicesEndInThatOrderAndNoPartAboveTheLimit) {
  FrameSender sender = make();
  add(sender, 1, 100'000);
  const auto ended = progress(sender, 3ms);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_FALSE(ended[0].lost);
  EXPECT_EQ(ended[0].begin, ServerTime{0ms});
  EXPECT_EQ(ended[0].end, ServerTime{3ms});
  EXPECT_EQ(wire_.sizes, (std::vector<std::size_t>{32768, 32768, 32768, 1696}));
  EXPECT_TRUE(std::holds_alternative<FrameBegin>(wire_.envelopes.front()));
  EXPECT_TRUE(std::holds_alternative<FrameEnd>(wire_.envelopes.back()));
  EXPECT_EQ(std::get<SliceHeader>(wire_.envelopes[2]).offset_bytes, 32768U);
}

TEST_F(Sending, AFullQueueKeepsTheRestForLater) {
  FrameSender sender = make();
  add(sender, 1, 100'000);
  wire_.room = 2;
  EXPECT_TRUE(progress(sender, 0ms).empty());
  EXPECT_TRUE(sender.is_blocked());
  wire_.room = 1;
  EXPECT_TRUE(progress(sender, 4000ms).empty());
  wire_.room = 10;
  EXPECT_EQ(progress(sender, 8000ms).size(), 1U);
  EXPECT_EQ(wire_.sizes, (std::vector<std::size_t>{32768, 32768, 32768, 1696}));
}

TEST_F(Sending, AFrameWithoutProgressIsLostAndTheNextGoesOn) {
  FrameSender sender = make();
  add(sender, 1, 100'000);
  wire_.room = 2;
  progress(sender, 0ms);
  EXPECT_TRUE(progress(sender, 5000ms).empty());
  const auto lost = progress(sender, 5001ms);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_TRUE(lost[0].lost);
  wire_.room = 10;
  add(sender, 2, 100, 5002ms);
  const auto sent = progress(sender, 5003ms);
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].frame, 2U);
  EXPECT_FALSE(sent[0].lost);
}

TEST_F(Sending, APeerThatIsGoneLosesEveryFrame) {
  FrameSender sender = make();
  add(sender, 1, 10);
  add(sender, 2, 10);
  wire_.is_gone = true;
  const auto ended = progress(sender, 1ms);
  ASSERT_EQ(ended.size(), 2U);
  EXPECT_TRUE(ended[0].lost && ended[1].lost);
}

TEST_F(Sending, TheSendQueueStageTravelsInTheNextFrame) {
  FrameSender sender = make();
  add(sender, 1, 10);
  progress(sender, 4ms);
  add(sender, 2, 10, 6ms);
  progress(sender, 7ms);
  const auto& begin = std::get<FrameBegin>(wire_.envelopes.at(3));
  EXPECT_EQ(begin.previous_frame, 1U);
  EXPECT_EQ(begin.previous_send_begin, ServerTime{0ms});
  EXPECT_EQ(begin.previous_send_end, ServerTime{4ms});
}

TEST_F(Sending, ASendQueueDelayLiesInsideTheStage) {
  FrameSender sender = make({30ms, 0ms});
  add(sender, 1, 10);
  EXPECT_TRUE(progress(sender, 29ms).empty());
  EXPECT_EQ(sender.deadline(), SteadyTime{30ms});
  const auto ended = progress(sender, 30ms);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].end - ended[0].begin, 30ms);
}

TEST_F(Sending, ADownlinkDelayComesAfterTheStage) {
  FrameSender sender = make({0ms, 30ms});
  add(sender, 1, 10);
  const auto ended = progress(sender, 0ms);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].end, ServerTime{0ms});
  EXPECT_TRUE(wire_.envelopes.empty());
  progress(sender, 29ms);
  EXPECT_TRUE(wire_.envelopes.empty());
  EXPECT_TRUE(progress(sender, 30ms).empty());
  EXPECT_EQ(wire_.envelopes.size(), 3U);
}

TEST_F(Sending, PartsGrowOnAFastLinkAndShrinkOnASlowOne) {
  FrameSender sender = make();
  add(sender, 1, 100'000);
  progress(sender, 0ms);
  sender.acknowledged({1, 1, 0, 0, false}, SteadyTime{10ms});  // 10 MB/s
  EXPECT_EQ(sender.part_bytes(), 65536U);
  add(sender, 2, 100'000, 20ms);
  progress(sender, 20ms);
  sender.acknowledged({1, 2, 0, 0, false}, SteadyTime{420ms});  // 0.25 MB/s
  EXPECT_EQ(sender.part_bytes(), 32768U);
}

TEST_F(Sending, NobodyMayAcknowledgeAFrameThatWasNeverHandedOver) {
  FrameSender sender = make();
  add(sender, 4, 10);
  EXPECT_TRUE(sender.may_acknowledge({1, 4, 0, 0, false}));
  EXPECT_FALSE(sender.may_acknowledge({1, 5, 0, 0, false}));
  EXPECT_FALSE(sender.may_acknowledge({1, 4, 5, 0, false}));
}

TEST_F(Sending, AGridThatRestsIsSentOnceAndAgainAfterALoss) {
  FrameSender sender = make();
  const auto grid_frame_of = [&](std::uint64_t frame) {
    add(sender, frame, 10);
    progress(sender, 0ms);
    const auto& begin = std::get<FrameBegin>(wire_.envelopes[wire_.envelopes.size() - 3]);
    EXPECT_EQ(begin.frame, frame);
    EXPECT_EQ(begin.views[0].grid.x_edges.empty(), begin.views[0].grid_frame != 0);
    return begin.views[0].grid_frame;
  };
  EXPECT_EQ(grid_frame_of(1), 0U);
  EXPECT_EQ(grid_frame_of(2), 1U);
  EXPECT_EQ(grid_frame_of(3), 1U);
  Acks acks;
  acks.epoch = 1;
  acks.received = 3;
  acks.need_key = true;
  sender.acknowledged(acks, SteadyTime{1ms});
  EXPECT_EQ(grid_frame_of(4), 0U);
  EXPECT_EQ(grid_frame_of(5), 4U);
}

}  // namespace
}  // namespace macula::net
