#include "server/shading/texel_codes.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "shared/image/tone.h"

namespace macula::shading {
namespace {

TEST(TexelCodes, EveryCodeComesBackAsItself) {
  for (const auto space : {scene::ColorSpace::Linear, scene::ColorSpace::Srgb}) {
    const TexelCodes& codes = TexelCodes::of(space);
    for (int code = 0; code < 256; ++code) {
      EXPECT_EQ(codes.encode(codes.decoded()[code]), code);
    }
  }
}

// The definition is the transfer curve itself, rounded; a value a float away from a border may fall
// on either side of it.
TEST(TexelCodes, EncodesAsTheCurveRoundsThroughoutItsRange) {
  const TexelCodes& codes = TexelCodes::of(scene::ColorSpace::Srgb);
  int different = 0;
  for (int i = 0; i <= 100'000; ++i) {
    const float linear = static_cast<float>(i) / 100'000.0F;
    const double exact = 255.0 * static_cast<double>(image::srgb_from_linear(linear));
    const int rounded = static_cast<int>(exact + 0.5);
    if (codes.encode(linear) == rounded) continue;
    ++different;
    EXPECT_NEAR(exact - std::floor(exact), 0.5, 1e-3) << linear;
  }
  EXPECT_LT(different, 10);
}

TEST(TexelCodes, ValuesOutsideReadTheNearerEnd) {
  const TexelCodes& codes = TexelCodes::of(scene::ColorSpace::Srgb);
  EXPECT_EQ(codes.encode(-1.0F), 0);
  EXPECT_EQ(codes.encode(7.0F), 255);
  EXPECT_EQ(codes.encode(std::numeric_limits<float>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace macula::shading
