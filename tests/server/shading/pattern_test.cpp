#include "server/shading/pattern.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/math/hash.h"

namespace macula::shading {
namespace {

using scene::Pattern;
using scene::PatternKind;

constexpr PatternKind kKinds[] = {PatternKind::Checker, PatternKind::Bricks, PatternKind::Stripes,
                                  PatternKind::Noise};

Pattern pattern(PatternKind kind, float size_m = 0.5F) {
  return {kind, Rgb{0.0F}, size_m};
}

float random(int i) {
  return math::unit_float(math::hash_mix(static_cast<std::uint64_t>(i)));
}
Vec3 random_place(int i) {
  return 6.0F * Vec3{random(3 * i), random(3 * i + 1), random(3 * i + 2)} - 3.0F;
}

/// Mean of the unfiltered pattern over the square of `width` around a point of the floor.
float mean_over_floor(const Pattern& p, const Vec3& centre, float width) {
  constexpr int kSide = 64;
  double sum = 0.0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Vec2 share = (Vec2{static_cast<float>(i), static_cast<float>(j)} + 0.5F) / 64.0F - 0.5F;
      const Vec3 at = centre + width * Vec3{share.x, 0.0F, share.y};
      sum += second_share(p, {at, {0.0F, 1.0F, 0.0F}, Vec3{0.0F}});
    }
  }
  return static_cast<float>(sum / (kSide * kSide));
}

TEST(Pattern, ACheckerAlternatesOverSquaresOfItsSize) {
  const Pattern p = pattern(PatternKind::Checker);
  const Vec3 up{0.0F, 1.0F, 0.0F};
  EXPECT_EQ(second_share(p, {{0.1F, 9.0F, 0.1F}, up, Vec3{0.0F}}), 0.0F);
  EXPECT_EQ(second_share(p, {{0.6F, 9.0F, 0.1F}, up, Vec3{0.0F}}), 1.0F);
  EXPECT_EQ(second_share(p, {{0.6F, 9.0F, -0.1F}, up, Vec3{0.0F}}), 0.0F);
  EXPECT_EQ(second_share(p, {{-0.1F, 9.0F, 0.1F}, up, Vec3{0.0F}}), 1.0F);
}

TEST(Pattern, AFilteredCheckerIsTheMeanOfItsSquare) {
  const Pattern p = pattern(PatternKind::Checker);
  for (int i = 0; i < 40; ++i) {
    const Vec3 at = random_place(i);
    const float width = 0.05F + 1.7F * random(1000 + i);
    const float own = second_share(p, {at, {0.0F, 1.0F, 0.0F}, Vec3{width}});
    // 64 x 64 points resolve an edge to 1/64 of the width on either axis.
    EXPECT_NEAR(own, mean_over_floor(p, at, width), 2.5F / 64.0F) << "width " << width;
  }
}

TEST(Pattern, AnUnfilteredAnswerFailsThatTest) {
  const Pattern p = pattern(PatternKind::Checker);
  int wrong = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 at = random_place(i);
    const float own = second_share(p, {at, {0.0F, 1.0F, 0.0F}, Vec3{0.0F}});
    wrong += std::abs(own - mean_over_floor(p, at, 0.8F)) > 2.5F / 64.0F;
  }
  EXPECT_GT(wrong, 30);
}

TEST(Pattern, FarAwayEveryPatternIsItsMean) {
  for (const PatternKind kind : kKinds) {
    const Pattern p = pattern(kind);
    const float here = second_share(p, {random_place(1), {0.0F, 1.0F, 0.0F}, Vec3{200.0F}});
    const float there = second_share(p, {random_place(2), {0.0F, 1.0F, 0.0F}, Vec3{200.0F}});
    EXPECT_NEAR(here, there, 0.01F);
    EXPECT_GT(here, 0.05F);
    EXPECT_LT(here, 0.95F);
  }
}

TEST(Pattern, IsAShareEverywhereAndFinite) {
  for (const PatternKind kind : kKinds) {
    for (int i = 0; i < 500; ++i) {
      const Vec3 place = (i % 3 == 0 ? 1e5F : 1.0F) * random_place(i);
      const Vec3 normal = glm::normalize(random_place(i + 7) + Vec3{0.01F});
      const float share = second_share(pattern(kind), {place, normal, Vec3{random(i) * 2.0F}});
      EXPECT_GE(share, 0.0F);
      EXPECT_LE(share, 1.0F);
    }
  }
}

TEST(Pattern, ScalesWithItsSize) {
  for (const PatternKind kind : kKinds) {
    for (int i = 0; i < 50; ++i) {
      const Vec3 at = random_place(i), normal{0.0F, 0.0F, 1.0F};
      EXPECT_NEAR(second_share(pattern(kind, 0.5F), {at, normal, Vec3{0.1F}}),
                  second_share(pattern(kind, 2.0F), {4.0F * at, normal, Vec3{0.4F}}), 1e-4F);
    }
  }
}

/// Points of floors, walls and slopes near and far, of sharp and of wide footprints.
struct Batch {
  sampling::Vec3Batch position{}, normal{}, footprint{};
  explicit Batch(int seed) {
    for (int i = 0; i < static_cast<int>(sampling::kBatch); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int key = 1000 * seed + i;
      position.set(at, (i % 5 == 0 ? 1e3F : 1.0F) * random_place(key));
      normal.set(at, glm::normalize(random_place(key + 7) + Vec3{0.01F}));
      footprint.set(at, Vec3{i % 7 == 0 ? 0.0F : 2.0F * random(key) * random(key + 3)});
    }
  }
};

TEST(Pattern, VectorsShowWhatEveryPointAloneShows) {
  for (const PatternKind kind : kKinds) {
    int apart = 0, count = 0;
    for (int seed = 0; seed < 8; ++seed) {
      const Batch batch(seed);
      sampling::FloatBatch shares{};
      second_shares(pattern(kind),
                    {batch.position, batch.normal, batch.footprint, sampling::kBatch}, shares);
      for (std::size_t i = 0; i < sampling::kBatch; ++i, ++count) {
        const float alone =
            second_share(pattern(kind), {batch.position[i], batch.normal[i], batch.footprint[i]});
        // A point on an edge may fall to either side of it.
        apart += std::abs(shares.at[i] - alone) > 1e-5F;
      }
    }
    EXPECT_LE(apart, count / 200) << "kind " << static_cast<int>(kind);
  }
}

TEST(Pattern, VectorsOfAnotherSizeFailThatTest) {
  for (const PatternKind kind : kKinds) {
    const Batch batch(0);
    sampling::FloatBatch shares{};
    second_shares(pattern(kind, 0.51F),
                  {batch.position, batch.normal, batch.footprint, sampling::kBatch}, shares);
    int apart = 0;
    for (std::size_t i = 0; i < sampling::kBatch; ++i) {
      const float alone =
          second_share(pattern(kind), {batch.position[i], batch.normal[i], batch.footprint[i]});
      apart += std::abs(shares.at[i] - alone) > 1e-5F;
    }
    EXPECT_GT(apart, 20) << "kind " << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace macula::shading
