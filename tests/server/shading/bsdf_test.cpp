#include "server/shading/bsdf.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "server/shading/ggx.h"
#include "server/shading/phong.h"
#include "shared/math/hash.h"

namespace macula::shading {
namespace {

const Vec3 kNormal{0.0F, 0.0F, 1.0F};

Vec3 direction(float cosine, float phi) {
  const float sine = std::sqrt(std::max(0.0F, 1.0F - cosine * cosine));
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

Reflector seen_from(const Bsdf& bsdf, const Vec3& to_eye) {
  return Reflector(bsdf, make_shading_frame(kNormal, kNormal, to_eye));
}

Vec3 random_3d(std::uint64_t index) {
  return {math::unit_float(math::hash_combine(index, 0)),
          math::unit_float(math::hash_combine(index, 1)),
          math::unit_float(math::hash_combine(index, 2))};
}

/// Share of a uniform environment reflected to the eye, by sampling.
Rgb measured_reflectance(const Reflector& reflector, int count) {
  DVec3 sum{0.0};
  for (int i = 0; i < count; ++i) {
    const auto sample = reflector.sample(random_3d(static_cast<std::uint64_t>(i)));
    if (sample) sum += DVec3(sample->weight);
  }
  return Rgb(sum / static_cast<double>(count));
}

Bsdf plastic(float alpha) {
  return {Rgb{1.0F}, Rgb{0.04F}, 1.0F, alpha};
}

TEST(Bsdf, WhiteLambertReturnsExactlyAllLight) {
  const Reflector reflector = seen_from({Rgb{1.0F}}, direction(0.3F, 1.0F));
  EXPECT_EQ(reflector.reflectance(), Rgb{1.0F});
  for (const float cosine : {0.05F, 0.5F, 1.0F}) {
    EXPECT_FLOAT_EQ(reflector.evaluate(direction(cosine, 2.0F)).x, cosine / kPi);
  }
  const auto sample = reflector.sample({0.7F, 0.3F, 0.6F});
  ASSERT_TRUE(sample);
  EXPECT_NEAR(sample->weight.x, 1.0F, 1e-5F);
}

TEST(Bsdf, DiffuseAndLobeTogetherNeverReflectMoreThanTheyReceive) {
  for (const float alpha : {0.01F, 0.1F, 0.3F, 0.7F, 1.0F}) {
    for (const float cosine : {0.03F, 0.2F, 0.6F, 1.0F}) {
      const Reflector reflector = seen_from(plastic(alpha), direction(cosine, 0.4F));
      EXPECT_LE(reflector.reflectance().x, 1.0F + 1e-6F);
      // 3e-3: interpolation of the albedo table; 4 sigma of 16384 weights below 1 are less.
      EXPECT_LE(measured_reflectance(reflector, 16384).x, 1.0F + 6e-3F)
          << "alpha " << alpha << " cosine " << cosine;
    }
  }
}

// The naive mix, albedo / pi (1 - F) + lobe, must break the rule that the one above keeps.
TEST(Bsdf, UncompensatedDiffuseUnderALobeGainsEnergyAtGrazingAngles) {
  const Reflector with_lobe =
      seen_from({Rgb{0.0F}, Rgb{0.04F}, 1.0F, 0.1F}, direction(0.03F, 0.4F));
  const Reflector diffuse = seen_from({Rgb{1.0F}}, direction(0.03F, 0.4F));
  EXPECT_GT(measured_reflectance(with_lobe, 16384).x + 0.95F * diffuse.reflectance().x, 1.1F);
}

TEST(Bsdf, StatedReflectanceIsTheIntegral) {
  for (const float alpha : {0.05F, 0.4F, 1.0F}) {
    const Bsdf bsdf{Rgb{0.5F, 0.3F, 0.1F}, Rgb{0.04F, 0.3F, 0.9F}, 1.0F, alpha};
    const Reflector reflector = seen_from(bsdf, direction(0.5F, 0.0F));
    const Rgb measured = measured_reflectance(reflector, 65536);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(measured[c], reflector.reflectance()[c], 0.01F);
  }
}

void expect_reciprocal(const Bsdf& bsdf) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec3 u = random_3d(i), w = random_3d(i + 1000);
    const Vec3 a = direction(0.05F + 0.95F * u.x, 6.0F * u.y);
    const Vec3 b = direction(0.05F + 0.95F * w.x, 6.0F * w.y);
    const Rgb there = seen_from(bsdf, a).evaluate(b) / b.z;
    const Rgb back = seen_from(bsdf, b).evaluate(a) / a.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 1e-4F * (1.0F + there[c]));
  }
}

