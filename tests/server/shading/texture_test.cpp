#include "server/shading/texture.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace macula::shading {
namespace {

using image::Plane;
using image::Rgba8;
using scene::ColorSpace;
using scene::Wrap;

Plane<Rgba8> filled(int width, int height, std::uint8_t grey) {
  return {width, height, Rgba8{grey, grey, grey, 255}};
}

float red(const Texture& texture, Vec2 uv, float footprint = 0.0F, Wrap wrap = Wrap::Repeat) {
  return texture.sample(uv, footprint, wrap, wrap).x;
}

TEST(Texture, TexelCentresReadExactlyTheirTexel) {
  Plane<Rgba8> pixels = filled(4, 2, 0);
  pixels(2, 1) = {255, 51, 0, 128};
  const Texture texture(pixels, ColorSpace::Linear);
  const Vec4 value = texture.sample({2.5F / 4.0F, 1.5F / 2.0F}, 0.0F, Wrap::Repeat, Wrap::Repeat);
  EXPECT_FLOAT_EQ(value.x, 1.0F);
  EXPECT_FLOAT_EQ(value.y, 0.2F);
  EXPECT_FLOAT_EQ(value.w, 128.0F / 255.0F);
}

// Half black, half white is linear 0.5; averaging the stored codes would give 0.214.
TEST(Texture, SrgbIsDecodedBeforeItIsAveraged) {
  Plane<Rgba8> pixels = filled(2, 2, 0);
  pixels(0, 0) = pixels(1, 1) = {255, 255, 255, 255};
  const Texture texture(pixels, ColorSpace::Srgb);
  EXPECT_NEAR(red(texture, {0.3F, 0.6F}, 1.0F), 0.5F, 4e-3F);
  EXPECT_FLOAT_EQ(texture.mean().x, 0.5F);
}

TEST(Texture, EveryLevelKeepsTheMeanOfAnOddSizedImage) {
  Plane<Rgba8> pixels = filled(7, 5, 0);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const auto grey = static_cast<std::uint8_t>((x * 53 + y * 97) % 256);
      pixels(x, y) = {grey, grey, grey, 255};
    }
  }
  const Texture texture(pixels, ColorSpace::Linear);
  EXPECT_EQ(texture.level_count(), 3);  // 7x5, 3x2, 1x1
  EXPECT_NEAR(red(texture, {0.1F, 0.9F}, 100.0F), texture.mean().x, 1.0F / 255.0F);
}

TEST(Texture, AFootprintBetweenTwoLevelsBlendsThem) {
  Plane<Rgba8> pixels = filled(2, 2, 0);
  pixels(0, 0) = {255, 255, 255, 255};
  const Texture texture(pixels, ColorSpace::Linear);
  const Vec2 centre{0.25F, 0.25F};
  const float fine = red(texture, centre), coarse = red(texture, centre, 1.0F);
  const float between = red(texture, centre, std::sqrt(2.0F) / 2.0F);
  EXPECT_NEAR(between, 0.5F * (fine + coarse), 1e-5F);
}

TEST(Texture, WrapModesDifferOnlyOutside) {
  Plane<Rgba8> pixels = filled(2, 1, 0);
  pixels(1, 0) = {255, 255, 255, 255};
  const Texture texture(pixels, ColorSpace::Linear);
  for (const Wrap wrap : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
    EXPECT_FLOAT_EQ(red(texture, {0.75F, 0.5F}, 0.0F, wrap), 1.0F);
  }
  EXPECT_FLOAT_EQ(red(texture, {1.25F, 0.5F}, 0.0F, Wrap::Repeat), 0.0F);
  EXPECT_FLOAT_EQ(red(texture, {1.25F, 0.5F}, 0.0F, Wrap::Clamp), 1.0F);
  EXPECT_FLOAT_EQ(red(texture, {1.25F, 0.5F}, 0.0F, Wrap::Mirror), 1.0F);
  EXPECT_FLOAT_EQ(red(texture, {-0.25F, 0.5F}, 0.0F, Wrap::Repeat), 1.0F);
  EXPECT_FLOAT_EQ(red(texture, {-0.25F, 0.5F}, 0.0F, Wrap::Mirror), 0.0F);
}

TEST(Texture, NonFiniteCoordinatesAndFootprintsReadSomethingFinite) {
  const Texture texture(filled(4, 4, 51), ColorSpace::Linear);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_FLOAT_EQ(red(texture, {nan, inf}), 0.2F);
  EXPECT_FLOAT_EQ(red(texture, {0.5F, 0.5F}, nan), 0.2F);
  EXPECT_FLOAT_EQ(red(texture, {0.5F, 0.5F}, inf), 0.2F);
}

TEST(Texture, AnEmptyImageReadsAsWhite) {
  const Texture texture(Plane<Rgba8>{}, ColorSpace::Srgb);
  EXPECT_FLOAT_EQ(red(texture, {0.5F, 0.5F}), 1.0F);
}

TEST(TransformUv, ScalesThenRotatesThenOffsets) {
  scene::TextureRef reference;
  reference.uv_offset = {0.5F, 0.0F};
  reference.uv_scale = {2.0F, 1.0F};
  reference.uv_rotation_rad = std::numbers::pi_v<float> / 2.0F;
  const Vec2 uv = transform_uv(reference, {1.0F, 0.0F});
  EXPECT_NEAR(uv.x, 0.5F, 1e-6F);
  EXPECT_NEAR(uv.y, -2.0F, 1e-6F);
}

}  // namespace
}  // namespace macula::shading
