#include "server/reconstruction/light_memory.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace macula::reconstruction {
namespace {

constexpr int kSide = 48;
constexpr float kStep = 0.02F;  ///< of the grid, tangents

/// Linear light of a wall 4 m ahead, by place in meters and frame.
using Light = std::function<float(const Vec2& place, int frame)>;

/// A wall at z = -4 seen from z = 0, the eye moved `right_m`.
LightMemory seen_from(float right_m, int frame, const Light& light, float samples = 1.0F) {
  LightMemory now;
  now.world_from_view.position = {static_cast<double>(right_m), 0.0, 0.0};
  for (int i = 0; i <= kSide; ++i)
    now.grid.x_edges.push_back(kStep * static_cast<float>(i - kSide / 2));
  now.grid.y_edges = now.grid.x_edges;
  now.surfaces.resize(kSide, kSide), now.mean.resize(kSide, kSide);
  now.fresh.resize(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3 at = 4.0F * now.grid.ray(x, y) + Vec3{right_m, 0.0F, 0.0F};
      now.surfaces.x.row(y)[x] = at.x, now.surfaces.y.row(y)[x] = at.y;
      now.surfaces.z.row(y)[x] = at.z, now.surfaces.normal_z.row(y)[x] = 1.0F;
      now.surfaces.distance_m.row(y)[x] = glm::length(at - Vec3{right_m, 0.0F, 0.0F});
      now.fresh.row(y)[x] = samples;
      const float value = light(Vec2{at.x, at.y}, frame);
      for (WidePlane* plane : {&now.mean.r, &now.mean.g, &now.mean.b, &now.mean.luminance})
        plane->row(y)[x] = value;
    }
  }
  return now;
}
void join(const LightMemory* last, const MemoryConfig& config, LightMemory& now) {
  MemoryJoin joined(last, config, now);
  for (int y = 0; y < kSide; ++y) joined.join_row(y);
  for (int y = 0; y < kSide; ++y) joined.bound_row(y);
  for (int y = 0; y < kSide; ++y) joined.judge_row(y);
}
/// After `count` frames, the eye going right by `step_m` in each.
LightMemory after(int count, float step_m, const Light& light, const MemoryConfig& config = {},
                  float samples = 1.0F) {
  LightMemory last = seen_from(0.0F, 0, light, samples);
  join(nullptr, config, last);
  for (int k = 1; k < count; ++k) {
    LightMemory now = seen_from(step_m * static_cast<float>(k), k, light, samples);
    join(&last, config, now);
    last = std::move(now);
  }
  return last;
}
/// Over the middle, of the mean against `truth`.
float rms(const LightMemory& memory, const Light& truth) {
  double sum = 0.0;
  int count = 0;
  for (int y = 8; y < kSide - 8; ++y) {
    for (int x = 8; x < kSide - 8; ++x, ++count) {
      const Vec2 place{memory.surfaces.x.row(y)[x], memory.surfaces.y.row(y)[x]};
      const float off = memory.mean.luminance.row(y)[x] - truth(place, 0);
      sum += static_cast<double>(off * off);
    }
  }
  return static_cast<float>(std::sqrt(sum / count));
}

/// Uniform in [0, 1): another number for every place and frame.
float noise(const Vec2& place, int frame) {
  const auto bits = [](float v) {
    return static_cast<std::uint64_t>(std::lround(v * 1e5F) + (1 << 24));
  };
  return math::unit_float(math::hash_combine(math::hash_combine(bits(place.x), bits(place.y)),
                                             static_cast<std::uint64_t>(frame)));
}
float even(const Vec2&, int) {
  return 1.0F;
}
float noisy(const Vec2& place, int frame) {
  return 0.5F + noise(place, frame);
}
float striped(const Vec2& place, int) {
  return 1.0F + 0.5F * std::sin(4.0F * place.x);
}

TEST(LightMemory, NoiseFallsWithTheNumberOfFrames) {
  const float one = rms(after(1, 0.0F, noisy), even), many = rms(after(20, 0.0F, noisy), even);
  EXPECT_NEAR(one, std::sqrt(1.0F / 12.0F), 0.02F);
  EXPECT_LT(many, one / 4.0F) << "square root of 20";
  MemoryConfig none;
  none.most_frames = 1.0F;
  EXPECT_GT(rms(after(20, 0.0F, noisy, none), even), one / 1.1F);
}