TEST(Bsdf, SwappingEyeAndLightChangesNothing) {
  expect_reciprocal({Rgb{0.6F, 0.4F, 0.2F}, Rgb{0.04F, 0.2F, 0.8F}, 1.0F, 0.3F});
}

TEST(Bsdf, DensityOfSamplesIntegratesToOneOverTheSphere) {
  for (const float alpha : {0.15F, 0.5F, 1.0F}) {
    const Reflector reflector =
        seen_from({Rgb{0.4F}, Rgb{0.3F}, 1.0F, alpha}, direction(0.4F, 0.3F));
    constexpr int kRows = 800, kColumns = 800;
    double sum = 0.0;
    for (int row = 0; row < kRows; ++row) {
      const float cosine = -1.0F + 2.0F * (static_cast<float>(row) + 0.5F) / kRows;
      for (int column = 0; column < kColumns; ++column) {
        const float phi = 2.0F * kPi * (static_cast<float>(column) + 0.5F) / kColumns;
        sum += reflector.pdf(direction(cosine, phi));
      }
    }
    EXPECT_NEAR(sum * 4.0 * std::numbers::pi / (kRows * kColumns), 1.0, 5e-3) << "alpha " << alpha;
  }
}

constexpr int kCosineBins = 8, kPhiBins = 16;

std::size_t bin_of(const Vec3& d) {
  const float turn = (std::atan2(d.y, d.x) / kPi + 1.0F) * 0.5F;
  const int column = std::min(static_cast<int>(turn * kPhiBins), kPhiBins - 1);
  const int row = std::min(static_cast<int>(d.z * kCosineBins), kCosineBins - 1);
  return static_cast<std::size_t>(row * kPhiBins + column);
}

/// Chi-square of samples of `sampled` against the density of `stated`, over the upper hemisphere,
/// divided by its degrees of freedom.
double chi_square_ratio(const Reflector& sampled, const Reflector& stated, int count) {
  std::vector<double> expected(kCosineBins * kPhiBins), seen(expected.size());
  constexpr int kFine = 24;
  for (int row = 0; row < kCosineBins * kFine; ++row) {
    for (int column = 0; column < kPhiBins * kFine; ++column) {
      const Vec3 d =
          direction((static_cast<float>(row) + 0.5F) / (kCosineBins * kFine),
                    kPi * (2.0F * (static_cast<float>(column) + 0.5F) / (kPhiBins * kFine) - 1.0F));
      expected[bin_of(d)] +=
          stated.pdf(d) * 2.0 * std::numbers::pi * count / (kCosineBins * kPhiBins * kFine * kFine);
    }
  }
  for (int i = 0; i < count; ++i) {
    const auto sample = sampled.sample(random_3d(static_cast<std::uint64_t>(i) + 77));
    if (sample) seen[bin_of(sample->to_light)] += 1.0;
  }
  double chi_square = 0.0;
  int bins = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (expected[i] < 10.0) continue;
    chi_square += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
    ++bins;
  }
  return chi_square / bins;
}

// With ~128 bins the ratio has mean 1 and standard deviation sqrt(2 / 128) = 0.125.
TEST(Bsdf, SamplesFollowTheirDensity) {
  const Vec3 eye = direction(0.5F, 0.9F);
  const Reflector reflector = seen_from({Rgb{0.5F}, Rgb{0.5F}, 1.0F, 0.4F}, eye);
  EXPECT_LT(chi_square_ratio(reflector, reflector, 60000), 1.6);
  const Reflector wider = seen_from({Rgb{0.5F}, Rgb{0.5F}, 1.0F, 0.45F}, eye);
  EXPECT_GT(chi_square_ratio(wider, reflector, 60000), 2.0);
}

// ---- Phong's lobe ----

Bsdf phong(const Rgb& albedo, const Rgb& f0, float alpha) {
  return {albedo, f0, 0.0F, alpha, LobeModel::Phong};
}

TEST(PhongLobe, HeadOnItReflectsAllThatItsColourSaysAndElsewhereNoMore) {
  for (const float alpha : {0.02F, 0.2F, 0.6F, 1.0F}) {
    const Bsdf bsdf = phong(Rgb{0.8F}, Rgb{0.5F}, alpha);
    const Reflector head_on = seen_from(bsdf, kNormal);
    EXPECT_NEAR(measured_reflectance(head_on, 65536).x, head_on.reflectance().x, 0.01F) << alpha;
    for (const float cosine : {0.03F, 0.3F, 0.7F}) {
      const Reflector slanted = seen_from(bsdf, direction(cosine, 0.4F));
      EXPECT_LE(measured_reflectance(slanted, 16384).x, slanted.reflectance().x + 6e-3F)
          << "alpha " << alpha << " cosine " << cosine;
    }
  }
}

