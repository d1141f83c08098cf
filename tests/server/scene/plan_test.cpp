#include "server/scene/plan.h"

#include <gtest/gtest.h>
#include <array>

namespace macula::scene {
namespace {

constexpr std::array<std::string_view, 4> kAll{"sphere", "lightcuts", "culling", "ray"};
constexpr std::array<std::string_view, 2> kFirst{"ray", "brute"};

SceneFacts plain() {
  SceneFacts facts;
  facts.triangles = 100;
  facts.lights = 2;
  return facts;
}

std::string_view choice(const SceneFacts& facts,
                        IndirectLight indirect = IndirectLight::NotWanted) {
  return choose_kernel(facts, indirect, kAll).kernel;
}

TEST(ScenePlan, ADistanceFieldIsForSphere) {
  SceneFacts facts = plain();
  facts.is_sdf = true;
  facts.lights = 1000;
  EXPECT_EQ(choice(facts), "sphere");
}

TEST(ScenePlan, MoreThanSixtyFourLightsOrEmissiveTrianglesAreForLightcuts) {
  SceneFacts facts = plain();
  facts.lights = 64;
  EXPECT_EQ(choice(facts), "ray");
  facts.lights = 65;
  EXPECT_EQ(choice(facts), "lightcuts");
  facts.lights = 0;
  facts.emissive_triangles = 65;
  EXPECT_EQ(choice(facts), "lightcuts");
}

TEST(ScenePlan, IndirectLightIsForCulling) {
  EXPECT_EQ(choice(plain(), IndirectLight::Wanted), "culling");
}

TEST(ScenePlan, EverythingElseIsForRay) {
  EXPECT_EQ(choice(plain()), "ray");
}

TEST(ScenePlan, AKernelThatIsNotRegisteredIsNamedAndPassedOver) {
  SceneFacts facts = plain();
  facts.lights = 92;
  const KernelChoice chosen = choose_kernel(facts, IndirectLight::NotWanted, kFirst);
  EXPECT_EQ(chosen.kernel, "ray");
  EXPECT_NE(chosen.reason.find("'lightcuts' would suit"), std::string::npos);
  EXPECT_NE(chosen.reason.find("92 lights"), std::string::npos);
}

TEST(ScenePlan, AStepIsUsedExactlyWhenTheSceneNeedsIt) {
  SceneFacts facts;
  const auto has = [&facts](Step step) { return ScenePlan(facts).has(step); };
  const ScenePlan nothing(facts);
  for (const PlannedStep& step : nothing.steps()) {
    EXPECT_EQ(step.use, StepUse::LeftOut) << step.name << ": an empty scene needs nothing";
    EXPECT_FALSE(step.reason.empty()) << step.name;
  }
  facts.triangles = 100;
  EXPECT_TRUE(has(Step::TriangleBvh));
  facts.masked_materials = 1;
  EXPECT_TRUE(has(Step::AlphaTest));
  facts.textured_materials = 1;
  EXPECT_TRUE(has(Step::Textures));
  facts.glossy_materials = 1;
  EXPECT_TRUE(has(Step::SpecularLobe));
  facts.lights = 1;
  EXPECT_TRUE(has(Step::PunctualLights));
  EXPECT_FALSE(has(Step::AreaLights));
  facts.emissive_triangles = 2;
  EXPECT_TRUE(has(Step::AreaLights));
  EXPECT_TRUE(has(Step::LightTree));
  EXPECT_TRUE(ScenePlan(facts, {.kernel = "lightcuts"}).has(Step::LightTree));
  EXPECT_FALSE(ScenePlan(facts, {.kernel = "ray"}).has(Step::LightTree));
  EXPECT_TRUE(ScenePlan(facts, {.kernel = "culling"}).has(Step::VirtualLights));
  EXPECT_FALSE(ScenePlan(facts, {.kernel = "lightcuts"}).has(Step::VirtualLights));
  EXPECT_FALSE(has(Step::Ambient));
  facts.has_ambient = true;
  EXPECT_TRUE(has(Step::Ambient));
  EXPECT_FALSE(ScenePlan(facts, {.ambient_samples = 0}).has(Step::Ambient));
  EXPECT_FALSE(has(Step::DistanceField));
}

TEST(ScenePlan, OneStepCanBeForcedOrForbiddenAndTheRestStays) {
  const ScenePlan plan(plain());
  const ScenePlan forced = plan.forcing(Step::AreaLights);
  const ScenePlan without = plan.without(Step::TriangleBvh);
  EXPECT_EQ(forced.use(Step::AreaLights), StepUse::Forced);
  EXPECT_EQ(without.use(Step::TriangleBvh), StepUse::LeftOut);
  for (const PlannedStep& step : plan.steps()) {
    EXPECT_TRUE(step.step == Step::AreaLights || forced.use(step.step) == step.use) << step.name;
    EXPECT_TRUE(step.step == Step::TriangleBvh || without.use(step.step) == step.use) << step.name;
  }
}

TEST(ScenePlan, FactsCountWhatTheSceneShows) {
  Scene scene;
  scene.materials.resize(4);  // the last one, glossy, is on no mesh
  scene.meshes.resize(3);
  for (Index i = 0; i < 3; ++i) {
    scene.meshes[i].material = i;
    scene.instances.push_back({i});
  }
  for (Index i = 0; i < 3; ++i) scene.materials[i].specular = 0.0F;
  scene.materials[0].specular = 0.2F;
  scene.materials[1].alpha_mode = AlphaMode::Mask;
  scene.materials[1].alpha = 0.25F;
  scene.materials[0].alpha_mode = AlphaMode::Mask;  // of alpha 1 everywhere: nothing to test
  scene.materials[2].base_color_texture = TextureRef{};
  scene.lights.resize(5);
  scene.settings.ambient = Rgb{0.1F};
  const SceneFacts facts = facts_of(scene);
  EXPECT_EQ(facts.glossy_materials, 1U);
  EXPECT_EQ(facts.masked_materials, 1U);
  EXPECT_EQ(facts.textured_materials, 1U);
  EXPECT_EQ(facts.lights, 5U);
  EXPECT_TRUE(facts.has_ambient);
}

}  // namespace
}  // namespace macula::scene
