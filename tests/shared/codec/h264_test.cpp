// H.264 both ways: colours are right, bytes follow the wish, and damage is an error.
#include "shared/codec/h264.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/codec/h264_canvas.h"
#include "shared/codec/quantiser_offsets.h"
#include "shared/codec/yuv_simd.h"
#include "tests/shared/codec/damage.h"

namespace macula::codec {
namespace {

using namespace std::chrono_literals;
using image::Plane;
using Kind = H264Encoder::Kind;
using Wish = H264Encoder::FrameWish;

/// A texture with detail at every scale that moves by `shift` pixels.
Plane<Rgb8> textured(int width, int height, int shift) {
  const auto level = [](double phase) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(128.0 + phase, 0.0, 255.0)));
  };
  Plane<Rgb8> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = x + shift, v = y;
      double value = 0.0;
      const auto grain = static_cast<std::uint32_t>((x + shift) * 7919 + y * 104729) * 2654435761U;
      value += static_cast<double>(grain >> 27) - 16.0;
      for (int octave = 0; octave < 5; ++octave) {
        const double f = 0.02 * (1 << octave);
        value +=
            50.0 / (1 << octave) * std::sin(f * u + 0.3 * octave) * std::sin(f * v * 1.1 + octave);
      }
      picture(x, y) = {level(1.1 * value), level(value), level(0.8 * value + 20.0)};
    }
  }
  return picture;
}

double psnr_db(const Plane<Rgb8>& a, const Plane<Rgb8>& b, const image::Rect& rect) {
  double squares = 0.0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const Rgb8 p = a(x, y), q = b(x, y);
      squares += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
    }
  }
  return -10.0 * std::log10(squares / (3.0 * rect.width * rect.height * 255.0 * 255.0));
}

std::unique_ptr<H264Encoder> make_encoder(const H264Options& options = {}) {
  auto encoder = H264Encoder::create(options);
  return encoder ? std::move(*encoder) : nullptr;
}
std::unique_ptr<H264Decoder> make_decoder() {
  auto decoder = H264Decoder::create();
  return decoder ? std::move(*decoder) : nullptr;
}

class H264 : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_encode_h264() || !can_decode_h264()) GTEST_SKIP() << "this build has no H.264";
    encoder_ = make_encoder();
    decoder_ = make_decoder();
  }
  H264Encoder::Coded encode(const Plane<Rgb8>& picture, const Wish& wish = {}) {
    auto coded = encoder_->encode(picture, wish);
    EXPECT_TRUE(coded) << coded.error().message();
    return coded ? std::move(*coded) : H264Encoder::Coded{};
  }
  Plane<Rgb8> decode(const Bytes& bytes, int width, int height) {
    Plane<Rgb8> picture(width, height);
    const auto done = decoder_->decode(bytes, picture.rect(), picture);
    EXPECT_TRUE(done) << done.error().message();
    return picture;
  }
  std::unique_ptr<H264Encoder> encoder_;
  std::unique_ptr<H264Decoder> decoder_;
};

