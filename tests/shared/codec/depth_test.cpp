#include "shared/codec/depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "tests/shared/codec/damage.h"

namespace macula::codec {
namespace {

using image::Plane;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A tilted floor, boxes before it and sky above.
Plane<float> scene_depth(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> jitter(0.0F, 0.02F);
  Plane<float> depth(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool sky = y < height / 4;
      const float floor_m =
          1.5F + 40.0F * static_cast<float>(height - y) / static_cast<float>(height);
      depth(x, y) = sky ? kInfinity : (x / 11 % 3 == 0 ? 0.8F : floor_m) + jitter(random);
    }
  return depth;
}

Plane<float> decode(const EncodedDepth& encoded, int width, int height) {
  Plane<float> inverse(width, height);
  const auto ok = decode_depth(encoded.bytes, encoded.inverse_scale_per_m, inverse);
  EXPECT_TRUE(ok) << ok.error().message();
  return inverse;
}

/// The largest |decoded - 1/z| of a block, in 1/m and in double; nothing there is 0.
double worst_in_block(const Plane<float>& depth_m, const Plane<float>& inverse, int bx, int by) {
  double worst = 0.0;
  for (int y = by * 8; y < std::min(by * 8 + 8, depth_m.height()); ++y)
    for (int x = bx * 8; x < std::min(bx * 8 + 8, depth_m.width()); ++x) {
      const double truth = std::isnan(depth_m(x, y)) ? 0.0 : 1.0 / double{depth_m(x, y)};
      worst = std::max(worst, std::abs(double{inverse(x, y)} - truth));
    }
  return worst;
}

/// Every block keeps what it states, and states less than a unit too much.
void expect_residual_holds(const Plane<float>& depth_m, const EncodedDepth& encoded) {
  const auto inverse = decode(encoded, depth_m.width(), depth_m.height());
  const double unit = double{encoded.inverse_scale_per_m} / 65535.0 / 16.0;
  const int columns = (depth_m.width() + 7) / 8, rows = (depth_m.height() + 7) / 8;
  ASSERT_EQ(encoded.residual.size(), static_cast<std::size_t>(columns * rows));
  for (int by = 0; by < rows; ++by)
    for (int bx = 0; bx < columns; ++bx) {
      const int stated = encoded.residual[static_cast<std::size_t>(by * columns + bx)];
      const double worst = worst_in_block(depth_m, inverse, bx, by);
      if (stated == 255) {
        EXPECT_GE(worst, 254.0 * unit) << bx << ", " << by;
        continue;
      }
      EXPECT_LE(worst, stated * unit) << bx << ", " << by;
      EXPECT_LE(stated, std::ceil(worst / unit + 0.25)) << bx << ", " << by;
    }
}

TEST(DepthCodec, EveryBlockKeepsItsStatedResidual) {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 9}, {8, 8}, {65, 33}, {200, 120}}) {
    const auto depth = scene_depth(width, height, 3);
    const auto encoded = encode_depth(depth);
    ASSERT_TRUE(encoded) << encoded.error().message();
    expect_residual_holds(depth, *encoded);
  }
}

TEST(DepthCodec, AResidualOfOneUnitLessWouldBeALie) {
  // The twin that must fail: were residuals rounded down, some block would break its word.
  const auto depth = scene_depth(200, 120, 4);
  const auto encoded = *encode_depth(depth);
  const auto inverse = decode(encoded, 200, 120);
  const double unit = double{encoded.inverse_scale_per_m} / 65535.0 / 16.0;
  int broken = 0;
  for (int by = 0; by < 15; ++by)
    for (int bx = 0; bx < 25; ++bx) {
      const int stated = encoded.residual[static_cast<std::size_t>(by * 25 + bx)];
      broken += worst_in_block(depth, inverse, bx, by) > (stated - 1) * unit;
    }
  EXPECT_GT(broken, 25 * 15 / 2);
}

TEST(DepthCodec, ErrorIsHalfAStepAndTheScaleIsTheFramesOwn) {
  const auto depth = scene_depth(64, 64, 5);
  const float nearest = *std::min_element(depth.pixels().begin(), depth.pixels().end());
  const auto encoded = *encode_depth(depth);
  EXPECT_EQ(encoded.inverse_scale_per_m, 1.0F / nearest);
  const double half_step = double{encoded.inverse_scale_per_m} / 65535.0 / 2.0;
  const auto inverse = decode(encoded, 64, 64);
  for (int by = 0; by < 8; ++by)
    for (int bx = 0; bx < 8; ++bx)
      EXPECT_LE(worst_in_block(depth, inverse, bx, by), half_step * 1.02);
}

