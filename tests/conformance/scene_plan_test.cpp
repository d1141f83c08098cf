// A plan leaves out what a scene does not need: forced on, it changes no pixel. And nothing more:
// taken away, every step that is used changes the picture.
#include <algorithm>
#include <cmath>

#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"

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

/// A Lambertian floor and ball under one lamp: what needs least.
scene::Scene bare() {
  scene::Scene scene;
  scene.name = "bare";
  scene.materials.resize(1);
  scene.materials[0].specular = 0.0F;
  test::add_quad(scene, {-2, -1, 0}, {4, 0, 0}, {0, 0, -5}, 0);
  test::add_sphere(scene, {0, -0.3F, -3}, 0.7F, 8, 0);
  scene::Light light;
  light.intensity = Rgb{8.0F};
  light.position = {1.0, 2.0, -2.0};
  scene.lights = {light};
  return scene;
}

/// A chequer of colours, every other texel with half and with no alpha.
scene::Image chequer() {
  scene::Image image;
  image.pixels = image::Plane<image::Rgba8>(8, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool odd = (x + y) % 2 != 0;
      image.pixels(x, y) = {static_cast<std::uint8_t>(30 * x), 200,
                            odd ? std::uint8_t{20} : std::uint8_t{220},
                            static_cast<std::uint8_t>(odd ? 0 : 255)};
    }
  }
  return image;
}

scene::Scene textured() {
  scene::Scene scene = bare();
  scene.images = {chequer()};
  scene.materials[0].base_color_texture = scene::TextureRef{};
  return scene;
}

scene::Scene masked() {
  scene::Scene scene = textured();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].alpha_mode = scene::AlphaMode::Mask;
  test::add_quad(scene, {-1, -0.8F, -1.5F}, {2, 0, 0}, {0, 1.2F, 0}, 1);
  return scene;
}

scene::Scene metallic() {
  scene::Scene scene = bare();
  scene.materials[0].specular = 1.0F;
  scene.materials[0].metallic = 1.0F;
  scene.materials[0].roughness = 0.5F;
  return scene;
}

/// Lit by a panel alone.
scene::Scene panel() {
  scene::Scene scene = bare();
  scene.lights.clear();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = Rgb{5.0F, 4.0F, 3.0F};
  test::add_quad(scene, {-0.7F, 1.5F, -3.2F}, {0.8F, 0, 0}, {0, 0, 0.8F}, 1);
  return scene;
}

/// All there is at once.
scene::Scene everything() {
  scene::Scene scene = masked();
  const scene::Scene other = test::small_room();
  const auto first = static_cast<scene::Index>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), other.materials.begin(), other.materials.end());
  for (scene::Mesh mesh : other.meshes) {
    mesh.material += first;
    scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
    scene.meshes.push_back(std::move(mesh));
  }
  scene.settings.ambient = other.settings.ambient;
  scene.environment = scene::Environment{};
  scene.environment->radiance(0, 0) = {0.4F, 0.5F, 0.7F};
  return scene;
}

scene::Scene nothing_to_see() {
  scene::Scene scene;
  scene.name = "nothing";
  return scene;
}

struct Shown {
  const char* name;
  ScenePointer (*make)();
};
const Shown kScenes[] = {
    {"bare", [] { return shared(bare()); }},
    {"textured", [] { return shared(textured()); }},
    {"masked", [] { return shared(masked()); }},
    {"metallic", [] { return shared(metallic()); }},
    {"panel", [] { return shared(panel()); }},
    {"furnace", [] { return shared(test::furnace(0.7F)); }},
    {"nothing", [] { return shared(nothing_to_see()); }},
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
      // An environment draws directions from whole reflectors, which are made one by one, not in
      // vectors: alike within 1e-5.
      const double bound = step.step == scene::Step::Environment ? 1e-5 : 1e-6;
      EXPECT_LE(largest_difference(planned, forced), bound) << kernel << ": " << step.name;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Each, PlannedScene, testing::ValuesIn(kScenes),
                         [](const auto& shown) { return std::string(shown.param.name); });

TEST(PlannedStep, TakenAwayChangesAPictureThatNeedsIt) {
  // Must-fail twin: were the plan not what drives the frame, these would be equal too.
  const ScenePointer scene = shared(everything());
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
  const ScenePointer plain = shared(bare());
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

  const ScenePointer empty = shared(nothing_to_see());
  const ScenePlan none(scene::facts_of(*empty));
  EXPECT_EQ((*SceneFrame::create(empty, none))->triangles().packet_width(), 0) << "no device";
  EXPECT_GT(
      (*SceneFrame::create(empty, none.forcing(Step::TriangleBvh)))->triangles().packet_width(), 0);
}

}  // namespace
}  // namespace macula