// Y = .2126 R + .7152 G + .0722 B, Cb = (B - Y) / 1.8556 + 128, Cr = (R - Y) / 1.5748 + 128.
TEST(Yuv, IsBt709AtFullRangeWithinALevel) {
  std::vector<Rgb8> upper, lower;
  for (int i = 0; i < 64; ++i) {
    const auto channel = [&](int step) { return static_cast<std::uint8_t>(i * step % 256); };
    const Rgb8 pixel = i == 0   ? Rgb8{0, 0, 255}
                       : i == 2 ? Rgb8{255, 0, 0}
                       : i == 4 ? Rgb8{255, 255, 255}
                                : Rgb8{channel(37), channel(91), channel(53)};
    const Rgb8 doubled = i % 2 == 1 ? upper.back() : pixel;  // 2 x 2 alike: chroma is exact
    upper.push_back(doubled);
    lower.push_back(doubled);
  }
  std::vector<std::uint8_t> y0(64), y1(64), cb(32), cr(32);
  rows_to_yuv(upper.data(), lower.data(), 64, y0.data(), y1.data(), cb.data(), cr.data());
  std::vector<Rgb8> back(64);
  row_from_yuv(y0.data(), cb.data(), cr.data(), 64, back.data());
  for (std::size_t i = 0; i < 64; ++i) {
    const Rgb8 p = upper[i];
    const double y = 0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b;
    EXPECT_NEAR(y0[i], y, 1.0);
    EXPECT_EQ(y0[i], y1[i]);
    EXPECT_NEAR(cb[i / 2], std::min((p.b - y) / 1.8556 + 128.0, 255.0), 1.0);
    EXPECT_NEAR(cr[i / 2], std::min((p.r - y) / 1.5748 + 128.0, 255.0), 1.0);
    EXPECT_NEAR(back[i].r, p.r, 2.0);
    EXPECT_NEAR(back[i].g, p.g, 2.0);
    EXPECT_NEAR(back[i].b, p.b, 2.0);
  }
}

TEST_F(H264, AMovingTextureComesBackAfterAKeyFrameAndEveryFrameAfterIt) {
  for (int i = 0; i < 10; ++i) {
    const auto picture = textured(203, 117, 3 * i);  // odd: neither side is a whole macroblock
    const auto coded = encode(picture, {.quantiser = 18.0});
    EXPECT_EQ(coded.kind, i == 0 ? Kind::Key : Kind::Delta);
    EXPECT_GE(psnr_db(picture, decode(coded.bytes, 203, 117), picture.rect()), 34.0) << i;
  }
}

TEST_F(H264, AKeyFrameIsGivenWhenAskedForAndANewDecoderStartsThere) {
  const auto picture = textured(128, 96, 0);
  encode(picture);
  EXPECT_EQ(encode(picture).kind, Kind::Delta);
  const auto key = encode(picture, {.kind = Kind::Key, .quantiser = 18.0});
  EXPECT_EQ(key.kind, Kind::Key);
  decoder_ = make_decoder();
  EXPECT_GE(psnr_db(picture, decode(key.bytes, 128, 96), picture.rect()), 34.0);
}

TEST_F(H264, AFrameWithoutItsKeyFrameIsAnError) {
  encode(textured(128, 96, 0));
  const auto delta = encode(textured(128, 96, 2));
  Plane<Rgb8> picture(128, 96);
  EXPECT_FALSE(decoder_->decode(delta.bytes, picture.rect(), picture));
}

TEST_F(H264, EqualPicturesGiveEqualBytes) {
  const auto other = make_encoder();
  for (int i = 0; i < 6; ++i) {
    const auto picture = textured(160, 128, 5 * i);
    EXPECT_EQ(encode(picture, {.most_bytes = 4000}).bytes,
              other->encode(picture, {.most_bytes = 4000})->bytes);
  }
}

TEST_F(H264, BytesStayWithinTheirBoundAndTheBoundMayChange) {
  const auto mean_bytes = [&](std::size_t most, int first) {
    double sum = 0.0;
    for (int i = 0; i < 20; ++i) {
      sum += static_cast<double>(
          encode(textured(320, 240, 7 * (first + i)), {.quantiser = 10.0, .most_bytes = most})
              .bytes.size());
    }
    return sum / 20.0;
  };
  const double unbound = mean_bytes(0, 0);
  EXPECT_GT(unbound, 4600.0);
  EXPECT_LE(mean_bytes(4000, 20), 4000.0 * 1.15);
  EXPECT_LE(mean_bytes(2000, 40), 2000.0 * 1.15);
  EXPECT_GT(mean_bytes(0, 60), 4600.0) << "and it may be lifted again";
}

