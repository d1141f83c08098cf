#include "server/sdf/tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

TraceOptions exactly(Method method) {
  TraceOptions options;
  options.method = method;
  options.hit_pixels = 0.0F;
  options.hit_m = 1e-4F;
  options.max_steps = 2000;
  return options;
}

// |o + t d|^2 = r^2 for a sphere of radius r around the origin, nearer root.
std::optional<double> sphere_t(const DVec3& eye, const DVec3& direction, double radius) {
  const double along = glm::dot(eye, direction);
  const double rest = along * along - glm::dot(eye, eye) + radius * radius;
  if (rest < 0.0) return std::nullopt;
  return -along - std::sqrt(rest);
}

class EachMethod : public testing::TestWithParam<Method> {};

TEST_P(EachMethod, MeetsASphereWhereItsEquationSays) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 1.5})");
  const Pose pose = math::look_at({0.5, 1.0, 6.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
  const Program program = compile(field, 0.0, pose.position);
  const Traced traced = trace_picture(program, pose, ordinary_grid(200, 150), exactly(GetParam()));
  int hits = 0;
  for (const Hit& hit : traced.hits) {
    const DVec3 direction(hit.direction);
    const auto expected = sphere_t(pose.position, direction, 1.5);
    // Rays that pass within the hit distance of the silhouette may go either way.
    const double miss_m = glm::length(glm::cross(pose.position, direction)) - 1.5;
    if (std::abs(miss_m) < 2e-4) continue;
    ASSERT_EQ(hit.status == RayStatus::Hit, expected.has_value());
    if (!expected || miss_m > -0.02) continue;
    ++hits;
    ASSERT_NEAR(hit.t / *expected, 1.0, 1e-5);
    const DVec3 normal = (pose.position + *expected * direction) / 1.5;
    ASSERT_GT(glm::dot(DVec3(hit.normal), normal), 0.9999);
  }
  EXPECT_GT(hits, 3000);
}

TEST_P(EachMethod, MeetsAPlaneWhereItsEquationSays) {
  const Field field = scene_of(R"({"type": "plane", "normal": [0, 1, 0]})");
  const Pose pose = math::look_at({0.0, 2.0, 0.0}, {0.0, 0.0, -4.0}, {0.0, 1.0, 0.0});
  const Program program = compile(field, 0.0, pose.position);
  const Traced traced = trace_picture(program, pose, ordinary_grid(200, 150), exactly(GetParam()));
  for (const Hit& hit : traced.hits) {
    const double expected = 2.0 / -hit.direction.y;
    const bool below = hit.direction.y < -0.1F;
    if (below) {
      ASSERT_NEAR(hit.t / expected, 1.0, 1e-5);
    }
    if (hit.direction.y > 0.0F) {
      ASSERT_EQ(hit.status, RayStatus::Miss);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sdf, EachMethod,
                         testing::Values(Method::Full, Method::FullBest, Method::Cones));

}  // namespace
}  // namespace macula::sdf
