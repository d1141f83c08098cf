#include "tests/bench/primitive_scenes.h"

#include <gtest/gtest.h>

#include "server/kernels/scene_frame.h"
#include "server/sdf/read.h"
#include "server/sdf/tracer.h"
#include "shared/math/fov.h"

namespace macula::bench {
namespace {

/// Share of a picture of the disc that primitives cover.
double coverage(int count) {
  const auto frame = kernels::SceneFrame::create(primitive_scene(count));
  EXPECT_TRUE(frame);
  constexpr int kSide = 50;
  int met = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3 at{0.2F * (static_cast<float>(x) - 24.5F), 0.2F * (static_cast<float>(y) - 24.5F),
                    0.0F};
      const Vec3 eye{0.0F, 0.0F, 6.0F};
      met += (*frame)->occluded({eye, at - eye, 0.0F, 10.0F, {}}) ? 1 : 0;
    }
  }
  return met / 2.5e3;
}

TEST(PrimitiveScenes, CoverAboutTheSameWhateverTheirNumber) {
  const double of_ten = coverage(10);
  EXPECT_GT(of_ten, 0.2);
  for (const int count : {1, 100, 1000})
    EXPECT_NEAR(coverage(count), of_ten, 0.2 * of_ten) << count;
}

/// Lane operations a pixel, counted for any machine alike.
double operations(int count, sdf::Method method, int side) {
  const auto field = sdf::parse_field(primitive_scene_text(count), "disc");
  EXPECT_TRUE(field);
  const Pose pose = field->pose_of(field->cameras.front(), 0.0);
  const sdf::Program program = sdf::compile(*field, 0.0, pose.position);
  const PixelGrid grid =
      foveation::make_uniform_grid({math::symmetric_fov(Degrees{70.0}, 1.0), side, side});
  const auto tracer =
      sdf::Tracer::create(program, glm::mat3_cast(pose.rotation), grid, {.method = method});
  EXPECT_TRUE(tracer);
  sdf::TraceWorkspace workspace;
  sdf::TraceCounts counts;
  for (int y = 0; y < side; y += sdf::kTileSide)
    for (int x = 0; x < side; x += sdf::kTileSide)
      counts += tracer->trace({x, y, sdf::kTileSide, sdf::kTileSide}, nullptr, workspace,
                              [](const sdf::HitBlock&) {});
  return static_cast<double>(counts.operations) / (side * side);
}

TEST(PrimitiveScenes, CostTenTimesAsMuchAtMostForAHundredTimesAsMany) {
  constexpr int kSide = 512, kSmall = 128;
  EXPECT_LT(operations(1000, sdf::Method::Cones, kSide),
            10.0 * operations(10, sdf::Method::Cones, kSide));
  // Plain tracing pays for every one.
  EXPECT_GT(operations(1000, sdf::Method::Full, kSmall),
            50.0 * operations(10, sdf::Method::Full, kSmall));
}

TEST(PrimitiveScenes, AreNamedByTheirNumber) {
  EXPECT_EQ(primitive_count("primitives-1000"), 1000);
  for (const char* other : {"primitives", "primitives-", "primitives-0", "primitives-1x",
                            "primitives-99999", "temple"}) {
    EXPECT_FALSE(primitive_count(other)) << other;
  }
}

}  // namespace
}  // namespace macula::bench
