#include "shared/codec/color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include "tests/shared/codec/damage.h"

namespace macula::codec {
namespace {

using image::Plane;
using image::Rect;

constexpr ColorOptions kLossless{ColorCodec::Lossless, 85, Chroma::Half};

Plane<Rgb8> random_picture(int width, int height) {
  std::mt19937 random(static_cast<unsigned>(width * 1000 + height));
  Plane<Rgb8> picture(width, height);
  for (auto& pixel : picture.pixels()) {
    const auto bits = static_cast<std::uint32_t>(random());
    pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
             static_cast<std::uint8_t>(bits >> 16)};
  }
  return picture;
}

/// Slow waves in every channel, of periods well above a JPEG block.
Plane<Rgb8> smooth_picture(int width, int height) {
  const auto wave = [](double phase) {
    return static_cast<std::uint8_t>(std::lround(128.0 + 90.0 * std::sin(phase)));
  };
  Plane<Rgb8> picture(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture(x, y) = {wave(x * 0.05), wave(y * 0.04), wave((x + y) * 0.03)};
  return picture;
}

double psnr_db(const Plane<Rgb8>& a, const Plane<Rgb8>& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Rgb8 p = a.pixels()[i], q = b.pixels()[i];
    squares += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
  }
  return -10.0 * std::log10(squares / (3.0 * static_cast<double>(a.size())) / (255.0 * 255.0));
}

Plane<Rgb8> round_trip(const Plane<Rgb8>& picture, const ColorOptions& options) {
  const auto bytes = encode_color(picture, picture.rect(), options);
  EXPECT_TRUE(bytes) << bytes.error().message();
  Plane<Rgb8> decoded(picture.width(), picture.height());
  const auto ok = decode_color(*bytes, options.codec, picture.rect(), decoded);
  EXPECT_TRUE(ok) << ok.error().message();
  return decoded;
}

bool equal(const Plane<Rgb8>& a, const Plane<Rgb8>& b) {
  return a.rect() == b.rect() &&
         std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin());
}

std::size_t coded_size(const Plane<Rgb8>& picture, const ColorOptions& options) {
  return encode_color(picture, picture.rect(), options)->size();
}

TEST(LosslessColor, IsBitExactForAnySize) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {7, 5}, {16, 16}, {33, 17}, {257, 63}}) {
    const auto noise = random_picture(width, height);
    EXPECT_TRUE(equal(round_trip(noise, kLossless), noise)) << width << " x " << height;
    const auto smooth = smooth_picture(width, height);
    EXPECT_TRUE(equal(round_trip(smooth, kLossless), smooth)) << width << " x " << height;
  }
}

TEST(LosslessColor, PredictionMakesSmoothPicturesSmall) {
  const auto smooth = smooth_picture(256, 256);
  EXPECT_LT(coded_size(smooth, kLossless), smooth.size());  // of 3 bytes a pixel
  EXPECT_GT(coded_size(random_picture(256, 256), kLossless), 3 * smooth.size() * 9 / 10);
}

TEST(JpegColor, SmoothPicturesSurviveWithStatedQuality) {
  const auto smooth = smooth_picture(321, 203);
  EXPECT_GE(psnr_db(round_trip(smooth, {ColorCodec::Jpeg, 85, Chroma::Half}), smooth), 38.0);
  EXPECT_GE(psnr_db(round_trip(smooth, {ColorCodec::Jpeg, 85, Chroma::Full}), smooth), 40.0);
  EXPECT_GE(psnr_db(round_trip(smooth, {ColorCodec::Jpeg, 98, Chroma::Full}), smooth), 45.0);
}

TEST(JpegColor, HigherQualityIsCloserAndLarger) {
  const auto picture = smooth_picture(160, 160);
  double last_psnr = 0.0;
  std::size_t last_size = 0;
  for (const int quality : {20, 50, 80, 95}) {
    const ColorOptions options{ColorCodec::Jpeg, quality, Chroma::Full};
    const double psnr = psnr_db(round_trip(picture, options), picture);
    EXPECT_GT(psnr, last_psnr) << quality;
    EXPECT_GT(coded_size(picture, options), last_size) << quality;
    last_psnr = psnr;
    last_size = coded_size(picture, options);
  }
}

TEST(JpegColor, HalfChromaIsSmallerThanFull) {
  const auto picture = smooth_picture(160, 160);
  EXPECT_LT(coded_size(picture, {ColorCodec::Jpeg, 85, Chroma::Half}),
            coded_size(picture, {ColorCodec::Jpeg, 85, Chroma::Full}));
}

TEST(JpegColor, OddSizesDecodeToTheirOwnSize) {
  for (const auto chroma : {Chroma::Full, Chroma::Half})
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {17, 1}, {15, 31}, {101, 67}}) {
      const Plane<Rgb8> grey(width, height, Rgb8{120, 120, 120});
      const auto decoded = round_trip(grey, {ColorCodec::Jpeg, 90, chroma});
      for (const Rgb8 pixel : decoded.pixels()) EXPECT_NEAR(pixel.g, 120, 2);
    }
}

TEST(Color, ARectangleIsCutOutAndPutBackInPlace) {
  const auto picture = smooth_picture(64, 48);
  const Rect from{13, 7, 21, 19}, to{30, 20, 21, 19};
  const Rgb8 untouched{1, 2, 3};
  for (const auto& [options, tolerance] :
       {std::pair{kLossless, 0}, {ColorOptions{ColorCodec::Jpeg, 98, Chroma::Full}, 8}}) {
    const auto bytes = encode_color(picture, from, options);
    ASSERT_TRUE(bytes);
    Plane<Rgb8> target(64, 48, untouched);
    ASSERT_TRUE(decode_color(*bytes, options.codec, to, target));
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const bool inside = x >= 30 && x < 51 && y >= 20 && y < 39;
        if (!inside) {
          ASSERT_EQ(target(x, y), untouched);
          continue;
        }
        ASSERT_NEAR(target(x, y).r, picture(x - 17, y - 13).r, tolerance);
        ASSERT_NEAR(target(x, y).b, picture(x - 17, y - 13).b, tolerance);
      }
  }
}

