#include "server/cluster/frame_order.h"

#include <gtest/gtest.h>

namespace macula::test {
namespace {

TEST(FrameOrder, ComesOutAsItWentIn) {
  cluster::FrameOrder order;
  order.kernel = 3, order.history = 7, order.forgotten = {5, 6};
  order.scene_time = kernels::SceneTime{Nanoseconds{123456789}}, order.frame = 42, order.seed = 9;
  order.wanted = kernels::kNormal | kernels::kRate, order.watched = true;
  kernels::View view;
  view.world_from_view.position = {1.0, -2.0, 3.5};
  view.grid = {{-1.0F, 0.25F, 1.0F}, {-0.5F, 0.5F}};
  view.gaze.direction = {0.0F, 0.6F, -0.8F};
  view.tone.exposure_ev = -1.5F;
  order.views = {view, view};
  order.foveation = {{view.grid, view.gaze, {1e-3, 2e-3}}};
  order.model.floor = 0.25;

  const cluster::FrameOrder got = cluster::FrameOrder::from(order.bytes());
  EXPECT_FALSE(got.ends);
  EXPECT_EQ(got.kernel, 3U);
  EXPECT_EQ(got.history, 7U);
  EXPECT_EQ(got.forgotten, order.forgotten);
  EXPECT_EQ(got.scene_time, order.scene_time);
  EXPECT_EQ(got.frame, 42U);
  EXPECT_EQ(got.seed, 9U);
  EXPECT_EQ(got.wanted, order.wanted);
  EXPECT_TRUE(got.watched);
  ASSERT_EQ(got.views.size(), 2U);
  EXPECT_EQ(got.views[1].grid, view.grid);
  EXPECT_EQ(got.views[1].world_from_view.position, view.world_from_view.position);
  EXPECT_EQ(got.views[1].gaze.direction, view.gaze.direction);
  EXPECT_EQ(got.views[1].tone, view.tone);
  ASSERT_EQ(got.foveation.size(), 1U);
  EXPECT_EQ(got.foveation[0].grid, view.grid);
  EXPECT_EQ(got.foveation[0].nominal_pixel_tangent, DVec2(1e-3, 2e-3));
  EXPECT_EQ(got.model.floor, 0.25);
}

}  // namespace
}  // namespace macula::test