TEST(LightMemory, KnowsItsOwnNoise) {
  const LightMemory memory = after(20, 0.0F, noisy);
  double variance = 0.0;
  for (int y = 8; y < kSide - 8; ++y) {
    for (int x = 8; x < kSide - 8; ++x)
      variance +=
          static_cast<double>(memory.mean.variance.row(y)[x]) / ((kSide - 16) * (kSide - 16));
  }
  EXPECT_NEAR(variance, 1.0 / 12.0 / 20.0, 0.25 / 12.0 / 20.0);
}

TEST(LightMemory, LightStaysOnItsSurfaceWhileTheEyeMoves) {
  EXPECT_LT(rms(after(12, 0.03F, striped), striped), 0.03F);
  // A memory that stayed in its cell would show stripes from where the eye has been.
  const Light dragged = [](const Vec2& place, int) {
    return striped(place - Vec2{0.16F, 0.0F}, 0);
  };
  EXPECT_GT(rms(after(12, 0.03F, striped), dragged), 0.2F);
}

TEST(LightMemory, WhatManySamplesFoundIsNotBlurredByManyLooks) {
  // Stripes of six cells, the eye going a third of a cell to the right in each frame.
  const Light fine = [](const Vec2& place, int) { return 1.0F + 0.5F * std::sin(13.0F * place.x); };
  constexpr float kThird_m = 0.027F;
  const float few = rms(after(20, kThird_m, fine), fine);
  const float many = rms(after(20, kThird_m, fine, {}, 24.0F), fine);
  EXPECT_LT(many, 0.5F * few);
  MemoryConfig endless;
  endless.most_samples = 1e6F;
  EXPECT_GT(rms(after(20, kThird_m, fine, endless, 24.0F), fine), 0.9F * few);
}

TEST(LightMemory, ALampThatGoesOutIsForgotten) {
  const Light goes_out = [](const Vec2& place, int frame) {
    return frame < 20 ? noisy(place, frame) : 0.05F * noisy(place, frame);
  };
  const Light dark = [](const Vec2&, int) { return 0.05F; };
  EXPECT_LT(rms(after(32, 0.0F, goes_out), dark), 0.1F);
  MemoryConfig unbounded;
  unbounded.deviations = 1e6F;
  EXPECT_GT(rms(after(32, 0.0F, goes_out, unbounded), dark), 0.4F) << "a third of it would be left";
}

TEST(LightMemory, NothingIsKnownOfWhatWasHidden) {
  LightMemory last = seen_from(0.0F, 0, even);
  join(nullptr, {}, last);
  LightMemory now = seen_from(0.0F, 1, even);
  for (int x = 10; x < 20; ++x) now.surfaces.z.row(12)[x] += 1.0F;  // another wall, nearer
  for (int x = 20; x < 30; ++x) now.surfaces.distance_m.row(12)[x] = 0.0F;
  join(&last, {}, now);
  EXPECT_EQ(now.samples.row(12)[15], 1.0F);
  EXPECT_EQ(now.samples.row(12)[25], 0.0F);
  EXPECT_EQ(now.samples.row(13)[15], 2.0F);
}

TEST(LightMemory, FramesOfManySamplesCountForMoreThanThoseOfFew) {
  // Ten frames of one sample, then one of twenty that knows better.
  const Light learns = [](const Vec2& place, int frame) {
    return frame < 10 ? noisy(place, frame) : 1.0F;
  };
  LightMemory last = after(10, 0.0F, learns);
  LightMemory now = seen_from(0.0F, 10, learns);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) now.fresh.row(y)[x] = 20.0F;
  }
  const float before = rms(last, even);
  join(&last, {}, now);
  EXPECT_LT(rms(now, even), 0.4F * before);
  EXPECT_NEAR(now.frames(20, 20), 30.0F / 20.0F, 1e-3F);
}

}  // namespace
}  // namespace macula::reconstruction