TEST(Color, BadRectanglesAndQualitiesAreErrors) {
  Plane<Rgb8> picture(16, 16);
  for (const Rect rect : {Rect{0, 0, 0, 4},
                          {0, 0, 17, 4},
                          {-1, 0, 4, 4},
                          {14, 0, 4, 4},
                          {0, 2147483647, 4, 4},
                          {0, 0, 4, -4}}) {
    EXPECT_FALSE(encode_color(picture, rect, {}));
    EXPECT_FALSE(decode_color({}, ColorCodec::Jpeg, rect, picture));
  }
  for (const int quality : {0, 101, -5})
    EXPECT_FALSE(encode_color(picture, picture.rect(), {ColorCodec::Jpeg, quality, Chroma::Half}));
}

TEST(Color, BytesOfAnotherSizeOrCodecAreRefused) {
  Plane<Rgb8> picture(32, 16), other(16, 32);
  for (const auto codec : {ColorCodec::Jpeg, ColorCodec::Lossless}) {
    const auto bytes = encode_color(picture, picture.rect(), {codec, 85, Chroma::Half});
    const auto refused = decode_color(*bytes, codec, other.rect(), other);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message().find("32 x 16"), std::string::npos);
    const auto wrong = codec == ColorCodec::Jpeg ? ColorCodec::Lossless : ColorCodec::Jpeg;
    EXPECT_FALSE(decode_color(*bytes, wrong, picture.rect(), picture));
  }
}

TEST(Color, ClaimsOfHugePicturesAreRefusedByTheirHeaders) {
  Plane<Rgb8> picture(16, 16);
  auto jpeg = *encode_color(picture, picture.rect(), {});
  // SOF0 is FF C0, length (2), precision (1), height (2), width (2).
  const std::byte sof0[] = {std::byte{0xFF}, std::byte{0xC0}};
  const auto at = std::search(jpeg.begin(), jpeg.end(), std::begin(sof0), std::end(sof0));
  ASSERT_NE(at, jpeg.end());
  std::fill(at + 5, at + 9, std::byte{0xF0});  // libjpeg itself stops at 65500
  const auto refused = decode_color(jpeg, ColorCodec::Jpeg, picture.rect(), picture);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("61680 x 61680"), std::string::npos);

  auto lossless = *encode_color(picture, picture.rect(), kLossless);
  std::fill(lossless.begin(), lossless.begin() + 4, std::byte{0xFF});
  EXPECT_FALSE(decode_color(lossless, ColorCodec::Lossless, picture.rect(), picture));
}

TEST(Color, AnHonestHeaderBeforeAnotherContentSizeIsRefused) {
  Plane<Rgb8> small(16, 16), large(64, 64);
  auto bytes = *encode_color(large, large.rect(), kLossless);
  const auto honest = *encode_color(small, small.rect(), kLossless);
  std::copy_n(honest.begin(), 4, bytes.begin());
  const auto refused = decode_color(bytes, ColorCodec::Lossless, small.rect(), small);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("12288"), std::string::npos);  // 3 x 64 x 64
}

TEST(Color, TruncatedBytesAreErrors) {
  const auto picture = random_picture(24, 24);
  for (const auto codec : {ColorCodec::Jpeg, ColorCodec::Lossless}) {
    const auto bytes = *encode_color(picture, picture.rect(), {codec, 85, Chroma::Half});
    Plane<Rgb8> target(24, 24);
    const auto count = truncate_everywhere(bytes, [&](std::span<const std::byte> cut) {
      return decode_color(cut, codec, target.rect(), target).has_value();
    });
    // A JPEG without its last marker bytes may still hold every block.
    EXPECT_LE(count.accepted, codec == ColorCodec::Jpeg ? 4 : 0);
  }
}

TEST(Color, FlippedBitsGiveAnErrorOrAPictureOfTheSameSize) {
  const auto picture = smooth_picture(24, 24);
  for (const auto codec : {ColorCodec::Jpeg, ColorCodec::Lossless}) {
    const auto bytes = *encode_color(picture, picture.rect(), {codec, 60, Chroma::Half});
    Plane<Rgb8> target(24, 24);
    const auto count = flip_bits(bytes, 10'000, 5, [&](std::span<const std::byte> damaged) {
      const bool decoded = decode_color(damaged, codec, target.rect(), target).has_value();
      EXPECT_EQ(target.rect(), picture.rect());
      return decoded;
    });
    EXPECT_GT(count.refused, 0);
    if (codec == ColorCodec::Lossless) {  // the checksum sees what the format lets through
      EXPECT_GT(count.refused, 9'900);
    }
  }
}

TEST(Color, ThreadsDoNotDisturbEachOther) {
  const auto work = [](int width) {
    const auto picture = random_picture(width, 40);
    for (int i = 0; i < 20; ++i)
      if (!equal(round_trip(picture, kLossless), picture)) return false;
    return psnr_db(round_trip(smooth_picture(width, 40), {}), smooth_picture(width, 40)) > 30.0;
  };
  std::vector<char> right(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < right.size(); ++t)
    threads.emplace_back([&, t] { right[t] = work(30 + 10 * static_cast<int>(t)); });
  for (auto& thread : threads) thread.join();
  for (const char ok : right) EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace macula::codec