TEST_F(H264, WhatASaccadeLeavesMayBeTakenWhereItLandsUpToTwiceAFrame) {
  constexpr double kMost = 3000.0;
  const auto bytes_at_landing = [&](Wish::Burst burst) {
    encoder_ = make_encoder();
    Wish wish{.quantiser = 10.0, .most_bytes = static_cast<std::size_t>(kMost)};
    for (int i = 0; i < 10; ++i) encode(textured(320, 240, 2 * i), wish);
    wish.burst = burst;
    wish.quantiser = 45.0;  // while nothing is seen
    for (int i = 10; i < 13; ++i) encode(textured(320, 240, 2 * i), wish);
    wish.quantiser = 10.0;
    return static_cast<double>(encode(textured(320, 240, 5000), wish).bytes.size());
  };
  const double plain = bytes_at_landing(Wish::Burst::No),
               burst = bytes_at_landing(Wish::Burst::Yes);
  EXPECT_LE(plain, 1.3 * kMost);
  EXPECT_GE(burst, 1.3 * plain);
  EXPECT_LE(burst, 2.2 * kMost);
}

/// The bytes and the middle's PSNR of twelve frames, with or without offsets.
struct Quality {
  double bytes = 0.0, middle_db = 0.0;
};
Quality quality_of(double quantiser, bool offsets) {
  const foveation::Display display{math::symmetric_fov(Degrees{90.0}, 1.0), 320, 320};
  const PixelGrid grid = foveation::make_uniform_grid(display);
  const auto wanted = quantiser_offsets(grid, Gaze{}, foveation::RateModel{});
  const auto encoder = make_encoder();
  const auto decoder = make_decoder();
  Quality quality;
  Plane<Rgb8> decoded(320, 320);
  for (int i = 0; i < 12; ++i) {
    const auto picture = textured(320, 320, 4 * i);
    Wish wish{.quantiser = quantiser};
    if (offsets) wish.quantiser_offsets = wanted;
    const auto coded = encoder->encode(picture, wish);
    EXPECT_TRUE(decoder->decode(coded->bytes, decoded.rect(), decoded));
    quality.bytes += static_cast<double>(coded->bytes.size());
    quality.middle_db += psnr_db(picture, decoded, {120, 120, 80, 80}) / 12.0;
  }
  return quality;
}

TEST_F(H264, OffsetsSharpenTheMiddleAtEqualBytes) {
  const Quality foveal = quality_of(26.0, true);
  // The plain encoder's curve of PSNR over log bytes, read at the same bytes.
  const Quality more = quality_of(20.0, false), less = quality_of(34.0, false);
  ASSERT_GT(more.bytes, foveal.bytes);
  ASSERT_LT(less.bytes, foveal.bytes);
  const double share = std::log(foveal.bytes / less.bytes) / std::log(more.bytes / less.bytes);
  EXPECT_GE(foveal.middle_db - std::lerp(less.middle_db, more.middle_db, share), 1.0);
}

TEST_F(H264, DamagedBytesAreRefusedOrGiveAPictureAndNeverMore) {
  const auto key = encode(textured(96, 96, 0));
  Plane<Rgb8> picture(96, 96);
  const auto count = flip_bits(key.bytes, 400, 5, [&](std::span<const std::byte> bytes) {
    return make_decoder()->decode(bytes, picture.rect(), picture).has_value();
  });
  EXPECT_GT(count.refused, 0);
}

TEST_F(H264, ADecoderGoesOnWithTheNextKeyFrameAfterDamage) {
  auto key = encode(textured(96, 96, 0));
  Plane<Rgb8> picture(96, 96);
  EXPECT_FALSE(
      decoder_->decode(std::span(key.bytes).first(key.bytes.size() / 3), picture.rect(), picture));
  const auto next = encode(textured(96, 96, 1), {.kind = Kind::Key});
  EXPECT_TRUE(decoder_->decode(next.bytes, picture.rect(), picture));
}

