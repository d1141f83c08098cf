#include "shared/metrics/error.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/shared/metrics/formula_images.h"

namespace macula::metrics {
namespace {

using test::constant;
using test::picture;

TEST(Error, AConstantOffsetHasItsSquareAsMse) {
  EXPECT_NEAR(mse(constant(0.5F), constant(0.75F)), 0.0625, 1e-12);
  EXPECT_NEAR(rmse(constant(0.5F), constant(0.75F)), 0.25, 1e-12);
}

TEST(Error, ADifferenceInOneChannelCountsAThird) {
  EXPECT_NEAR(mse(constant(Rgb{0.0F}), constant(Rgb{0.0F, 3.0F, 0.0F})), 3.0, 1e-12);
}

TEST(Error, RelativeMseDividesByTheReferenceSquared) {
  // (1.1 - 1)^2 / (1 + .01) for every pixel; ten times brighter leaves nearly the same relative
  // error.
  EXPECT_NEAR(relative_mse(constant(1.0F), constant(1.1F)), 0.01 / 1.01, 1e-8);
  EXPECT_NEAR(relative_mse(constant(10.0F), constant(11.0F)), 1.0 / 100.01, 1e-8);
  EXPECT_NEAR(relative_mse(constant(0.0F), constant(0.1F)), 1.0, 1e-6) << "epsilon rules the dark";
}

TEST(Error, PsnrOfATwentiethIsTwentySixDecibels) {
  EXPECT_NEAR(psnr_db(constant(0.5F), constant(0.55F)), -20.0 * std::log10(0.05), 1e-5);
}

TEST(Error, PsnrIsCappedForIdenticalPicturesAndSymmetric) {
  const auto ramp = picture(test::ramp_at);
  EXPECT_EQ(psnr_db(ramp, ramp), kBestDb);
  EXPECT_EQ(psnr_db(ramp, constant(0.5F)), psnr_db(constant(0.5F), ramp));
  EXPECT_EQ(db_from_mse(1e-30), kBestDb);
}

TEST(Error, PsnrKnowsItsPeak) {
  EXPECT_NEAR(db_from_mse(400.0, 255.0), 22.110204, 1e-6);
  EXPECT_NEAR(db_from_mse(3547.2266, 255.0), 12.631914, 1e-6);
}

TEST(Error, ANanInAPictureIsNotSwallowed) {
  auto broken = constant(0.5F);
  broken(3, 4).y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(mse(constant(0.5F), broken)));
  EXPECT_TRUE(std::isnan(relative_mse(broken, constant(0.5F))));
  EXPECT_TRUE(std::isnan(psnr_db(constant(0.5F), broken)));
}

TEST(Error, LumaWeighsGreyAsItIs) {
  EXPECT_NEAR(luma(constant(0.25F))(5, 5), 0.25F, 1e-7F);
  EXPECT_NEAR(luma(constant(Rgb{0.0F, 1.0F, 0.0F}))(0, 0), 0.587F, 1e-7F);
}

TEST(Error, EightBitsBecomeTheUnitInterval) {
  const auto unit = unit_from_8bit(Plane<Rgb8>(2, 1, Rgb8{0, 51, 255}));
  EXPECT_EQ(unit(1, 0).x, 0.0F);
  EXPECT_NEAR(unit(1, 0).y, 0.2F, 1e-7F);
  EXPECT_EQ(unit(1, 0).z, 1.0F);
}

}  // namespace
}  // namespace macula::metrics
