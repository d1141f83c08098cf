#include "server/lights/environment_light.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "server/sampling/mappings.h"
#include "shared/math/hash.h"

namespace macula::lights {
namespace {

constexpr double kPi = std::numbers::pi;

float random(std::uint64_t dimension, int i) {
  return math::unit_float(math::hash_combine(dimension, static_cast<std::uint64_t>(i)));
}

/// A dim sky with a hot texel near the horizon; every texel of another brightness.
scene::Environment sky(int width, int height) {
  scene::Environment environment;
  environment.radiance = image::Plane<Rgb>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      environment.radiance(x, y) = Rgb{0.05F + 0.4F * random(7, y * width + x)};
    }
  }
  environment.radiance(width / 5, height / 2) = Rgb{900.0F, 700.0F, 400.0F};
  return environment;
}

TEST(EnvironmentLight, TheMiddleLooksDownMinusZAndYawTurnsItToTheLeft) {
  scene::Environment environment;
  environment.radiance = image::Plane<Rgb>(64, 32);
  environment.radiance(32, 15) = environment.radiance(32, 16) = Rgb{1.0F};  // right of the middle
  const auto at = [&](const Vec3& d) { return EnvironmentLight(environment).radiance(d).x; };
  const float right = std::sin(0.05F);
  EXPECT_GT(at(glm::normalize(Vec3{right, 0, -1})), 0.5F);
  EXPECT_EQ(at({-1, 0, 0}), 0.0F);
  environment.yaw = Degrees{90.0};
  EXPECT_GT(at(glm::normalize(Vec3{-1, 0, -right})), 0.5F);
  EXPECT_EQ(at({0, 0, -1}), 0.0F);
  environment.yaw = Degrees{0.0};
  environment.scale = 3.0F;
  EXPECT_GT(at(glm::normalize(Vec3{right, 0, -1})), 1.5F);
}

TEST(EnvironmentLight, DensityOfASampleIsThatOfItsDirectionAndSumsToOne) {
  // 64 x 32 has a cell a texel; 2500 x 900 blocks of 3 with narrower ones at the ends.
  for (const auto& [width, height] : {std::pair{64, 32}, std::pair{2500, 900}}) {
    scene::Environment environment = sky(width, height);
    environment.yaw = Degrees{37.0};
    const EnvironmentLight light(environment);
    constexpr int kSamples = 4000;
    int disagreeing = 0;
    for (int i = 0; i < kSamples; ++i) {
      const EnvironmentSample sample = light.sample({random(1, i), random(2, i)});
      EXPECT_NEAR(glm::length(sample.to_light), 1.0F, 1e-5F);
      // A float direction at the edge of a cell may fall into its neighbour.
      disagreeing += std::abs(light.pdf(sample.to_light) / sample.pdf - 1.0F) > 1e-3F;
    }
    EXPECT_LT(disagreeing, kSamples / 100);
    double sum = 0.0;
    constexpr int kDirections = 200'000;
    for (int i = 0; i < kDirections; ++i) {
      // Beside the hot texel the density is bounded, which keeps this mean's error small.
      const Vec3 d = sampling::uniform_sphere({random(3, i), random(4, i)});
      sum += std::min(light.pdf(d), 1.0F) * 4.0 * kPi / kDirections;
    }
    EXPECT_LT(sum, 1.0) << "density outside the hot texel is less than all of it";
  }
}

/// Irradiance on an upward plane: by the table, and over all texels of the picture.
struct Irradiance {
  double sampled = 0.0, standard_error = 0.0, summed = 0.0;
};
Irradiance irradiance(const scene::Environment& environment, double bias = 1.0) {
  const EnvironmentLight light(environment);
  Irradiance result;
  constexpr int kSamples = 40'000;
  double square = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const EnvironmentSample sample = light.sample({random(5, i), random(6, i)});
    const double value =
        bias * light.radiance(sample.to_light).y * std::max(sample.to_light.y, 0.0F) / sample.pdf;
    result.sampled += value / kSamples;
    square += value * value / kSamples;
  }
  result.standard_error = std::sqrt((square - result.sampled * result.sampled) / kSamples);
  constexpr int kRows = 1024;
  for (int y = 0; y < kRows; ++y) {
    const double theta = kPi * (y + 0.5) / kRows;
    for (int x = 0; x < 2 * kRows; ++x) {
      const double phi = kPi * (x + 0.5) / kRows;
      const Vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta),
                   std::sin(theta) * std::sin(phi));
      result.summed +=
          light.radiance(d).y * std::max(d.y, 0.0F) * std::sin(theta) * kPi / kRows * kPi / kRows;
    }
  }
  return result;
}

TEST(EnvironmentLight, SampledIrradianceIsThePicturesOwn) {
  for (const auto& [width, height] : {std::pair{64, 32}, std::pair{1500, 700}}) {
    const Irradiance fair = irradiance(sky(width, height));
    EXPECT_NEAR(fair.sampled, fair.summed, 4.0 * fair.standard_error + 2e-3 * fair.summed);
    const Irradiance biased = irradiance(sky(width, height), 1.1);
    EXPECT_GT(std::abs(biased.sampled - biased.summed),
              4.0 * biased.standard_error + 2e-3 * biased.summed)
        << "a 10 % bias must be seen";
  }
}

TEST(EnvironmentLight, AConstantOneIsUniformAndABlackOneAnswers) {
  scene::Environment environment;
  environment.radiance(0, 0) = {1.0F, 2.0F, 3.0F};
  environment.scale = 2.0F;
  const EnvironmentLight light(environment);
  EXPECT_TRUE(light.is_constant());
  EXPECT_EQ(light.radiance({0, 1, 0}), Rgb(2.0F, 4.0F, 6.0F));
  EXPECT_FLOAT_EQ(light.pdf({0, 1, 0}), static_cast<float>(1.0 / (4.0 * kPi)));

  scene::Environment black;
  black.radiance = image::Plane<Rgb>(16, 8);
  const EnvironmentSample sample = EnvironmentLight(black).sample({0.999999F, 0.0F});
  EXPECT_GT(sample.pdf, 0.0F);
  EXPECT_TRUE(math::is_finite(sample.to_light));
}

}  // namespace
}  // namespace macula::lights
