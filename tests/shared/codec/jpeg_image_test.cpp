#include "shared/codec/jpeg_image.h"

#include <gtest/gtest.h>

#include <string>

#include "shared/codec/color.h"
#include "tests/shared/codec/damage.h"

namespace macula::codec {
namespace {

using image::Plane;

Bytes jpeg_of(const Plane<Rgb8>& picture) {
  return *encode_color(picture, picture.rect(), {});
}

TEST(JpegImage, TakesItsSizeFromTheHeader) {
  const auto picture = decode_jpeg_image(jpeg_of(Plane<Rgb8>(37, 21, Rgb8{90, 90, 90})), "a.jpg");
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_EQ(picture->rect(), (image::Rect{0, 0, 37, 21}));
  for (const Rgb8 pixel : picture->pixels()) EXPECT_NEAR(pixel.g, 90, 2);
}

TEST(JpegImage, SizesBeyondTheLimitAreRefusedByName) {
  const auto bytes = jpeg_of(Plane<Rgb8>(40, 10));
  EXPECT_TRUE(decode_jpeg_image(bytes, "a.jpg", 40));
  const auto refused = decode_jpeg_image(bytes, "a.jpg", 39);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "a.jpg");
  EXPECT_NE(refused.error().message().find("40 x 10"), std::string::npos);
}

TEST(JpegImage, DamageIsAnErrorOrAPictureWithinTheLimit) {
  const auto bytes = jpeg_of(Plane<Rgb8>(24, 24, Rgb8{200, 40, 90}));
  const auto decodes = [](std::span<const std::byte> damaged) {
    const auto picture = decode_jpeg_image(damaged, "damaged.jpg", 64);
    if (!picture) return false;
    EXPECT_LE(picture->width(), 64);
    EXPECT_LE(picture->height(), 64);
    return true;
  };
  EXPECT_LE(truncate_everywhere(bytes, decodes).accepted, 4);  // the end marker may be missing
  EXPECT_GT(flip_bits(bytes, 10'000, 12, decodes).refused, 0);
}

}  // namespace
}  // namespace macula::codec
