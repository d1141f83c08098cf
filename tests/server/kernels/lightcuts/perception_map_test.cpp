// T-FPSM: what a perception map may and may not do, with the printed form as the twin that fails.
#include "server/kernels/lightcuts/perception_map.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

using enum PerceptionMode;
constexpr PerceptionMode kModes[] = {Printed, Difference, Attenuation, Stengel};
constexpr PerceptionMode kLocalModes[] = {Difference, Attenuation, Stengel};
constexpr int kWidth = 40, kHeight = 32;

/// Planes of one view to be spoilt.
struct Planes {
  Plane<float> acuity{kWidth, kHeight};
  Plane<Vec3> normal{kWidth, kHeight, Vec3{0, 0, 1}};
  Plane<Rgb> albedo{kWidth, kHeight, Rgb{0.5F}};
  Plane<float> speed{kWidth, kHeight};
  Plane<float> luminance{kWidth / 8, kHeight / 8, 0.5F};

  PerceptionMap map(PerceptionMode mode, float alpha = 0.05F) const {
    return make_perception_map({acuity, normal, albedo, speed, luminance},
                               {.mode = mode, .alpha = alpha, .gamma = 1.4F, .contrast = 1.0F});
  }
};

/// A gaze in the middle, a corner of a room, a checker on the floor, a spot of light.
Planes room() {
  Planes planes;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double e = 0.03 * std::hypot(x - 20.0, y - 16.0);
      planes.acuity(x, y) = static_cast<float>(std::clamp(1.1715 - 2.45 * e, 0.02, 1.0));
      if (x > 30) planes.normal(x, y) = {1, 0, 0};
      if (y > 24) planes.albedo(x, y) = Rgb{(x / 4 + y / 4) % 2 == 0 ? 0.2F : 0.8F};
    }
  }
  planes.luminance(1, 1) = 0.6F;
  return planes;
}

std::vector<std::function<void(Planes&)>> spoilers() {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto fill = [](float value) {
    return [value](Planes& p) {
      for (auto* plane : {&p.acuity, &p.speed, &p.luminance}) {
        for (float& each : plane->pixels()) each = value;
      }
      for (Vec3& each : p.normal.pixels()) each = Vec3{value};
      for (Rgb& each : p.albedo.pixels()) each = Rgb{value};
    };
  };
  const auto one = [](float value) {
    return [value](Planes& p) {
      p.acuity(3, 3) = p.speed(9, 4) = p.luminance(2, 2) = value;
      p.normal(20, 20).y = p.albedo(5, 30).x = value;
    };
  };
  const auto checker = [](Planes& p) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) p.acuity(x, y) = static_cast<float>((x + y) % 2);
    }
  };
  return {[](Planes&) {}, fill(0.0F),  fill(1.0F), fill(1e30F),   checker,
          one(1e30F),     one(-1e30F), one(kNan),  one(kInfinity)};
}

TEST(PerceptionMap, IsANumberFromZeroToOneWhateverComes) {
  for (const PerceptionMode mode : kModes) {
    for (const float alpha : {-1.0F, 0.0F, 0.05F, 0.4F, 1.0F, 2.0F}) {
      for (const auto& spoil : spoilers()) {
        Planes planes = room();
        spoil(planes);
        const PerceptionMap made = planes.map(mode, alpha);
        for (const auto* plane : {&made.map, &made.spatial, &made.luminance}) {
          ASSERT_EQ(plane->size(), std::size_t{kWidth * kHeight});
          for (const float value : plane->pixels()) ASSERT_TRUE(value >= 0.0F && value <= 1.0F);
        }
      }
    }
  }
}

TEST(PerceptionMap, CountsWhatIsNoNumber) {
  Planes planes = room();
  EXPECT_EQ(planes.map(Stengel).not_finite, 0U);
  planes.normal(4, 4).x = std::nanf("");
  planes.luminance(0, 0) = INFINITY;
  EXPECT_EQ(planes.map(Stengel).not_finite, 2U);
}

TEST(PerceptionMap, EmptyPlanesAreFeaturesLeftOut) {
  const Planes planes = room();
  const Plane<float> none;
  const Plane<Vec3> nothing;
  const auto made =
      make_perception_map({planes.acuity, nothing, nothing, none, none}, {Stengel, 0.05F});
  for (std::size_t i = 0; i < made.map.size(); ++i) {
    EXPECT_EQ(made.map.pixels()[i], planes.acuity.pixels()[i]);
  }
}

TEST(PerceptionMap, RaisingAFeatureNeverLowersAShareRaisingAlphaNeverRaisesIt) {
  for (const PerceptionMode mode : kLocalModes) {
    for (int a = -2; a <= 24; ++a) {
      const PerceptionConfig config{mode, 0.05F * static_cast<float>(a)};
      const PerceptionConfig later{mode, 0.05F * static_cast<float>(a + 1)};
      float before = 0.0F;
      for (int m = 0; m <= 200; ++m) {
        const float feature = static_cast<float>(m) / 200.0F;
        const float share = share_of_samples(feature, config);
        ASSERT_GE(share, before);
        ASSERT_LE(share_of_samples(feature, later), share);
        before = share;
      }
    }
  }
}