TEST(DepthCodec, NothingThereIsZeroExactlyAndNothingElseIs) {
  auto depth = scene_depth(61, 47, 6);
  depth(3, 40) = kNan;  // counts as nothing there
  const auto inverse = decode(*encode_depth(depth), 61, 47);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const bool nothing = !std::isfinite(depth.pixels()[i]);
    EXPECT_EQ(inverse.pixels()[i] == 0.0F, nothing) << i;
  }
}

TEST(DepthCodec, OnlyWhatIsFartherThanHalfAStepBecomesZero) {
  Plane<float> depth(3, 1, 1.0F);
  depth(1, 0) = 131'000.0F;  // 65535 / 131000 = 0.50027 steps
  depth(2, 0) = 131'200.0F;  // 0.49951 steps
  const auto encoded = *encode_depth(depth);
  const auto inverse = decode(encoded, 3, 1);
  EXPECT_EQ(inverse(0, 0), 1.0F);
  EXPECT_GT(inverse(1, 0), 0.0F);
  EXPECT_EQ(inverse(2, 0), 0.0F);
  EXPECT_EQ(encoded.residual[0], 8);  // half a step of sixteen units
}

TEST(DepthCodec, AnEmptyFrameHasNoScaleAndDecodesToNothing) {
  const Plane<float> depth(20, 10, kInfinity);
  const auto encoded = *encode_depth(depth);
  EXPECT_EQ(encoded.inverse_scale_per_m, 0.0F);
  EXPECT_EQ(encoded.residual, std::vector<std::uint8_t>(6, 0));
  const auto inverse = decode(encoded, 20, 10);
  for (const float value : inverse.pixels()) EXPECT_EQ(value, 0.0F);
}

TEST(DepthCodec, WhatIsTooNearClampsAndSaysSo) {
  Plane<float> depth(24, 8, 2.0F);
  depth(2, 2) = 0.01F;
  depth(10, 3) = -1.0F;
  const auto encoded = *encode_depth(depth, {.nearest_m = 0.1F});
  EXPECT_FLOAT_EQ(encoded.inverse_scale_per_m, 10.0F);
  const auto inverse = decode(encoded, 24, 8);
  EXPECT_FLOAT_EQ(inverse(2, 2), 10.0F);
  EXPECT_FLOAT_EQ(inverse(10, 3), 10.0F);
  EXPECT_EQ(encoded.residual[0], 255);
  EXPECT_EQ(encoded.residual[1], 255);
  EXPECT_LE(encoded.residual[2], 8);
}

TEST(DepthCodec, ExtremeDistancesStayFiniteAndTruthful) {
  for (const float far : {1e-3F, 1e20F, 3e38F}) {
    Plane<float> depth(8, 8, far);
    depth(1, 1) = std::numeric_limits<float>::denorm_min();
    depth(2, 2) = 0.0F;
    const auto encoded = *encode_depth(depth, {.nearest_m = 1e-6F});
    EXPECT_TRUE(std::isfinite(encoded.inverse_scale_per_m));
    EXPECT_EQ(encoded.residual[0], 255);
    const auto inverse = decode(encoded, 8, 8);
    for (const float value : inverse.pixels()) EXPECT_TRUE(std::isfinite(value));
  }
  expect_residual_holds(Plane<float>(8, 8, 3e38F), *encode_depth(Plane<float>(8, 8, 3e38F)));
}

TEST(DepthCodec, PlanesInPerspectiveCompressWell) {
  // 1/z is affine on a plane: left differences vary by at most one step.
  Plane<float> depth(256, 256);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      depth(x, y) =
          1.0F / (0.1F + 0.001F * static_cast<float>(x) + 0.0005F * static_cast<float>(y));
  EXPECT_LT(encode_depth(depth)->bytes.size(), 2 * depth.size() / 5);
}

