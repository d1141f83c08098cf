// Batches against their scalar oracles, at every count that leaves a tail.
#include "server/sampling/batch.h"

#include <gtest/gtest.h>

#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"
#include "server/sampling/sobol.h"

namespace macula::sampling {
namespace {

Vec2 random_2d(std::size_t i) {
  return sample_2d(SampleKey(5, 0, i), 0);
}

TEST(Batch, SobolPointsHaveTheBitsOfSingleOnes) {
  ScramblingBatch sequences{};
  for (std::uint32_t i = 0; i < kBatch; ++i) sequences.set(i, Scrambling(i * i));
  for (const std::uint32_t index : {0U, 1U, 2U, 3U, 17U, 1000U, 0x80000001U, 0xFFFFFFFFU}) {
    for (const std::size_t count : {1U, 7U, 8U, 255U, 256U}) {
      Vec2Batch points{};
      sobol_owen_2d(index, sequences, count, points);
      for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_EQ(points[i], sobol_owen_2d(index, i * i)) << "index " << index << ", item " << i;
      }
    }
  }
}

TEST(Batch, CosineDirectionsAreThoseOfTheHemisphereInTheNormalsFrame) {
  Vec2Batch u{};
  Vec3Batch normals{}, directions{};
  for (std::size_t i = 0; i < kBatch; ++i) {
    u.x[i] = random_2d(i).x, u.y[i] = random_2d(i).y;
    normals.set(i, uniform_sphere(random_2d(i + 1000)));
  }
  u.x[0] = u.y[0] = 0.5F;  // the middle of the disk
  normals.set(1, {0.0F, 0.0F, -1.0F});
  cosine_directions(u, normals, normals, kBatch, directions);
  for (std::size_t i = 0; i < kBatch; ++i) {
    const Vec3 wanted = frame_from_normal(normals[i]) * cosine_hemisphere(u[i]);
    // Near the horizon the height is the root of a small difference: sqrt(2^-23) at worst.
    EXPECT_LT(glm::distance(directions[i], wanted), 1e-3F) << i;
    EXPECT_NEAR(glm::length(directions[i]), 1.0F, 1e-5F);
    EXPECT_GE(glm::dot(directions[i], normals[i]), -1e-6F);
  }
}

TEST(Batch, DirectionsBehindTheirSideAreMirroredToItsFront) {
  Vec2Batch u{};
  Vec3Batch normals{}, sides{}, directions{};
  const Vec3 tilted = glm::normalize(Vec3(1.0F, 0.2F, 0.1F));
  for (std::size_t i = 0; i < kBatch; ++i) {
    u.x[i] = random_2d(i).x, u.y[i] = random_2d(i).y;
    normals.set(i, tilted);
    sides.set(i, {0.0F, 0.0F, 1.0F});
  }
  cosine_directions(u, normals, sides, kBatch, directions);
  int mirrored = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    const Vec3 plain = frame_from_normal(tilted) * cosine_hemisphere(u[i]);
    EXPECT_NEAR(directions[i].z, std::abs(plain.z), 1e-3F);
    EXPECT_NEAR(directions[i].x, plain.x, 1e-3F);
    mirrored += plain.z < 0.0F ? 1 : 0;
  }
  EXPECT_GT(mirrored, 50);
}

}  // namespace
}  // namespace macula::sampling
