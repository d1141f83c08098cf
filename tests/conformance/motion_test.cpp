// Pictures of a scene that moves: the same at the same time whichever came before, periodic, and
// carried by every step the plan says is used.
#include <algorithm>

#include "server/kernels/scene_timeline.h"
#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"

namespace macula {
namespace {

using kernels::SceneTimeline;
using scene::ScenePlan;
using scene::Step;

using Picture = std::vector<Rgb>;

const std::shared_ptr<const scene::Scene>& moving() {
  static const auto scene = *scene::load_scene("moving");
  return scene;
}

scene::SceneTime at_ms(std::int64_t ms) {
  return {std::chrono::milliseconds{ms}};
}

Picture picture_of(const kernels::SceneFrame& frame, const char* kernel = "ray") {
  static kernels::TileScheduler scheduler(2);
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.area_light_samples = options.ambient_samples = 2;
  kernels::View view = test::view_on(foveation::make_uniform_grid(test::display(48)));
  view.world_from_view = frame.pose().world_from_view.front();
  const auto rendered = test::render(kernel, options, frame, view, scheduler);
  const auto& pixels = rendered.planes().radiance.pixels();
  return {pixels.begin(), pixels.end()};
}

double largest_difference(const Picture& a, const Picture& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Rgb difference = glm::abs(a[i] - b[i]);
    largest = std::max<double>({largest, difference.x, difference.y, difference.z});
  }
  return largest;
}

TEST(MovingPicture, TheSameTimeGivesTheSameBitsWhicheverWayLedThere) {
  const auto direct = *SceneTimeline::create(moving());
  const Picture expected = picture_of(**direct->at(at_ms(3200)));
  const auto roundabout = *SceneTimeline::create(moving());
  for (const std::int64_t ms : {0, 9000, 3199, -500}) ASSERT_TRUE(roundabout->at(at_ms(ms)));
  EXPECT_EQ(picture_of(**roundabout->at(at_ms(3200))), expected);
  // A hundredth of a second is seen: the comparison is not blind.
  EXPECT_NE(picture_of(**roundabout->at(at_ms(3210))), expected);
}

TEST(MovingPicture, RepeatsAfterItsCycleForEver) {
  const auto timeline = *SceneTimeline::create(moving());
  const Picture expected = picture_of(**timeline->at(at_ms(5000)));
  for (const std::int64_t cycles : {1, -1, 300'000'000}) {
    EXPECT_EQ(picture_of(**timeline->at(at_ms(5000 + 24'000 * cycles))), expected) << cycles;
  }
}

TEST(MovingPicture, EveryStepOfItsMotionIsNeededAndDoesItsWork) {
  const ScenePlan plan(scene::facts_of(*moving()));
  const auto shown = [](const ScenePlan& by) {
    return picture_of(**kernels::SceneFrame::create(moving(), by, at_ms(2500)), "brute");
  };
  const Picture planned = shown(plan);
  for (const Step step : {Step::TopLevel, Step::Refit, Step::MovingLights}) {
    ASSERT_EQ(plan.use(step), scene::StepUse::Used);
    EXPECT_GT(largest_difference(planned, shown(plan.without(step))), 1e-2);
    EXPECT_EQ(largest_difference(planned, shown(plan.forcing(step))), 0.0);
  }
}

}  // namespace
}  // namespace macula
