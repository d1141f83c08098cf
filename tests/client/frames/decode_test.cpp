#include "client/frames/decode.h"

#include <gtest/gtest.h>

#include "tests/client/frames/encoded_frames.h"

namespace macula::frames {
namespace {

/// One frame by a decoder of its own.
Result<DecodedFrame> decode(net::ReceivedFrame received, const base::Clock& clock) {
  return FrameDecoder(clock).decode(std::move(received));
}

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

TEST(Decode, GivesBackWhatTheFirstLayerHides) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, 1);
  test::add_hidden_layer(received, 1);
  const auto frame = decode(received, clock);
  ASSERT_TRUE(frame) << frame.error().message();
  EXPECT_FALSE(frame->eyes[0].hidden);
  ASSERT_TRUE(frame->eyes[1].hidden);
  const codec::HiddenLayerPlanes& hidden = *frame->eyes[1].hidden;
  const codec::Mask band = test::known_band();
  for (int y = 0; y < test::kFrameHeight; ++y) {
    for (int x = 0; x < test::kFrameWidth; ++x) {
      ASSERT_EQ(hidden.mask(x, y), band(x, y));
      if (band(x, y) == 0) continue;
      EXPECT_EQ(hidden.color(x, y), (Rgb8{90, 90, 90}));
      EXPECT_NEAR(hidden.inverse_depth_per_m(x, y), 0.25F, 1e-4F);
    }
  }
  EXPECT_EQ(frame->eyes[1].color(5, 5), (Rgb8{5, 5, 1})) << "the first layer is as it was";
}

TEST(Decode, RefusesASecondLayerInAnotherOrderOrOfAnotherSize) {
  const base::ManualClock clock;
  const auto refuses = [&](auto spoil) {
    auto received = test::make_received_frame(1, 1, 1);
    test::add_hidden_layer(received, 0);
    spoil(received);
    return !decode(received, clock);
  };
  EXPECT_FALSE(refuses([](auto&) {}));
  EXPECT_TRUE(refuses([](auto& frame) {
    std::swap(frame.begin.slices[3], frame.begin.slices[4]);  // colour before its mask
    std::swap(frame.payloads[3], frame.payloads[4]);
  }));
  EXPECT_TRUE(refuses([](auto& frame) { frame.begin.slices[4].rect.width -= 1; }));
  EXPECT_TRUE(refuses([](auto& frame) { frame.begin.slices[3].rect.height -= 1; }));
  EXPECT_TRUE(refuses([](auto& frame) { frame.begin.slices[4].codec = net::SliceCodec::H264; }));
  EXPECT_TRUE(refuses([](auto& frame) { frame.payloads[3].resize(5); }));
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

/// Frames of one eye whose colour is H.264, each leaning on the one before.
class H264Frames : public testing::Test {
 protected:
  void SetUp() override {
    if (!codec::can_encode_h264() || !codec::can_decode_h264())
      GTEST_SKIP() << "this build has no H.264";
    encoder_ = std::move(*codec::H264Encoder::create({}));
  }
  net::ReceivedFrame next(codec::H264Encoder::Kind kind = codec::H264Encoder::Kind::Delta) {
    net::ReceivedFrame frame = test::make_received_frame(1, ++frame_, 1);
    const auto depth = frame.begin.slices[2];
    const auto depth_bytes = frame.payloads[2];
    frame.begin.slices.clear();
    frame.payloads.clear();
    const auto coded = encoder_->encode(test::known_color(0), {.kind = kind});
    frame.begin.is_key = coded->kind == codec::H264Encoder::Kind::Key;
    frame.begin.reference_frame = frame.begin.is_key ? 0 : frame_ - 1;
    const image::Rect whole{0, 0, test::kFrameWidth, test::kFrameHeight};
    test::add_slice(frame, {0, 0, net::PlaneKind::Color, net::SliceCodec::H264, whole, 0},
                    coded->bytes);
    test::add_slice(frame, depth, depth_bytes);
    return frame;
  }

  const base::ManualClock clock_;
  FrameDecoder decoder_{clock_};
  std::unique_ptr<codec::H264Encoder> encoder_;
  std::uint64_t frame_ = 0;
};

TEST_F(H264Frames, AreDecodedInOrder) {
  for (int i = 0; i < 5; ++i) {
    const auto frame = decoder_.decode(next());
    ASSERT_TRUE(frame) << frame.error().message();
    EXPECT_NEAR(frame->eyes[0].color(20, 12).r, 20, 12);
  }
}

TEST_F(H264Frames, WhatLeansOnAMissingFrameIsNeverShown) {
  ASSERT_TRUE(decoder_.decode(next()));
  next();  // lost on the way
  for (int i = 0; i < 3; ++i) {
    const auto frame = decoder_.decode(next());
    ASSERT_FALSE(frame);
    EXPECT_NE(frame.error().message().find("which was not decoded"), std::string::npos);
  }
  EXPECT_TRUE(decoder_.decode(next(codec::H264Encoder::Kind::Key)));
  EXPECT_TRUE(decoder_.decode(next()));
}

TEST_F(H264Frames, ADamagedFrameEndsTheChain) {
  ASSERT_TRUE(decoder_.decode(next()));
  auto damaged = next();
  damaged.payloads[1].resize(3);  // its depth
  EXPECT_FALSE(decoder_.decode(std::move(damaged)));
  EXPECT_FALSE(decoder_.decode(next()));
}

}  // namespace
}  // namespace macula::frames
