#include "shared/metrics/foveated.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "shared/metrics/error.h"
#include "tests/shared/metrics/formula_images.h"

namespace macula::metrics {
namespace {

using test::picture;
using test::rnd;

constexpr int kSide = 256;
constexpr double kPpd = 4.0;

GazedView centre_view() {
  return GazedView::centred(kSide, kSide, kPpd);
}
GazedView corner_view() {
  GazedView view = centre_view();
  view.gaze_px = {40.0, 40.0};
  return view;
}
double degrees_from_centre(int x, int y) {
  return Degrees{centre_view().eccentricity({x + 0.5, y + 0.5})}.value();
}

float wave_at(int x, int y) {
  constexpr float kCycle = 2.0F * std::numbers::pi_v<float> / 16.0F;
  return 0.5F + 0.25F * std::sin(kCycle * static_cast<float>(x)) *
                    std::cos(kCycle * static_cast<float>(y));
}
Plane<Rgb> wave() {
  return picture(kSide, kSide, [](int x, int y) { return Rgb{wave_at(x, y)}; });
}
/// The wave with noise wherever where(eccentricity in degrees).
template <class Where>
Plane<Rgb> noisy_wave(Where where) {
  return picture(kSide, kSide, [&](int x, int y) {
    const float noise = 0.1F * (rnd(static_cast<std::uint32_t>(y * kSide + x)) - 0.5F);
    return Rgb{wave_at(x, y) + (where(degrees_from_centre(x, y)) ? noise : 0.0F)};
  });
}
Plane<Rgb> outer_noise() {
  return noisy_wave([](double e) { return e > 15.0; });
}

struct Expected {
  double psnr, ew, gp, gp_flat;
};
void expect_db(const char* name, const Plane<Rgb>& test, const GazedView& view, Expected expected) {
  SCOPED_TRACE(name);
  constexpr double kTolerance = 2e-4;  // dB: the table has four decimals
  EXPECT_NEAR(psnr_db(wave(), test), expected.psnr, kTolerance);
  EXPECT_NEAR(ew_psnr_db(wave(), test, view), expected.ew, kTolerance);
  EXPECT_NEAR(gp_psnr_db(wave(), test, view), expected.gp, kTolerance);
  EXPECT_NEAR(gp_psnr_db(wave(), test, view, Sensitivity::Flat), expected.gp_flat, kTolerance);
}

// Known answers of an independent implementation.
TEST(FoveatedMetrics, HaveTheKnownAnswersForNoise) {
  expect_db("everywhere", noisy_wave([](double) { return true; }), centre_view(),
            {30.7713, 30.7619, 42.9353, 30.9899});
  expect_db("e > 15", outer_noise(), centre_view(), {31.6302, 35.8129, 47.2767, 31.8468});
  expect_db("e < 5", noisy_wave([](double e) { return e < 5.0; }), centre_view(),
            {47.7473, 35.1642, 50.3878, 47.9618});
  expect_db("gaze on the noise", outer_noise(), corner_view(),
            {31.6302, 31.0700, 44.2699, 31.8468});
}

TEST(FoveatedMetrics, HaveTheKnownAnswersForOffsetAndShift) {
  const auto offset =
      picture(kSide, kSide, [](int x, int y) { return Rgb{wave_at(x, y) + 0.02F}; });
  const auto shift =
      picture(kSide, kSide, [](int x, int y) { return Rgb{wave_at(std::max(x - 1, 0), y)}; });
  expect_db("offset", offset, centre_view(), {33.9794, 33.9794, 34.4148, 33.9794});
  expect_db("shift", shift, centre_view(), {26.2692, 26.1449, 33.1569, 28.1359});
}

TEST(FoveatedMetrics, AreBestForIdenticalPictures) {
  EXPECT_EQ(ew_psnr_db(wave(), wave(), centre_view()), kBestDb);
  EXPECT_EQ(gp_psnr_db(wave(), wave(), centre_view()), kBestDb);
}

TEST(FoveatedMetrics, NeverRiseWhenTheGazeMovesOntoTheError) {
  const auto noise = outer_noise();
  EXPECT_LT(ew_psnr_db(wave(), noise, corner_view()), ew_psnr_db(wave(), noise, centre_view()));
  EXPECT_LT(gp_psnr_db(wave(), noise, corner_view()), gp_psnr_db(wave(), noise, centre_view()));
}

// 2.3 ln 64 / (.106 (e + 2.3)).
TEST(FoveatedMetrics, CutoffFallsFromThirtyNineCyclesPerDegree) {
  EXPECT_NEAR(cutoff_cpd(Degrees{0.0}), 39.2, 0.05);
  EXPECT_NEAR(cutoff_cpd(Degrees{10.0}), 7.3, 0.05);
  EXPECT_NEAR(cutoff_cpd(Degrees{20.0}), 4.0, 0.05);
  EXPECT_NEAR(cutoff_cpd(Degrees{40.0}), 2.1, 0.05);
  EXPECT_EQ(contrast_sensitivity(7.4, Degrees{10.0}), 0.0);
  EXPECT_EQ(contrast_sensitivity(20.0, Degrees{0.0}), 1.0);
}

TEST(FoveatedMetrics, AcuityWeightIsOneAtTheGazeAndNeverRises) {
  EXPECT_EQ(acuity_weight(Degrees{0.0}), 1.0);
  // 1 / (1 + 48 * .022 * 10)^2.
  EXPECT_NEAR(acuity_weight(Degrees{10.0}), 1.0 / (11.56 * 11.56), 1e-12);
  for (double e = 0.0; e < 90.0; e += 0.5) {
    EXPECT_GT(acuity_weight(Degrees{e}), acuity_weight(Degrees{e + 0.5}));
  }
}

TEST(FoveatedMetrics, WidePicturesWeighPixelsBySolidAngle) {
  // 16 px a side at focal length 4: the half axis spans 63 degrees. At focal length 64 it spans 7.
  const GazedView wide{4.0, {8.0, 8.0}, {8.0, 8.0}}, narrow{64.0, {8.0, 8.0}, {8.0, 8.0}};
  const DVec2 corner{0.5, 0.5};
  EXPECT_NEAR(acuity_weights(wide, 16, 16)(0, 0),
              acuity_weight(wide.eccentricity(corner)) * std::pow(wide.axis_cosine(corner), 3.0),
              1e-9);
  EXPECT_NEAR(acuity_weights(narrow, 16, 16)(0, 0), acuity_weight(narrow.eccentricity(corner)),
              1e-7);
}

TEST(FoveatedMetrics, WeightedMeanOfACroppedMapLeavesTheBorderOut) {
  Plane<float> weights(12, 12, 100.0F);
  weights(5, 5) = 1.0F;
  weights(6, 5) = 3.0F;
  weights(5, 6) = weights(6, 6) = 0.0F;
  Plane<float> values(2, 2, 7.0F);
  values(0, 0) = 0.0F;
  values(1, 0) = 1.0F;
  EXPECT_NEAR(weighted_mean(values, weights), 0.75, 1e-12);
}

TEST(FoveatedMetrics, EccentricityIsAnAngleAndNotAPixelDistance) {
  // 229.18 px focal length: 229.18 px to the side are 45 degrees.
  const GazedView view = centre_view();
  EXPECT_NEAR(Degrees{view.eccentricity({128.0 + view.focal_px, 128.0})}.value(), 45.0, 1e-9);
  EXPECT_NEAR(view.pixels_per_degree(), kPpd, 1e-12);
}

}  // namespace
}  // namespace macula::metrics
