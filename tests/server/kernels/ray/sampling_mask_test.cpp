#include "server/kernels/ray/sampling_mask.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/foveation/eccentricity.h"

namespace macula::kernels::ray {
namespace {

foveation::Display display(int side) {
  return {math::symmetric_fov(Degrees{90.0}, 1.0), side, side};
}
foveation::RateModel model(double r0, double r1, double p_min) {
  return {foveation::RateCurve::Ray, Degrees{r0}, Degrees{r1}, p_min};
}

struct Drawn {
  std::size_t traced = 0;
  double expected = 0.0;  ///< sum of p
};

/// What chance draws in a number of frames.
Drawn draw(const foveation::RateModel& rate, MaskKind kind, int frames) {
  const auto screen = display(256);
  const PixelGrid grid = foveation::make_uniform_grid(screen);
  const FoveationMap map({{grid, {}, screen.pixel_tangent()}}, rate);
  const Probability probability(map.view(0), rate);
  FoveatedConfig config;
  config.mask = kind;
  TileScheduler scheduler(1);
  Drawn drawn;
  std::vector<float> p(grid.width());
  for (int y = 0; y < grid.height(); ++y) {
    probability.row(y, p);
    for (const float value : p) drawn.expected += value;
  }
  const Support support(grid, 4.61F);
  for (int frame = 0; frame < frames; ++frame) {
    SamplingMask mask(support, grid.width(), grid.height());
    mask.choose(probability, static_cast<std::uint64_t>(frame), 1, config, scheduler);
    drawn.traced += mask.counts().chance;
  }
  drawn.expected *= frames;
  return drawn;
}

TEST(SamplingMask, TheShareTracedIsTheIntegralOfTheProbability) {
  for (const auto& rate : {model(5, 10, 0.01), model(10, 20, 0.05), model(15, 30, 0.1)}) {
    const Drawn even = draw(rate, MaskKind::BlueNoise, 32);
    EXPECT_NEAR(static_cast<double>(even.traced), even.expected, 0.01 * even.expected);
    const Drawn independent = draw(rate, MaskKind::Independent, 8);
    // The variance of a sum of Bernoulli draws is at most its mean.
    EXPECT_NEAR(static_cast<double>(independent.traced), independent.expected,
                4.0 * std::sqrt(independent.expected));
    const double biased = 1.05 * even.expected;
    EXPECT_GT(std::abs(static_cast<double>(even.traced) - biased), 0.01 * biased)
        << "five percent too many must be seen";
  }
}

TEST(SamplingMask, EveryCellOfTheFoveaIsTraced) {
  const auto screen = display(200);
  const PixelGrid grid = foveation::make_uniform_grid(screen);
  const auto rate = model(10, 20, 0.05);
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3(0.3F, -0.2F, -1.0F));
  const FoveationMap map({{grid, gaze, screen.pixel_tangent()}}, rate);
  const Probability probability(map.view(0), rate);
  const Support support(grid, 4.61F);
  SamplingMask mask(support, grid.width(), grid.height());
  TileScheduler scheduler(2);
  mask.choose(probability, 7, 1, {}, scheduler);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      const Radians e = foveation::eccentricity(gaze.direction, grid.ray(x, y));
      if (Degrees{e}.value() <= 10.0) {
        EXPECT_TRUE(mask.traced(x, y)) << x << ' ' << y;
      }
      if (support.chosen(x, y)) {
        EXPECT_TRUE(mask.traced(x, y)) << x << ' ' << y;
      }
    }
  }
}

// ALGORITHMS 4.3: a step at r0 = r1, no fovea at r0 = 0, everything beyond 180 degrees.
TEST(SamplingMask, RegionsAtTheirExtremesStayDefined) {
  const auto screen = display(64);
  const PixelGrid grid = foveation::make_uniform_grid(screen);
  std::vector<float> p(grid.width());
  const auto at_middle_and_rim = [&](const foveation::RateModel& rate) {
    const FoveationMap map({{grid, {}, screen.pixel_tangent()}}, rate);
    const Probability probability(map.view(0), rate);
    probability.row(32, p);
    return Vec2{p[32], p[0]};
  };
  EXPECT_EQ(at_middle_and_rim(model(10, 10, 0.05)), Vec2(1.0F, 0.05F));
  EXPECT_LE(at_middle_and_rim(model(0, 20, 0.05)).x, 1.0F);
  EXPECT_FLOAT_EQ(at_middle_and_rim(model(0, 20, 0.05)).y, 0.05F);
  EXPECT_EQ(at_middle_and_rim(model(200, 300, 0.5)), Vec2(1.0F, 1.0F));
  EXPECT_LT(at_middle_and_rim(model(5, 10, 0.0)).y, 1e-3F);
  EXPECT_EQ(at_middle_and_rim(model(5, 10, 7.0)), Vec2(1.0F, 1.0F));
}

TEST(SamplingMask, ResamplingStaysWithinItsBudgetAndPrefersTheForgotten) {
  const auto screen = display(256);
  const PixelGrid grid = foveation::make_uniform_grid(screen);
  const auto rate = model(10, 20, 0.05);
  const FoveationMap map({{grid, {}, screen.pixel_tangent()}}, rate);
  const Probability probability(map.view(0), rate);
  const Support support(grid, 4.61F);
  Cache cache;
  prepare_cache(cache, grid.width(), grid.height(), false, 0);
  for (float& depth : cache.inverse_depth.pixels()) depth = 1.0F;
  TileScheduler scheduler(2);
  FoveatedConfig config;
  SamplingMask mask(support, grid.width(), grid.height());
  mask.choose(probability, 3, 1, config, scheduler);
  const Plane<float> everything(support.broken.width(), support.broken.height(), 2.0F);
  std::vector<image::Pixel> forgotten;
  for (int x = 0; x < 20; ++x) {
    cache.inverse_depth(x, 5) = Cache::kNothing;
    if (!mask.traced(x, 5)) forgotten.push_back({x, 5});
  }
  mask.resample(forgotten, cache, everything, 3, config, scheduler);
  const auto& counts = mask.counts();
  const double chosen = static_cast<double>(mask.chosen().size());
  const double share =
      static_cast<double>(counts.resampled) / (static_cast<double>(counts.resampled) + chosen);
  EXPECT_LE(share, config.most_resampled);
  for (int x = 0; x < 20; ++x) EXPECT_TRUE(mask.traced(x, 5)) << x;
}

}  // namespace
}  // namespace macula::kernels::ray
