#include "server/scene/field_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "server/scene/animation.h"
#include "server/scene/load.h"
#include "server/scene/plan.h"
#include "server/sdf/read.h"

namespace macula::scene {
namespace {

constexpr const char* kField = R"({
  "sky": [0.1, 0.2, 0.3], "far": 50, "exposure_ev": 1.5,
  "materials": {"tiles": {"color": 0.5, "second": 0.1, "pattern": "checker", "pattern_size": 2},
                "gold": {"color": [0.9, 0.6, 0.2], "roughness": 0.3, "metallic": 1}},
  "lights": [{"name": "lamp", "position": {"keys": [[0, [0, 2, 0]], [2, [4, 2, 0]]]},
              "intensity": 8}],
  "suns": [{"direction": [0, -1, 0], "irradiance": 3}],
  "cameras": [{"name": "eye", "eye": [0, 1.6, 4], "target": [0, 1.6, 0]}],
  "scene": {"type": "sphere", "radius": 1, "material": "gold"}
})";

std::shared_ptr<const Scene> scene() {
  auto field = sdf::parse_field(kField, "test");
  EXPECT_TRUE(field) << (field ? "" : field.error().message());
  return std::make_shared<const Scene>(
      scene_of(std::make_shared<const sdf::Field>(std::move(*field))));
}

const Material& named(const Scene& scene, const std::string& name) {
  return *std::ranges::find(scene.materials, name, &Material::name);
}

TEST(FieldScene, SaysInAScenesWordsWhatTheFieldSays) {
  const auto made = scene();
  EXPECT_EQ(made->settings.ambient, (Rgb{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(made->settings.tone.exposure_ev, 1.5F);
  ASSERT_TRUE(named(*made, "tiles").pattern);
  EXPECT_EQ(named(*made, "tiles").pattern->kind, PatternKind::Checker);
  EXPECT_EQ(named(*made, "tiles").pattern->size_m, 2.0F);
  EXPECT_EQ(named(*made, "gold").metallic, 1.0F);
  ASSERT_EQ(made->lights.size(), 2U);
  EXPECT_EQ(made->lights[1].kind, LightKind::Directional);
  ASSERT_EQ(made->cameras.size(), 1U);
  EXPECT_NEAR(made->settings.scene_from_stage.position.y, 0.0, 1e-9);
}

TEST(FieldScene, AFieldFarFromItsOriginIsBroughtToIt) {
  auto field = sdf::parse_field(kField, "test");
  ASSERT_TRUE(field);
  EXPECT_EQ(recentre(*field), DVec3{0.0});
  const DVec3 far{2e5, -1e5, 3e5};
  sdf::translate(*field, far);
  EXPECT_NEAR(field->at(field->lights[0].position, 2.0).x, 2e5 + 4.0, 1e-9);
  const DVec3 origin = recentre(*field);
  EXPECT_LT(glm::length(origin - far), 5.0) << "the stage stands by the camera";
  EXPECT_LT(glm::length(field->at(field->cameras[0].eye, 0.0)), 1.0);
  EXPECT_EQ(field->at(field->nodes.back().at, 0.0), far - origin);
  EXPECT_EQ(field->at(field->lights[0].position, 2.0), (DVec3{4.0, 2.0, 0.0} + far - origin));
}

TEST(FieldScene, WithoutALobeWhereASurfaceIsAsRoughAsCanBe) {
  const auto made = scene();
  EXPECT_EQ(named(*made, "tiles").specular, 0.0F);
  EXPECT_GT(named(*made, "gold").specular, 0.0F);
  EXPECT_EQ(facts_of(*made).glossy_materials, 1U);
}

TEST(FieldScene, ItsLightsFollowTheScenesClock) {
  const auto made = scene();
  EXPECT_TRUE(moving_parts(*made).field);
  EXPECT_EQ(moving_parts(*made).lights, std::vector<Index>{0});
  ScenePose pose = pose_at(*made, SceneTime{units::from_s(1.0)});
  std::vector<Light> lights = lights_at(*made, pose);
  EXPECT_NEAR(lights[0].position.x, 2.0, 1e-9);
  repose(*made, moving_parts(*made), SceneTime{units::from_s(0.5)}, pose);
  carry_lights(*made, moving_parts(*made).lights, pose, lights);
  EXPECT_NEAR(lights[0].position.x, 1.0, 1e-9);
}

TEST(FieldScene, EveryBuiltInFieldLoadsWithACameraAndLight) {
  for (const sdf::BuiltInField& entry : sdf::built_in_fields()) {
    const auto made = load_scene(std::string(entry.name));
    ASSERT_TRUE(made) << made.error().message();
    EXPECT_TRUE(facts_of(**made).is_sdf);
    EXPECT_FALSE((*made)->cameras.empty());
    EXPECT_FALSE((*made)->lights.empty());
    const auto names = scene_names();
    EXPECT_NE(std::ranges::find(names, entry.name, &SceneName::name), names.end());
  }
}

TEST(FieldScene, AFileThatIsNotThereIsNamed) {
  const auto missing = load_scene("/nowhere/at_all.sdf.json");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message().find("at_all.sdf.json"), std::string::npos);
}

}  // namespace
}  // namespace macula::scene
