// A plan leaves out what a scene does not need: forced on, it changes no pixel. And nothing more:
// taken away, every step that is used changes the picture.
#include <algorithm>
#include <cmath>

#include "server/scene/load.h"
#include "tests/conformance/plan_scenes.h"

namespace macula {
namespace {

using kernels::SceneFrame;
using scene::ScenePlan;
using scene::Step;
using scene::StepUse;

using ScenePointer = std::shared_ptr<const scene::Scene>;

ScenePointer shared(scene::Scene scene) {
  return std::make_shared<const scene::Scene>(std::move(scene));
}

struct Shown {
  const char* name;
  ScenePointer (*make)();
};
const Shown kScenes[] = {
    {"bare", [] { return shared(test::bare()); }},
    {"textured", [] { return shared(test::textured()); }},
    {"masked", [] { return shared(test::masked()); }},
    {"metallic", [] { return shared(test::metallic()); }},
    {"panel", [] { return shared(test::panel()); }},
    {"furnace", [] { return shared(test::furnace(0.7F)); }},
    {"nothing", [] { return shared(test::nothing_to_see()); }},
    {"cornell", [] { return *scene::load_scene("cornell"); }},
    {"posts", [] { return *scene::load_scene("posts"); }},
    {"atrium", [] { return *scene::load_scene("atrium"); }},
};

image::Plane<Rgb> picture(const ScenePointer& scene, const ScenePlan& plan, const char* kernel) {
  static kernels::TileScheduler scheduler(2);
  const auto frame = SceneFrame::create(scene, plan);
  EXPECT_TRUE(frame);
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.area_light_samples = options.ambient_samples = 2;
  if (kernel == std::string("culling")) options.bounces = 1;
  kernels::View view = test::view_on(foveation::make_uniform_grid(test::display(40)));
  if (scene->settings.scene_from_stage.position != DVec3{0.0}) {
    view.world_from_view = scene->settings.scene_from_stage;
    view.world_from_view.position.y += 1.6;
  }
  return test::render(kernel, options, **frame, view, scheduler).planes().radiance;
}

double largest_difference(const image::Plane<Rgb>& a, const image::Plane<Rgb>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const DVec3 difference = glm::abs(DVec3(a.pixels()[i]) - DVec3(b.pixels()[i]));
    largest = std::max({largest, difference.x, difference.y, difference.z});
  }
  return largest;
}

class PlannedScene : public testing::TestWithParam<Shown> {};

TEST_P(PlannedScene, AStepThatIsLeftOutChangesNothingWhenForced) {
  const ScenePointer scene = GetParam().make();
  std::vector<const char*> kernels{"ray", "lightcuts", "culling"};
  if (scene->triangle_count() < 10'000) kernels.push_back("brute");
  for (const char* kernel : kernels) {
    const ScenePlan plan(scene::facts_of(*scene), {.kernel = kernel});
    const auto planned = picture(scene, plan, kernel);
    for (const scene::PlannedStep& step : plan.steps()) {
      if (step.use != StepUse::LeftOut) continue;
      const auto forced = picture(scene, plan.forcing(step.step), kernel);
      EXPECT_LE(largest_difference(planned, forced), 1e-6) << kernel << ": " << step.name;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Each, PlannedScene, testing::ValuesIn(kScenes),
                         [](const auto& shown) { return std::string(shown.param.name); });

TEST(PlannedStep, TakenAwayChangesAPictureThatNeedsIt) {
  // Must-fail twin: were the plan not what drives the frame, these would be equal too.
  const ScenePointer scene = shared(test::everything());
  for (const char* kernel : {"ray", "lightcuts", "culling", "brute"}) {
    const ScenePlan plan(scene::facts_of(*scene), {.kernel = kernel});
    const auto planned = picture(scene, plan, kernel);
    int used = 0;
    for (const scene::PlannedStep& step : plan.steps()) {
      if (step.use == StepUse::LeftOut) continue;
      ++used;
      const auto without = picture(scene, plan.without(step.step), kernel);
      EXPECT_GT(largest_difference(planned, without), 1e-3) << kernel << ": " << step.name;
    }
    const bool has_its_own = kernel == std::string("lightcuts") || kernel == std::string("culling");
    EXPECT_EQ(used, has_its_own ? 9 : 8);
  }
}

TEST(PlannedStep, LeftOutHasNoStructureAndForcedHasOne) {
  const ScenePointer plain = shared(test::bare());
  const ScenePlan plan(scene::facts_of(*plain));
  const auto frame = *SceneFrame::create(plain, plan);
  EXPECT_EQ(frame->materials().texture_count(), 0U);
  EXPECT_TRUE(frame->lights().emissive().empty());
  EXPECT_EQ(frame->placed_lights().size(), 1U);
  const ScenePlan for_ray(scene::facts_of(*plain), {.kernel = "ray"});
  EXPECT_EQ((*SceneFrame::create(plain, for_ray))->placed_lights().size(), 0U);
  EXPECT_GT((*SceneFrame::create(plain, plan.forcing(Step::Textures)))->materials().texture_count(),
            0U);
  EXPECT_FALSE(
      (*SceneFrame::create(plain, plan.forcing(Step::AreaLights)))->lights().emissive().empty());

  const ScenePointer empty = shared(test::nothing_to_see());
  const ScenePlan none(scene::facts_of(*empty));
  EXPECT_EQ((*SceneFrame::create(empty, none))->triangles().packet_width(), 0) << "no device";
  EXPECT_GT(
      (*SceneFrame::create(empty, none.forcing(Step::TriangleBvh)))->triangles().packet_width(), 0);
}

}  // namespace
}  // namespace macula