// Phong's own factor, (n + 1) / (2 pi), is that of a density: a surface would lose light.
TEST(PhongLobe, ScaledAsADensityItWouldLoseLight) {
  const float exponent = phong_exponent(0.6F);
  const Reflector head_on = seen_from(phong(Rgb{0.0F}, Rgb{1.0F}, 0.6F), kNormal);
  const float kept = (exponent + 1.0F) / (exponent + 2.0F);
  EXPECT_LT(kept * measured_reflectance(head_on, 65536).x, 0.95F);
}

TEST(PhongLobe, SwappingEyeAndLightChangesNothing) {
  expect_reciprocal(phong(Rgb{0.6F, 0.4F, 0.2F}, Rgb{0.04F, 0.2F, 0.8F}, 0.3F));
}

TEST(PhongLobe, SamplesFollowTheirDensity) {
  const Vec3 eye = direction(0.5F, 0.9F);
  const Reflector reflector = seen_from(phong(Rgb{0.5F}, Rgb{0.5F}, 0.4F), eye);
  EXPECT_LT(chi_square_ratio(reflector, reflector, 60000), 1.6);
  const Reflector wider = seen_from(phong(Rgb{0.5F}, Rgb{0.5F}, 0.45F), eye);
  EXPECT_GT(chi_square_ratio(wider, reflector, 60000), 2.0);
}

/// Greatest relative error of `power` over a sharp lobe, against double precision.
template <typename Power>
double worst_of_sharp_lobe(const Power& power) {
  const float exponent = phong_exponent(kLeastAlpha);
  const Vec3 axis = glm::normalize(Vec3(0.3F, -0.7F, 0.6F));
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Vec3 away = 2.0F * kLeastAlpha * (2.0F * random_3d(i) - 1.0F);
    const Vec3 towards = glm::normalize(axis + away);
    const DVec3 a = glm::normalize(DVec3(axis)), b = glm::normalize(DVec3(towards));
    const double truth = std::pow(glm::dot(a, b), static_cast<double>(exponent));
    worst = std::max(worst, std::abs(power(axis, towards, exponent) / truth - 1.0));
  }
  return worst;
}
TEST(PhongLobe, TheSharpestKeepsItsShapeInSinglePrecision) {
  EXPECT_LT(worst_of_sharp_lobe(phong_power), 2e-3);
}
TEST(PhongLobe, ByItsCosineTheSharpestWouldNot) {
  const auto by_cosine = [](const Vec3& a, const Vec3& b, float exponent) {
    return std::pow(std::min(glm::dot(a, b), 1.0F), exponent);
  };
  EXPECT_GT(worst_of_sharp_lobe(by_cosine), 2e-2);
}

TEST(ShadingFrame, LightFromBehindTheSurfaceNeverLeaksThroughABentNormal) {
  const Vec3 bent = glm::normalize(Vec3(0.8F, 0.0F, 0.6F));
  const ShadingFrame frame = make_shading_frame(kNormal, bent, direction(0.9F, 0.0F));
  const Reflector reflector({Rgb{1.0F}, Rgb{0.04F}, 1.0F, 0.3F}, frame);
  const Vec3 below = glm::normalize(Vec3(1.0F, 0.0F, -0.1F));
  ASSERT_GT(glm::dot(bent, below), 0.0F);
  EXPECT_EQ(reflector.evaluate(below), Rgb{0.0F});
}

TEST(ShadingFrame, AnEyeBelowTheShadingHorizonStillSeesLight) {
  const Vec3 bent = glm::normalize(Vec3(0.9F, 0.0F, 0.3F));
  const Vec3 eye = direction(0.2F, kPi);
  ASSERT_LT(glm::dot(bent, eye), 0.0F);
  const ShadingFrame frame = make_shading_frame(kNormal, bent, eye);
  EXPECT_GT(glm::dot(frame.shading, eye), 0.0F);
  EXPECT_GT(Reflector({Rgb{1.0F}}, frame).evaluate(kNormal).x, 0.0F);
}

TEST(ShadingFrame, BothNormalsTurnTowardsTheEye) {
  const ShadingFrame frame = make_shading_frame(-kNormal, -kNormal, direction(0.5F, 0.0F));
  EXPECT_EQ(frame.geometric, kNormal);
  EXPECT_EQ(frame.shading, kNormal);
}

}  // namespace
}  // namespace macula::shading
