#include "server/kernels/lightcuts/retinal_speed.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "server/kernels/lightcuts/light_plan.h"
#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/planes.h"
#include "server/kernels/scene_timeline.h"
#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = 32;
constexpr double kSeconds = 0.01;

/// A box's front half a meter across, 2 m away, that has moved a centimeter to the right; open sky
/// around it.
struct Shot {
  std::shared_ptr<const SceneFrame> scene;
  foveation::Display display = macula::test::display(kSide, 60.0);
  View then = macula::test::view_on(foveation::make_uniform_grid(display)), now = then;
  scene::InstanceMotion motion{0, glm::translate(DMat4(1.0), DVec3(0.01, 0.0, 0.0))};
  TileScheduler scheduler{2};

  Shot() {
    scene::Scene made;
    made.materials.resize(1);
    macula::test::add_quad(made, {-0.25F, -0.25F, -2}, {0.5F, 0, 0}, {0, 0.5F, 0}, 0);
    scene = macula::test::frame_of(std::move(made));
  }
  Plane<float> speed() {
    const FoveationMap map({{now.grid, now.gaze, display.pixel_tangent()}}, {});
    FrameBuffers out;
    out.wanted |= kSurfaceId;
    prepare_buffers({&now, 1}, out);
    std::vector<ViewSurfaces> surfaces;
    KernelOptions options;
    options.jitter = false;
    trace_surfaces({{&now, 1}, map, 0, 1}, *scene, make_config(options).ray, scheduler, surfaces,
                   out);
    return retinal_speed({then, now, {&motion, 1}, kSeconds}, surfaces[0], out.views[0].surface_id,
                         scheduler);
  }
};
float degrees(double radians) {
  return static_cast<float>(radians * 180.0 / std::numbers::pi);
}
DQuat turned(double radians) {
  return glm::angleAxis(radians, DVec3(0.0, 1.0, 0.0));
}
constexpr int kMiddle = kSide / 2;

// A centimeter across at 2 m is atan(.01 / 2), in a hundredth of a second.
TEST(RetinalSpeed, IsWhatAMovingSurfaceHasAgainstARestingEye) {
  Shot shot;
  const Plane<float> speed = shot.speed();
  EXPECT_NEAR(speed(kMiddle, kMiddle), degrees(std::atan(0.01 / 2.0) / kSeconds), 0.2F);
  EXPECT_EQ(speed(0, 0), 0.0F) << "the sky rests";
}

TEST(RetinalSpeed, IsTakenFromWhatTheGazeFollowsAndGivenToTheRest) {
  Shot shot;
  shot.now.gaze.direction = glm::normalize(Vec3(0.01F, 0.0F, -2.0F));
  const Plane<float> speed = shot.speed();
  const float pursuit = degrees(std::atan(0.01 / 2.0) / kSeconds);
  EXPECT_LT(speed(kMiddle, kMiddle), 0.1F * pursuit);
  EXPECT_NEAR(speed(0, kMiddle), pursuit, 0.2F * pursuit);
}

TEST(RetinalSpeed, AGazeThatStaysOnTheWorldTakesTheHeadsTurnAway) {
  Shot shot;
  shot.motion.now_from_before = DMat4(1.0);
  constexpr double kTurn = 0.005;  // to the left
  shot.now.world_from_view.rotation = turned(kTurn);
  const Plane<float> fixed_in_head = shot.speed();
  shot.now.gaze.direction = Vec3(std::sin(kTurn), 0.0, -std::cos(kTurn));
  const Plane<float> fixed_in_world = shot.speed();
  EXPECT_NEAR(fixed_in_head(kMiddle, kMiddle), degrees(kTurn / kSeconds), 0.5F);
  EXPECT_LT(fixed_in_world(kMiddle, kMiddle), 0.05F);
  EXPECT_LT(fixed_in_world(0, 0), 0.05F);
}

TEST(RetinalSpeed, EdgesOfSpeedGetMoreSamplesAndEvenSpeedNone) {
  Shot shot;
  Config config = make_config({});
  config.low_nodes = 0;
  const FoveationMap map({{shot.now.grid, shot.now.gaze, shot.display.pixel_tangent()}}, {});
  const FrameRequest request{{&shot.now, 1}, map, 0, 1};
  FrameBuffers surfaces;
  prepare_buffers(request.views, surfaces);  // flat: neither normals nor albedo
  std::vector<Plane<float>> speeds(1, Plane<float>(kSide, kSide, 90.0F));
  const auto nodes = [&](std::span<const Plane<float>> given) {
    LowViews none;
    return plan_lights(request, *shot.scene, config, surfaces, given, none, shot.scheduler)
        .cut_nodes.front();
  };
  const auto resting = nodes({}), even = nodes(speeds);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide / 4; ++x) speeds[0](x, y) = 0.0F;
  const auto edged = nodes(speeds);
  EXPECT_GT(edged(kSide / 4, 1), resting(kSide / 4, 1)) << "where the eye sees little of rest";
  for (int y = 1; y + 1 < kSide; ++y) {
    for (int x = 1; x + 1 < kSide; ++x) {
      const bool at_edge = x == kSide / 4 - 1 || x == kSide / 4;
      EXPECT_EQ(even(x, y), resting(x, y));
      if (at_edge) {
        EXPECT_GE(edged(x, y), resting(x, y));
      } else {
        EXPECT_EQ(edged(x, y), resting(x, y)) << x << " " << y;
      }
    }
  }
}

/// Nodes of the second of two frames' cuts, the scene's clock at `from` and `to` seconds; the head
/// moves to the left.
std::uint64_t nodes_of(kernels::SceneTimeline& timeline, double from, double to) {
  Shot shot;
  KernelOptions options;
  options.jitter = false;
  options.light_share = LightShare::Perceived;
  const LightcutsKernel kernel(make_config(options));
  const FoveationMap map({{shot.now.grid, shot.now.gaze, shot.display.pixel_tangent()}}, {});
  History history;
  FrameBuffers out;
  FrameReport report;
  double aside_m = 0.4;  // as from a train; then the head is in its place
  for (const double seconds : {from, to}) {
    const auto frame = timeline.at(scene::SceneTime{units::from_s(seconds)});
    shot.now.world_from_view = (*frame)->pose().world_from_view.front();
    shot.now.world_from_view.position.x += std::exchange(aside_m, 0.0);
    report = kernel.render({{&shot.now, 1}, map, 0, 1}, **frame, history, shot.scheduler, out);
  }
  return report.walked_nodes + report.taken_nodes;
}

TEST(RetinalSpeed, WhatTheHeadPassesIsAskedMoreLights) {
  const auto scene = scene::load_scene("moving");
  ASSERT_TRUE(scene);
  const auto timeline = kernels::SceneTimeline::create(*scene);
  ASSERT_TRUE(timeline);
  const std::uint64_t resting = nodes_of(**timeline, 0.1, 0.1);
  EXPECT_GT(resting, 0U);
  EXPECT_GT(nodes_of(**timeline, 0.08, 0.1), resting);
  EXPECT_EQ(nodes_of(**timeline, 2.1, 0.1), resting) << "a clock that leaps tells no speed";
}

}  // namespace
}  // namespace macula::kernels::lightcuts
