#include "server/kernels/field_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/sdf/read.h"

namespace macula::kernels {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

sdf::Field field_of(const char* scene) {
  auto field = sdf::parse_field(std::string(R"({"far": 100, "materials": {"a": {}, "b": {}},
      "lights": [], "scene": )") + scene +
                                    "}",
                                "test");
  EXPECT_TRUE(field) << (field ? "" : field.error().message());
  return *field;
}
const char* const kBall = R"({"type": "sphere", "radius": 2, "at": [0, 0, -10], "material": "b"})";

visibility::RayStream two_hundred(float tfar) {
  visibility::RayStream rays;
  for (int i = 0; i < 200; ++i) {
    const float x = -2.5F + 0.025F * static_cast<float>(i);
    rays.push({x, 0.3F, 0.0F}, {0.0F, 0.0F, -3.0F}, 0.0F, tfar);
  }
  return rays;
}

TEST(FieldRays, MeetABallWhereGeometrySays) {
  const FieldRays field(field_of(kBall), 0.0);
  const visibility::RayStream rays = two_hundred(kInfinity);
  visibility::HitStream hits;
  field.intersect(rays, hits);
  int met = 0;
  for (int i = 0; i < rays.count; ++i) {
    const double square = 4.0 - 0.09 - static_cast<double>(rays.ox[i]) * rays.ox[i];
    if (std::abs(square) < 0.01) continue;  // on the rim either answer is right
    ASSERT_EQ(hits.hit(i), square > 0.0) << i;
    if (square <= 0.0) continue;
    ++met;
    const double z = 10.0 - std::sqrt(square);
    // Stopped 2^-14 of the way before the surface, along its normal.
    const double slope = std::sqrt(square) / 2.0;
    EXPECT_NEAR(3.0 * hits.t[i], z, 10.0 * 0x1p-14 / slope) << i;
    const Vec3 normal = Vec3(rays.ox[i], 0.3F, static_cast<float>(std::sqrt(square))) / 2.0F;
    EXPECT_LT(glm::length(hits.normal(i) - normal), 2e-3F) << i;
    EXPECT_EQ(hits.instance[i], 1U);
    EXPECT_GT(hits.gap[i], 0.0F);
  }
  EXPECT_GT(met, 150);
}

TEST(FieldRays, EndWhereTheyAreToldTo) {
  const FieldRays field(field_of(kBall), 0.0);
  visibility::OcclusionStream hidden;
  // Directions are 3 m long; the ball begins 8 m ahead.
  for (const auto& [tfar, wanted] : {std::pair{2.6F, 0}, std::pair{2.9F, 1}, std::pair{-1.0F, 0}}) {
    visibility::RayStream rays;
    rays.push({0, 0, 0}, {0, 0, -3}, 0.0F, tfar);
    field.occluded(rays, hidden);
    EXPECT_EQ(hidden.occluded[0], wanted) << tfar;
  }
  EXPECT_FALSE(field.occluded({{0, 0, 0}, {0, 0, 3}, 0.0F, kInfinity, {}}));
}

TEST(FieldRays, LeaveEverySurfaceTheyHaveMet) {
  const FieldRays field(field_of(R"({"type": "union", "of": [
      {"type": "plane", "normal": [0, 1, 0], "at": [0, -1, 0]},
      {"type": "torus", "radius": 1, "tube_radius": 0.3, "at": [0, 0, -5], "rotate_deg": [40, 0, 0]},
      {"type": "twist", "deg_per_m": 36, "within_radius": 2, "of": {"type": "box", "half_size": 0.7, "at": [1, 0, -9]}}]})"),
                        0.0);
  int left = 0;
  for (int i = 0; i < 4000; ++i) {
    const float x = 0.05F * static_cast<float>(i % 64 - 32),
                y = 0.02F * static_cast<float>(i / 64 - 55);
    const Vec3 direction{0.2F * x, 0.5F * y, -1.0F};
    const auto hit = field.intersect({{0, 0.2F, 0}, direction, 0.0F, kInfinity, {}});
    if (!hit) continue;
    const Vec3 start = Vec3(0, 0.2F, 0) + hit->t * direction + hit->gap * hit->normal;
    EXPECT_FALSE(field.occluded({start, hit->normal, 0.0F, 0.02F, {}})) << i;
    ++left;
  }
  EXPECT_GT(left, 1500);
}

TEST(FieldRays, MeetNothingWhereTheyAreNoNumbers) {
  const FieldRays field(field_of(kBall), 0.0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3& origin : {Vec3{nan, 0, 0}, Vec3{0, kInfinity, 0}}) {
    EXPECT_FALSE(field.intersect({origin, {0, 0, -1}, 0.0F, kInfinity, {}}));
    EXPECT_FALSE(field.occluded({origin, {0, 0, -1}, 0.0F, kInfinity, {}}));
  }
  for (const Vec3& direction : {Vec3{0, nan, -1}, Vec3{0.0F}}) {
    EXPECT_FALSE(field.intersect({{0, 0, 0}, direction, 0.0F, kInfinity, {}}));
  }
}

TEST(FieldRays, BeginningInASolidAreOnItsSurfaceAtOnce) {
  const FieldRays field(field_of(kBall), 0.0);
  const auto hit = field.intersect({{0.5F, 0, -10}, {0, 0, -2}, 0.0F, kInfinity, {}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 0.0F);
  EXPECT_EQ(hit->normal, Vec3(0, 0, 1));
  EXPECT_TRUE(field.occluded({{0.5F, 0, -10}, {0, 0, -2}, 0.0F, 10.0F, {}}));
}

}  // namespace
}  // namespace macula::kernels