TEST(DepthCodec, WrongSizesScalesAndOptionsAreErrors) {
  const auto encoded = *encode_depth(scene_depth(32, 16, 7));
  Plane<float> transposed(16, 32), right(32, 16), none;
  const auto refused = decode_depth(encoded.bytes, 1.0F, transposed);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("32 x 16"), std::string::npos);
  for (const float scale : {-1.0F, kNan, kInfinity})
    EXPECT_FALSE(decode_depth(encoded.bytes, scale, right));
  EXPECT_FALSE(decode_depth(encoded.bytes, 1.0F, none));
  EXPECT_FALSE(encode_depth(none));
  for (const float nearest : {0.0F, -1.0F, kNan, kInfinity})
    EXPECT_FALSE(encode_depth(right, {.nearest_m = nearest}));
}

TEST(DepthCodec, DamagedBytesAreErrors) {
  const auto encoded = *encode_depth(scene_depth(32, 32, 8));
  Plane<float> inverse(32, 32);
  const auto decodes = [&](std::span<const std::byte> bytes) {
    const bool decoded = decode_depth(bytes, encoded.inverse_scale_per_m, inverse).has_value();
    EXPECT_EQ(inverse.width(), 32);
    return decoded;
  };
  EXPECT_EQ(truncate_everywhere(encoded.bytes, decodes).accepted, 0);
  EXPECT_GT(flip_bits(encoded.bytes, 10'000, 9, decodes).refused, 9'900);
}

TEST(DepthCodec, HugeClaimsAreRefusedByTheirHeader) {
  auto bytes = encode_depth(scene_depth(32, 32, 10))->bytes;
  std::fill(bytes.begin(), bytes.begin() + 4, std::byte{0xFF});
  Plane<float> inverse(32, 32);
  const auto refused = decode_depth(bytes, 1.0F, inverse);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("65535 x 65535"), std::string::npos);
}

TEST(DepthCodec, AZstdFrameThatClaimsGigabytesIsRefusedBeforeAllocating) {
  // Size 8 x 8, then a frame header: magic, descriptor (single segment, 8-byte content size), 2^40.
  const unsigned char claim[] = {8, 0, 8, 0, 0x28, 0xB5, 0x2F, 0xFD, 0xE0, 0, 0, 0, 0, 0, 1, 0, 0};
  std::vector<std::byte> bytes(sizeof(claim));
  std::memcpy(bytes.data(), claim, sizeof(claim));
  Plane<float> inverse(8, 8);
  const auto refused = decode_depth(bytes, 1.0F, inverse);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("1099511627776"), std::string::npos);
}

// Inverse depth is affine on a plane, so bilinear samples of it are exact between them; beyond an
// edge of depth a cell has one surface's depth or the other's, never one between.
TEST(DepthCodec, ThinnedDepthIsRightOnAPlaneAndInventsNothingAtAnEdge) {
  constexpr int kWidth = 61, kHeight = 43;
  Plane<float> depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      depth(x, y) = x < 30 ? 1.0F / (0.4F + 0.002F * static_cast<float>(x + y)) : 10.0F;
  std::size_t bytes = encode_depth(depth)->bytes.size();
  for (const int divisor : {2, 4, 8}) {
    DepthOptions options;
    options.divisor = divisor;
    const auto encoded = encode_depth(depth, options);
    ASSERT_TRUE(encoded);
    EXPECT_TRUE(encoded->residual.empty());
    EXPECT_LT(encoded->bytes.size(), bytes);
    bytes = encoded->bytes.size();
    Plane<float> decoded(kWidth, kHeight);
    ASSERT_TRUE(decode_depth(encoded->bytes, encoded->inverse_scale_per_m, decoded));
    for (int y = divisor; y < kHeight - divisor; ++y) {
      for (int x = divisor; x < kWidth; ++x) {
        const float plane = 0.4F + 0.002F * static_cast<float>(x + y);
        if (x < 30 - divisor) {
          EXPECT_NEAR(decoded(x, y), plane, 1e-4F) << divisor << " " << x;
        } else if (x > 30 + divisor) {
          EXPECT_NEAR(decoded(x, y), 0.1F, 1e-4F) << divisor << " " << x;
        }
        EXPECT_TRUE(decoded(x, y) < 0.11F || decoded(x, y) > 0.39F) << divisor << " " << x;
      }
    }
  }
}

TEST(DepthCodec, AnotherDivisorIsRefused) {
  DepthOptions options;
  options.divisor = 3;
  EXPECT_FALSE(encode_depth(Plane<float>(8, 8), options));
}

}  // namespace
}  // namespace macula::codec
