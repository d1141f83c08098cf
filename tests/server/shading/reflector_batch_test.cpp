#include "server/shading/reflector_batch.h"

#include <gtest/gtest.h>

#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"

namespace macula::shading {
namespace {

using sampling::kBatch;
using sampling::Vec3Batch;

struct Random {
  sampling::SampleKey key;
  Vec3 direction(std::uint32_t d) const {
    return sampling::uniform_sphere(sampling::sample_2d(key, d));
  }
  Rgb color(std::uint32_t d) const {
    return {sampling::sample(key, d), sampling::sample(key, d + 1), sampling::sample(key, d + 2)};
  }
};

/// A third has no lobe. Sharper lobes than 0.1 turn one unit in the last place of the half vector
/// into more than the tolerance near their peak, in either function.
Bsdf some_bsdf(std::size_t i, const Random& random, LobeModel lobe) {
  if (i % 3 == 0) return {random.color(10)};
  const float u = sampling::sample(random.key, 20);
  const float f90 = lobe == LobeModel::Phong ? 0.0F : 1.0F;
  return {random.color(10), random.color(13), f90, 0.1F + 0.9F * u, lobe};
}

Reflector some_reflector(std::size_t i, const Random& random, LobeModel lobe = LobeModel::Ggx) {
  const Vec3 normal = random.direction(0);
  const Vec3 bent = glm::normalize(normal + 0.3F * random.direction(2));
  return {some_bsdf(i, random, lobe), make_shading_frame(normal, bent, random.direction(4))};
}

class ReflectorBatchOf : public testing::TestWithParam<LobeModel> {};

TEST_P(ReflectorBatchOf, ItsLobeReflectsWhatEveryReflectorAloneReflects) {
  int lit = 0, dark = 0;
  for (std::uint64_t round = 0; round < 40; ++round) {
    ReflectorBatch batch{};
    Vec3Batch to_light{}, irradiance{}, reflected{};
    std::vector<Rgb> wanted;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Random random{{7, round, i}};
      const Reflector reflector = some_reflector(i, random, GetParam());
      batch.set(i, reflector);
      to_light.set(i, random.direction(6));
      irradiance.set(i, i % 5 == 0 ? Rgb{0.0F} : 3.0F * random.color(30));
      wanted.push_back(reflector.evaluate(to_light[i]) * irradiance[i]);
    }
    reflect(batch, to_light, irradiance, kBatch, reflected);
    for (std::size_t i = 0; i < kBatch; ++i) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(reflected[i][c], wanted[i][c], 1e-5F + 2e-4F * wanted[i][c])
            << "round " << round << ", item " << i;
      }
      ++(wanted[i].x > 0.0F ? lit : dark);
    }
  }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(dark, 1000);
}

INSTANTIATE_TEST_SUITE_P(Lobes, ReflectorBatchOf, testing::Values(LobeModel::Ggx, LobeModel::Phong),
                         [](const auto& tested) {
                           return tested.param == LobeModel::Ggx ? "Ggx" : "Phong";
                         });

TEST(ReflectorBatch, AnItemsBitsDoNotDependOnItsPlace) {
  ReflectorBatch batch{};
  Vec3Batch to_light{}, irradiance{}, reflected{};
  const auto put = [&](std::size_t place, std::size_t item) {
    const Random random{{8, 0, item}};
    batch.set(place, some_reflector(item, random));
    to_light.set(place, glm::normalize(batch.shading[place] + 0.5F * random.direction(6)));
    irradiance.set(place, random.color(30));
  };
  for (std::size_t i = 0; i < kBatch; ++i) put(i, i);
  reflect(batch, to_light, irradiance, kBatch, reflected);
  const Vec3Batch before = reflected;
  for (std::size_t i = 0; i < kBatch; ++i) put(i, kBatch - 1 - i);
  reflect(batch, to_light, irradiance, kBatch, reflected);
  for (std::size_t i = 0; i < kBatch; ++i) EXPECT_EQ(reflected[i], before[kBatch - 1 - i]);
}

}  // namespace
}  // namespace macula::shading