/// The note's figures: full acuity at alpha 0.1 keeps 49 % of the samples; the width that is full
/// rate belongs to alpha / M = 1 / 40.
TEST(PerceptionMap, AttenuationIsTheWidestGaussianThatTakesAlphaAway) {
  EXPECT_NEAR(share_of_samples(1.0F, {Attenuation, 0.1F, 1.0F}), 0.49F, 0.005F);
  EXPECT_NEAR(share_of_samples(1.0F, {Attenuation, 0.025F, 1.0F}), 1.0F, 1e-5F);
  EXPECT_EQ(share_of_samples(0.1F, {Attenuation, 0.1F}), 0.0F);
  EXPECT_EQ(share_of_samples(0.1F, {Attenuation, 0.0F}), 1.0F);
  for (const float alpha : {0.05F, 0.2F}) {
    for (const float m : {0.3F, 0.9F}) {
      const float share = share_of_samples(m, {Attenuation, alpha, 1.0F});
      const double rho = std::sqrt(-2.0 * std::log(0.975)) / static_cast<double>(share);
      EXPECT_NEAR(m - m * std::exp(-0.5 * rho * rho), alpha, 1e-5);
    }
  }
}

/// Speckles of a low-resolution picture in even light, and the edge of a shadow four times as dark.
TEST(PerceptionMap, NoiseOfTheLowResolutionPictureIsNoContrastAShadowIs) {
  Planes planes;
  planes.luminance = Plane<float>(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto cell = static_cast<std::uint64_t>(y * kWidth + x);
      const float noise = math::unit_float(math::hash_combine(5, cell));
      const float speckle = math::unit_float(math::hash_combine(6, cell)) < 0.04F ? 8.0F : 1.0F;
      planes.luminance(x, y) = (x < 20 ? 0.4F : 0.1F) * (0.7F + 0.6F * noise) * speckle;
    }
  }
  const Plane<float> contrast = planes.map(Stengel).luminance;
  float flat = 0.0F, edge = 0.0F;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 4; x < 14; ++x) flat += contrast(x, y) / (10.0F * kHeight);
    edge += std::max(contrast(19, y), contrast(20, y)) / kHeight;
  }
  EXPECT_LT(flat, 0.06F);
  EXPECT_GT(edge, 4.0F * flat);
}

/// Pixels that differ by more than rounding.
int changed(const Planes& one, const Planes& other, PerceptionMode mode, int margin) {
  const Plane<float> a = one.map(mode).map, b = other.map(mode).map;
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool far = std::abs(x - 8) > margin || std::abs(y - 8) > margin;
      count += far && std::abs(a(x, y) - b(x, y)) > 1e-5F;
    }
  }
  return count;
}

TEST(PerceptionMap, OnePixelChangesItsNeighbourhoodAloneButNotInThePrintedForm) {
  const auto spoilt = [](Planes planes) {
    planes.albedo(8, 8) = Rgb{1.0F};
    planes.normal(8, 8) = {0, 1, 0};
    return planes;
  };
  const Planes before = room(), after = spoilt(before);
  for (const PerceptionMode mode : kLocalModes) {
    EXPECT_EQ(changed(before, after, mode, 1), 0);
    EXPECT_GT(changed(before, after, mode, -1), 0);
  }
  Planes plain;
  plain.acuity = before.acuity;
  for (Rgb& each : plain.albedo.pixels()) each = Rgb{0.0F};
  EXPECT_GT(changed(plain, spoilt(plain), Printed, 4), 20) << "the printed form couples the frame";
}

TEST(PerceptionMap, EdgesGetMoreThanFlatsButNotInThePrintedForm) {
  Planes planes = room();
  for (float& value : planes.acuity.pixels()) value = 0.3F;
  const auto edge_over_flat = [&](PerceptionMode mode) {
    const Plane<float> map = planes.map(mode).map;
    float edge = 0.0F, flat = 0.0F;
    for (int y = 14; y < 20; ++y) edge += map(30, y) + map(31, y), flat += map(36, y) + map(37, y);
    return edge / flat;
  };
  for (const PerceptionMode mode : kLocalModes) EXPECT_GT(edge_over_flat(mode), 1.5F);
  EXPECT_LT(edge_over_flat(Printed), 1.0F);
}

TEST(NodeCounts, MeetTheMeanThatWasWantedAndStayWithinTheirBounds) {
  const Planes planes = room();
  for (const PerceptionMode mode : kModes) {
    const Plane<float> map = planes.map(mode).map;
    for (const double wanted : {1.5, 4.0, 12.0, 30.0}) {
      const NodeCounts counts = node_counts(map, {48}, wanted);
      double sum = 0.0;
      for (const std::uint16_t n : counts.nodes.pixels()) {
        ASSERT_GE(n, 1);
        ASSERT_LE(n, 48);
        sum += n;
      }
      EXPECT_NEAR(counts.mean, sum / (kWidth * kHeight), 1e-9);
      // Pixels of equal shares take their steps together.
      if (mode != Printed) {
        EXPECT_NEAR(counts.mean, wanted, 0.15 * wanted);
      }
    }
  }
  const NodeCounts printed = node_counts(planes.map(Stengel).map, {48});
  EXPECT_EQ(printed.nodes(20, 16), 48);
  EXPECT_EQ(node_counts(Plane<float>(4, 4, 0.0F), {48}, 10.0).mean, 1.0);
  EXPECT_EQ(node_counts(Plane<float>(4, 4, 0.0F), {48, 3}, 10.0).mean, 3.0);
}

}  // namespace
}  // namespace macula::kernels::lightcuts
