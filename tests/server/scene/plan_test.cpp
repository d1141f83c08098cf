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

bool is_used(const std::vector<Pass>& passes, std::string_view name) {
  for (const Pass& pass : passes)
    if (pass.name == name) return pass.used;
  ADD_FAILURE() << "no pass named " << name;
  return false;
}

TEST(ScenePlan, APassIsUsedExactlyWhenTheSceneNeedsIt) {
  SceneFacts facts = plain();
  EXPECT_TRUE(is_used(plan_passes(facts, 4), "triangle BVH"));
  EXPECT_FALSE(is_used(plan_passes(facts, 4), "area-light sampling"));
  EXPECT_FALSE(is_used(plan_passes(facts, 4), "ambient occlusion"));
  facts.emissive_triangles = 2;
  facts.has_ambient = true;
  EXPECT_TRUE(is_used(plan_passes(facts, 4), "area-light sampling"));
  EXPECT_TRUE(is_used(plan_passes(facts, 4), "ambient occlusion"));
  EXPECT_FALSE(is_used(plan_passes(facts, 0), "ambient occlusion"));
  for (const Pass& pass : plan_passes(facts, 4)) EXPECT_FALSE(pass.reason.empty());
}

TEST(ScenePlan, FactsCountWhatTheSceneHolds) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[0].roughness = 0.2F;
  scene.materials[1].alpha_mode = AlphaMode::Mask;
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
