#include "shared/image/tone.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace macula::image {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// IEC 61966-2-1 in double, rounded to the nearest code: what the table has to reproduce.
int code_by_formula(float linear) {
  const double x = std::min(std::max(double{linear}, 0.0), 1.0);
  const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
  return static_cast<int>(std::floor(255.0 * srgb + 0.5));
}

int code_of(float linear) {
  return encode(Tone{}, Rgb{linear, 0.0F, 0.0F}).r;
}

/// Where code `code` begins, by bisection on the formula over the floats of [0, 1].
float boundary_by_formula(int code) {
  std::uint32_t below = 0, above = std::bit_cast<std::uint32_t>(1.0F);
  while (above - below > 1) {
    const std::uint32_t middle = below + (above - below) / 2;
    (code_by_formula(std::bit_cast<float>(middle)) < code ? below : above) = middle;
  }
  return std::bit_cast<float>(above);
}

/// Floats around every place where the code changes, the specials, and random ones of all sizes.
std::vector<float> probing_radiances() {
  std::vector<float> values{0.0F,   -0.0F, -1.0F,  kNan,  -kNan,   kInfinity, -kInfinity,
                            1e-45F, 1.0F,  1e-38F, 3e38F, -1e-45F, 65504.0F};
  for (int code = 1; code <= 255; ++code) {
    const auto bits = std::bit_cast<std::uint32_t>(boundary_by_formula(code));
    for (std::uint32_t step = 0; step < 9; ++step)
      values.push_back(std::bit_cast<float>(bits - 4 + step));
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F), exponent(-20.0F, 10.0F);
  while (values.size() < 3 * 350'000) {
    values.push_back(unit(random));
    values.push_back(std::exp2(exponent(random)));
    values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  }
  values.resize(3 * 350'000);
  return values;
}

TEST(Tone, KnownValues) {
  EXPECT_EQ(code_of(0.0F), 0);
  EXPECT_EQ(code_of(0.18F), 118);  // 255 (1.055 0.18^(1/2.4) - 0.055) = 117.6
  EXPECT_EQ(code_of(0.5F), 188);   // 187.5
  EXPECT_EQ(code_of(1.0F), 255);
  EXPECT_EQ(code_of(7.0F), 255);
  EXPECT_FLOAT_EQ(srgb_from_linear(0.5F), 0.7353569F);
  EXPECT_FLOAT_EQ(linear_from_srgb(0.5F), 0.2140411F);
}

TEST(Tone, EveryCodeBeginsExactlyWhereTheFormulaSays) {
  for (int code = 1; code <= 255; ++code) {
    const float boundary = boundary_by_formula(code);
    EXPECT_EQ(code_of(boundary), code);
    EXPECT_EQ(code_of(std::nextafter(boundary, 0.0F)), code - 1);
  }
}

TEST(Tone, EncodingNeverFallsWithRadiance) {
  for (const auto curve : {ToneCurve::Linear, ToneCurve::Filmic}) {
    int last = 0;
    for (int i = 0; i <= 200'000; ++i) {
      const float radiance = 8.0F * static_cast<float>(i) / 200'000.0F;
      const int code = encode(Tone{0.0F, curve}, Rgb{radiance}).g;
      ASSERT_GE(code, last) << radiance;
      last = code;
    }
    EXPECT_EQ(last, 255);
  }
}

TEST(Tone, VectorsEqualTheScalarPixelByPixel) {
  const auto values = probing_radiances();
  const int width = 1000, height = 350;
  Plane<Rgb> radiance(width, height);
  for (std::size_t i = 0; i < radiance.size(); ++i)
    radiance.pixels()[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  for (const Tone tone : {Tone{}, Tone{1.37F, ToneCurve::Linear}, Tone{-2.5F, ToneCurve::Filmic},
                          Tone{200.0F, ToneCurve::Filmic}}) {
    Plane<Rgb8> encoded;
    encode(tone, radiance, encoded);
    ASSERT_EQ(encoded.rect(), radiance.rect());
    for (std::size_t i = 0; i < radiance.size(); ++i)
      ASSERT_EQ(encoded.pixels()[i], encode(tone, radiance.pixels()[i])) << i;
  }
}

TEST(Tone, ShortRowsHaveNoVectorLeftOverWrong) {
  for (int width = 1; width < 40; ++width) {
    Plane<Rgb> radiance(width, 1);
    for (int x = 0; x < width; ++x) radiance(x, 0) = Rgb{0.02F * static_cast<float>(x)};
    Plane<Rgb8> encoded;
    encode(Tone{}, radiance, encoded);
    for (int x = 0; x < width; ++x) EXPECT_EQ(encoded(x, 0), encode(Tone{}, radiance(x, 0)));
  }
}

TEST(Tone, WhatIsNotFiniteOrNegativeIsBlack) {
  for (const float bad : {kNan, kInfinity, -kInfinity, -1.0F}) {
    EXPECT_EQ(encode(Tone{}, Rgb{bad, 0.5F, bad}), (Rgb8{0, 188, 0}));
    EXPECT_EQ(encode(Tone{3.0F, ToneCurve::Filmic}, Rgb{bad}), Rgb8{});
  }
  EXPECT_EQ(srgb_from_linear(kNan), 0.0F);
  EXPECT_EQ(linear_from_srgb(kNan), 0.0F);
}

TEST(Tone, BrightnessBeyondFloatsIsWhiteNotBlack) {
  const Rgb bright{3e38F};
  EXPECT_EQ(encode(Tone{100.0F, ToneCurve::Linear}, bright), (Rgb8{255, 255, 255}));
  EXPECT_EQ(encode(Tone{100.0F, ToneCurve::Filmic}, bright), (Rgb8{255, 255, 255}));
}

TEST(Tone, OneStopOfExposureDoublesLight) {
  EXPECT_EQ(display_linear(Tone{1.0F}, Rgb{0.25F}), Rgb{0.5F});
  EXPECT_EQ(display_linear(Tone{-1.0F}, Rgb{0.25F}), Rgb{0.125F});
  EXPECT_EQ(display_linear(Tone{4.0F}, Rgb{0.25F}), Rgb{1.0F});
}

TEST(Tone, FilmicCurveHasItsPublishedValues) {
  // x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14) at 0, 0.18 and 1.
  const Tone filmic{0.0F, ToneCurve::Filmic};
  EXPECT_EQ(display_linear(filmic, Rgb{0.0F}).x, 0.0F);
  EXPECT_NEAR(display_linear(filmic, Rgb{0.18F}).x, 0.0867240 / 0.3249320, 1e-6);
  EXPECT_NEAR(display_linear(filmic, Rgb{1.0F}).x, 2.54 / 3.16, 1e-6);
}

TEST(Tone, DecodingInvertsEncodingForEveryCode) {
  Plane<Rgb8> codes(256, 1);
  for (int i = 0; i < 256; ++i) {
    const auto code = static_cast<std::uint8_t>(i);
    codes(i, 0) = {code, static_cast<std::uint8_t>(255 - i), code};
  }
  const auto linear = decode_display_linear(codes);
  EXPECT_EQ(linear(255, 0).x, 1.0F);
  Plane<Rgb8> again;
  encode(Tone{}, linear, again);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(again(i, 0), codes(i, 0)) << i;
}

TEST(Tone, TransferFunctionsAreInverse) {
  for (int i = 0; i <= 1000; ++i) {
    const float value = static_cast<float>(i) / 1000.0F;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(value)), value, 1e-6F);
  }
}

}  // namespace
}  // namespace macula::image
