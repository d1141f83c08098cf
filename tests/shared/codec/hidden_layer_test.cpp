#include "shared/codec/hidden_layer.h"

#include <gtest/gtest.h>

#include <limits>

#include "shared/codec/tiles.h"
#include "shared/math/hash.h"
#include "tests/shared/codec/damage.h"

namespace macula::codec {
namespace {

using image::Plane;

/// A ring of about `width` cells around a disc: what a band looks like.
Mask ring(int columns, int rows, double radius, double width) {
  Mask mask(columns, rows);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const double r = std::hypot(x - 0.5 * columns, y - 0.5 * rows);
      mask(x, y) = r <= radius && r > radius - width ? 1 : 0;
    }
  }
  return mask;
}

Mask noise(int columns, int rows) {
  Mask mask(columns, rows);
  for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = math::hash_mix(i) & 1U;
  return mask;
}

template <class T>
bool same(const Plane<T>& a, const Plane<T>& b) {
  return std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin(), b.pixels().end());
}

TEST(BandMask, ComesBackToTheBitAtAnySize) {
  for (const auto& mask :
       {ring(200, 150, 60, 7), noise(37, 5), noise(1, 1), Mask(9, 9), Mask(8, 3, 1)}) {
    Mask back(mask.width(), mask.height());
    ASSERT_TRUE(decode_mask(encode_mask(mask), back));
    EXPECT_TRUE(same(mask, back)) << mask.width() << " x " << mask.height();
  }
}

TEST(BandMask, OfARingTakesLittle) {
  EXPECT_LT(encode_mask(ring(600, 600, 200, 8)).size(), 3000U);
}

TEST(BandMask, RefusesDamageAndOtherSizes) {
  const auto bytes = encode_mask(ring(100, 80, 30, 5));
  Mask back(100, 80), other(80, 100);
  EXPECT_FALSE(decode_mask(bytes, other));
  EXPECT_EQ(
      truncate_everywhere(bytes, [&](auto some) { return decode_mask(some, back).has_value(); })
          .accepted,
      0);
}

TEST(Tiles, PackTheTilesOfAMaskAndNoOthers) {
  const Mask mask = ring(100, 70, 20, 3);  // 7 x 5 tiles, the last ones cut
  const Tiles tiles(mask);
  EXPECT_GT(tiles.count(), 4U);
  EXPECT_LT(tiles.count(), 35U);
  EXPECT_EQ(tiles.width() % Tiles::kSide, 0);
  Plane<float> numbers(100, 70), back(100, 70, -1.0F);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers.data()[i] = static_cast<float>(i);
  tiles.unpack(tiles.packed(numbers), back);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (mask.data()[i] != 0) {
      EXPECT_EQ(back.data()[i], numbers.data()[i]);
    }
    if (back.data()[i] >= 0.0F) ++kept;
  }
  EXPECT_LE(kept, tiles.count() * Tiles::kSide * Tiles::kSide);
}

TEST(Tiles, OfAnEmptyMaskAreNone) {
  EXPECT_TRUE(Tiles(Mask(50, 50)).empty());
  EXPECT_EQ(atlas_rect(Mask(50, 50)).height, 0);
}

TEST(Tiles, AreFilledFromTheMask) {
  Mask mask(32, 16);
  mask(3, 5) = mask(20, 9) = 1;
  Plane<float> values(32, 16);
  values(3, 5) = 7.0F;
  values(20, 9) = 8.0F;
  const Tiles tiles(mask);
  Plane<float> atlas = tiles.packed(values);
  fill_tiles(tiles.packed(mask), atlas);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) EXPECT_EQ(atlas(x, y), x < 16 ? 7.0F : 8.0F);
  }
}

/// A wall that leans away, coloured smoothly.
struct Wall {
  Plane<Rgb8> color{300, 200};
  Plane<float> depth_m{300, 200};
  Wall() {
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 300; ++x) {
        color(x, y) = {static_cast<std::uint8_t>(x / 2), static_cast<std::uint8_t>(y), 90};
        depth_m(x, y) = 1.0F / (0.25F + 0.0005F * static_cast<float>(x));
      }
    }
  }
};

TEST(HiddenLayerCodec, BringsColourAndDepthBackWithinTheMask) {
  const Wall wall;
  const Mask mask = ring(300, 200, 70, 9);
  ColorOptions options;
  options.codec = ColorCodec::Lossless;
  const auto coded = encode_hidden_layer(mask, wall.color, wall.depth_m, options);
  ASSERT_TRUE(coded);
  const image::Rect rect = atlas_rect(mask);
  Plane<Rgb8> atlas(rect.width, rect.height), color(300, 200);
  ASSERT_TRUE(decode_color(coded->color, ColorCodec::Lossless, rect, atlas));
  unpack_atlas(mask, atlas, color);
  Plane<float> inverse(300, 200);
  ASSERT_TRUE(decode_depth(coded->depth.bytes, coded->depth.inverse_scale_per_m, inverse));
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (mask(x, y) == 0) continue;
      EXPECT_EQ(color(x, y), wall.color(x, y));
      // Samples beside the band hold what its nearest cell has: half a tile of .0005 / m a cell.
      EXPECT_NEAR(inverse(x, y), 1.0F / wall.depth_m(x, y), 0.0041F) << x << ", " << y;
    }
  }
}

TEST(HiddenLayerCodec, TakesBytesForTheMaskAlone) {
  const Wall wall;
  ColorOptions options;
  const auto narrow = encode_hidden_layer(ring(300, 200, 70, 9), wall.color, wall.depth_m, options);
  const auto whole = encode_hidden_layer(Mask(300, 200, 1), wall.color, wall.depth_m, options);
  ASSERT_TRUE(narrow && whole);
  EXPECT_LT(2 * narrow->color.size(), whole->color.size());
}

}  // namespace
}  // namespace macula::codec
