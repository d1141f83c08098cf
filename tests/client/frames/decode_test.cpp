#include "client/frames/decode.h"

#include <gtest/gtest.h>

#include "tests/client/frames/encoded_frames.h"

namespace macula::frames {
namespace {

TEST(Decode, GivesBackBothEyesColourAndDepth) {
  base::ManualClock clock;
  clock.advance(units::from_ms(7.0));
  auto received = test::make_received_frame(3, 9);
  received.first_byte = ClientTime{units::from_ms(1.0)};
  received.last_byte = ClientTime{units::from_ms(2.0)};
  const auto frame = decode(received, clock);
  ASSERT_TRUE(frame) << frame.error().message();
  ASSERT_EQ(frame->eyes.size(), 2U);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto expected = test::known_color(eye);
    EXPECT_TRUE(std::equal(expected.pixels().begin(), expected.pixels().end(),
                           frame->eyes[eye].color.pixels().begin()));
    EXPECT_EQ(frame->eyes[eye].inverse_depth_per_m(5, 0), 0.0F);
    EXPECT_NEAR(frame->eyes[eye].inverse_depth_per_m(5, 5), 0.5F, 1e-4F);
  }
  EXPECT_EQ(frame->id(), (FrameId{3, 9}));
  EXPECT_EQ(frame->decoded, ClientTime{units::from_ms(7.0)});
  EXPECT_EQ(frame->last_byte, ClientTime{units::from_ms(2.0)});
}

TEST(Decode, CountsThePayloadBytes) {
  const base::ManualClock clock;
  const auto received = test::make_received_frame(1, 1, 1);
  std::uint64_t bytes = 0;
  for (const auto& payload : received.payloads) bytes += payload.size();
  EXPECT_EQ(decode(received, clock)->bytes, bytes);
}

TEST(Decode, NamesTheSliceThatIsBroken) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 12);
  received.payloads[4].resize(3);
  const auto frame = decode(received, clock);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().where, "frame 12, slice 4");
}

TEST(Decode, RefusesARectangleOutsideTheGrid) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 1);
  received.begin.slices[0].rect.x = 1;
  const auto frame = decode(received, clock);
  ASSERT_FALSE(frame);
  EXPECT_NE(frame.error().message().find("its rectangle leaves the grid"), std::string::npos);
}

TEST(Decode, RefusesAnEyeWhoseColourIsIncomplete) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 4, 1);
  received.begin.slices.erase(received.begin.slices.begin());
  received.payloads.erase(received.payloads.begin());
  const auto frame = decode(received, clock);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().message(),
            "frame 4: colour covers 192 of 384 cells of eye 0 (every cell of the grid)");
}

TEST(Decode, RefusesPayloadsThatDoNotFitTheDirectory) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 1);
  received.payloads.pop_back();
  ASSERT_FALSE(decode(received, clock));
}

TEST(Decode, TakesMissingDepthAsInfinitelyFar) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 1, 1);
  received.begin.slices.pop_back();
  received.payloads.pop_back();
  const auto frame = decode(received, clock);
  ASSERT_TRUE(frame) << frame.error().message();
  for (const float d : frame->eyes[0].inverse_depth_per_m.pixels()) EXPECT_EQ(d, 0.0F);
}

}  // namespace
}  // namespace macula::frames
