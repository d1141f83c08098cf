#include "server/sampling/mappings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "server/sampling/sample.h"
#include "tests/server/sampling/chi_square.h"

namespace macula::sampling {
namespace {

using test::chi_square_excess;
using test::kDefect;
constexpr int kDraws = 200'000;
constexpr double kPi = std::numbers::pi;

double azimuth(double y, double x) {  // in [0, 1)
  return std::min(std::atan2(y, x) / (2.0 * kPi) + 0.5, 0x1.fffffep-1);
}
double unit(double x) {
  return std::clamp(x, 0.0, 0x1.fffffep-1);
}

/// Excess of the samples of `map` after `flatten` has carried them back to what should be uniform.
template <class Map, class Flatten>
double excess(Map&& map, Flatten&& flatten) {
  return chi_square_excess(test::count_on_square(kDraws, [&](int i) {
    return flatten(map(sample_2d(SampleKey(11, 0, static_cast<std::uint64_t>(i)), 0)));
  }));
}

// On a uniform disk r^2 and the azimuth are independent and uniform.
DVec2 flat_disk(const Vec2& p) {
  return {unit(static_cast<double>(p.x) * p.x + static_cast<double>(p.y) * p.y), azimuth(p.y, p.x)};
}
// Under pdf cos/pi, P(cos theta < z) = z^2; under a uniform sphere (Archimedes), z is uniform.
DVec2 flat_cosine(const Vec3& d) {
  return {unit(static_cast<double>(d.z) * d.z), azimuth(d.y, d.x)};
}
DVec2 flat_hemisphere(const Vec3& d) {
  return {unit(d.z), azimuth(d.y, d.x)};
}
DVec2 flat_sphere(const Vec3& d) {
  return {unit(0.5 * d.z + 0.5), azimuth(d.y, d.x)};
}
// In a uniform triangle, with s = b1 + b2: P(sum < s) = s^2, and b1 / s is uniform given s.
DVec2 flat_triangle(const Vec2& b) {
  const double sum = static_cast<double>(b.x) + b.y;
  return {unit(sum * sum), sum > 0.0 ? unit(b.x / sum) : 0.0};
}

TEST(Mappings, DiskIsUniformAndAnUncorrectedRadiusIsNot) {
  EXPECT_LT(excess(uniform_disk, flat_disk), kDefect);
  const auto wrong = [](const Vec2& u) {
    const float phi = 2.0F * static_cast<float>(kPi) * u.y;
    return u.x * Vec2{std::cos(phi), std::sin(phi)};  // r = u crowds the centre
  };
  EXPECT_GT(excess(wrong, flat_disk), kDefect);
}

TEST(Mappings, CosineHemisphereFollowsTheCosineAndAUniformOneDoesNot) {
  EXPECT_LT(excess(cosine_hemisphere, flat_cosine), kDefect);
  EXPECT_GT(excess(uniform_hemisphere, flat_cosine), kDefect);
}

TEST(Mappings, HemisphereAndSphereAreUniform) {
  EXPECT_LT(excess(uniform_hemisphere, flat_hemisphere), kDefect);
  EXPECT_LT(excess(uniform_sphere, flat_sphere), kDefect);
  EXPECT_GT(excess(cosine_hemisphere, flat_hemisphere), kDefect);
}

TEST(Mappings, TriangleIsUniformAndASkewedOneIsNot) {
  EXPECT_LT(excess(uniform_triangle, flat_triangle), kDefect);
  const auto wrong = [](const Vec2& u) { return Vec2{u.x, u.y * (1.0F - u.x)}; };
  EXPECT_GT(excess(wrong, flat_triangle), kDefect);
}

TEST(Mappings, StayInsideTheirDomainsAtTheCornersOfTheSquare) {
  constexpr float kLast = 1.0F - 0x1p-24F;
  for (const float x : {0.0F, 0.5F, kLast}) {
    for (const float y : {0.0F, 0.5F, kLast}) {
      const Vec2 u{x, y}, disk = uniform_disk(u), b = uniform_triangle(u);
      EXPECT_LE(glm::dot(disk, disk), 1.0F + 1e-6F);
      EXPECT_GE(b.x, 0.0F);
      EXPECT_GE(b.y, 0.0F);
      EXPECT_LE(b.x + b.y, 1.0F);
      for (const Vec3 d : {cosine_hemisphere(u), uniform_hemisphere(u), uniform_sphere(u)}) {
        EXPECT_NEAR(glm::length(d), 1.0F, 1e-6F);
      }
      EXPECT_GE(cosine_hemisphere(u).z, 0.0F);
    }
  }
}

TEST(Mappings, CosineWeightedMeanOfTheNormalComponentIsTwoThirds) {
  // Integral of cos * cos / pi over the hemisphere = 2/3; variance 1/2 - 4/9 = 1/18.
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    sum += cosine_hemisphere(sample_2d(SampleKey(2, 0, static_cast<std::uint64_t>(i)), 0)).z;
  }
  EXPECT_NEAR(sum / kDraws, 2.0 / 3.0, 5.0 * std::sqrt(1.0 / 18.0 / kDraws));
}

}  // namespace
}  // namespace macula::sampling