TEST_F(H264, AFrameThatGrowsALittleKeepsTheStream) {
  int keys = 0;
  for (int i = 0; i < 12; ++i) {
    const int width = 200 + i % 4;
    const auto picture = textured(width, 150, i);
    const auto coded = encode(picture);
    keys += coded.kind == Kind::Key ? 1 : 0;
    EXPECT_GE(psnr_db(picture, decode(coded.bytes, width, 150), picture.rect()), 28.0);
  }
  EXPECT_EQ(keys, 1);
}

TEST_F(H264, WishesOutOfRangeAreRefused) {
  const auto picture = textured(64, 64, 0);
  EXPECT_FALSE(encoder_->encode(picture, {.quantiser = 52.0}));
  EXPECT_FALSE(encoder_->encode(Plane<Rgb8>{}, {}));
  const std::vector<float> too_few(3, 0.0F);
  EXPECT_FALSE(encoder_->encode(picture, {.quantiser_offsets = too_few}));
}

TEST(CanvasSize, GrowsAtOnceAndShrinksAfterTwoSecondsOfLess) {
  CanvasSize canvas;
  EXPECT_TRUE(canvas.fit(300, 200, 0s));
  EXPECT_EQ(canvas.width_px(), 320);
  EXPECT_FALSE(canvas.fit(320, 224, 10ms));
  EXPECT_TRUE(canvas.fit(330, 224, 20ms));
  EXPECT_GE(canvas.width_px(), 350);
  for (int i = 3; i < 200; ++i) EXPECT_FALSE(canvas.fit(100, 224, i * 10ms)) << i;
  EXPECT_FALSE(canvas.fit(100, 224, 2100ms)) << "what the last two seconds needed was 330";
  EXPECT_TRUE(canvas.fit(100, 224, 4200ms));
  EXPECT_EQ(canvas.width_px(), 128);
}

TEST(QuantiserOffsets, NeverFallWithEccentricityAndSpanTheirRange) {
  const foveation::Display display{math::symmetric_fov(Degrees{90.0}, 1.0), 320, 320};
  const Gaze gaze{glm::normalize(Vec3{0.3F, 0.2F, -1.0F})};
  const PixelGrid grid = foveation::make_foveal_grid(display, gaze, foveation::RateModel{});
  const auto offsets = quantiser_offsets(grid, gaze, foveation::RateModel{}, {-4.0, 6.0});
  const int across = (grid.width() + 15) / 16, down = (grid.height() + 15) / 16;
  ASSERT_EQ(offsets.size(), static_cast<std::size_t>(across * down));
  const auto [least, most] = std::minmax_element(offsets.begin(), offsets.end());
  EXPECT_FLOAT_EQ(*least, -4.0F);
  EXPECT_FLOAT_EQ(*most, 6.0F);
  const auto at_gaze = grid.locate({0.3F, -0.2F});
  ASSERT_TRUE(at_gaze);
  const int row = static_cast<int>(at_gaze->y) / 16;
  for (int x = static_cast<int>(at_gaze->x) / 16; x + 1 < across; ++x) {
    EXPECT_LE(offsets[row * across + x], offsets[row * across + x + 1]);
  }
}

TEST(QuantiserOffsets, AGazeOffTheGridIsMetByItsNearestEdge) {
  const foveation::Display display{math::symmetric_fov(Degrees{60.0}, 1.0), 160, 160};
  const PixelGrid grid = foveation::make_uniform_grid(display);
  for (const Vec3& direction : {Vec3{1.0F, 0.0F, -0.1F}, Vec3{1.0F, 0.0F, 0.5F}}) {
    const auto offsets =
        quantiser_offsets(grid, Gaze{glm::normalize(direction)}, foveation::RateModel{});
    const auto finest = std::min_element(offsets.begin(), offsets.end()) - offsets.begin();
    EXPECT_EQ(finest % 10, 9) << "the rightmost macroblock";
  }
}

}  // namespace
}  // namespace macula::codec
