// Scenes made by other people, with the counts their collection states.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "server/scene/load.h"
#include "tests/support/handed_data.h"

namespace macula::scene {
namespace {

struct Stated {
  const char* file;  ///< in scenes/
  std::size_t triangles, emissive, materials;
  double meters_per_unit;
};
std::ostream& operator<<(std::ostream& out, const Stated& stated) {
  return out << stated.file;
}

std::string file_of(const std::string& name) {
  return "scenes/" + name + "/" + name + ".gltf";
}

Result<std::shared_ptr<const Scene>> load_handed(const std::string& name) {
  return load_scene((test::handed_data() / file_of(name)).string());
}

class HandedScene : public testing::TestWithParam<Stated> {};

TEST_P(HandedScene, LoadsWithItsStatedCounts) {
  const Stated& stated = GetParam();
  const std::string file = std::string("scenes/") + stated.file;
  MACULA_NEEDS_HANDED_DATA(file);
  const auto scene = load_scene((test::handed_data() / file).string());
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->triangle_count(), stated.triangles);
  EXPECT_EQ((*scene)->emissive_triangle_count(), stated.emissive);
  EXPECT_EQ((*scene)->materials.size(), stated.materials + 1) << "with the default material";
  EXPECT_EQ((*scene)->settings.meters_per_unit, stated.meters_per_unit);
  EXPECT_TRUE(math::is_valid((*scene)->settings.scene_from_stage));
}
INSTANTIATE_TEST_SUITE_P(
    Each, HandedScene,
    testing::Values(Stated{"crytek_sponza/crytek_sponza.gltf", 262'267, 0, 25, 0.01},
                    Stated{"bistro_interior/bistro_interior.gltf", 202'440, 41'753, 40, 0.01},
                    Stated{"living_room/living_room.gltf", 143'163, 0, 19, 1.0},
                    Stated{"modern_hall/modern_hall.gltf", 31'247, 336, 21, 1.0},
                    Stated{"breakfast_room/breakfast_room.gltf", 269'538, 0, 15, 1.0},
                    Stated{"cornell_box/cornell_box.gltf", 36, 2, 8, 1.0},
                    Stated{"cornell_box/cornell_box.obj", 36, 2, 8, 1.0},
                    Stated{"veach_mis/veach_mis.gltf", 11'956, 11'904, 8, 1.0},
                    Stated{"ignis_direct/Bottom.ply", 2, 0, 0, 1.0},
                    Stated{"ignis_direct/Top.ply", 2, 0, 0, 1.0}),
    [](const auto& stated) {
      std::string name = std::filesystem::path(stated.param.file).filename().string();
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

// The same room in two formats, read by two importers.
TEST(HandedCornellBox, IsTheSameRoomAsGltfAndAsObj) {
  MACULA_NEEDS_HANDED_DATA(file_of("cornell_box"));
  const auto gltf = load_handed("cornell_box");
  const auto obj =
      load_scene((test::handed_data() / "scenes/cornell_box/cornell_box.obj").string());
  ASSERT_TRUE(gltf) << gltf.error().message();
  ASSERT_TRUE(obj) << obj.error().message();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR((*gltf)->bounds().minimum[axis], (*obj)->bounds().minimum[axis], 1e-5);
    EXPECT_NEAR((*gltf)->bounds().maximum[axis], (*obj)->bounds().maximum[axis], 1e-5);
  }
  for (const Material& material : (*gltf)->materials) {
    const auto same = std::find_if((*obj)->materials.begin(), (*obj)->materials.end(),
                                   [&](const Material& m) { return m.name == material.name; });
    if (same == (*obj)->materials.end()) continue;
    EXPECT_NEAR(glm::length(same->base_color - material.base_color), 0.0F, 1e-5F) << material.name;
    EXPECT_NEAR(glm::length(same->emission - material.emission), 0.0F, 1e-4F) << material.name;
    EXPECT_EQ(same->specular, material.specular) << material.name;
  }
}

TEST(HandedCornellBox, KeepsItsMaterialsAndCamera) {
  MACULA_NEEDS_HANDED_DATA(file_of("cornell_box"));
  const auto scene = load_handed("cornell_box");
  ASSERT_TRUE(scene) << scene.error().message();
  const auto named = [&scene](const std::string& name) {
    const auto& all = (*scene)->materials;
    return *std::find_if(all.begin(), all.end(), [&](const Material& m) { return m.name == name; });
  };
  EXPECT_EQ(named("LeftWallBSDF").base_color, Rgb(0.63F, 0.065F, 0.05F));
  EXPECT_EQ(named("RightWallBSDF").base_color, Rgb(0.14F, 0.45F, 0.091F));
  EXPECT_EQ(named("FloorBSDF").specular, 0.0F);
  // Strength 17 times the factor (1, 0.70588, 0.23529): the stated radiance.
  EXPECT_NEAR(glm::length(named("LightBSDF_emitter7").emission - Rgb(17.0F, 12.0F, 4.0F)), 0.0F,
              1e-4F);
  ASSERT_EQ((*scene)->cameras.size(), 1U);
  EXPECT_EQ((*scene)->cameras[0].parent_from_view.position, DVec3(0.0, 1.0, 6.8));
  EXPECT_NEAR(Degrees((*scene)->cameras[0].vertical_fov).value(), 19.5, 1e-6);
}

TEST(HandedBistro, KeepsRadiancesUpToThreeHundredAndPutsTheViewerInside) {
  MACULA_NEEDS_HANDED_DATA(file_of("bistro_interior"));
  const auto scene = load_handed("bistro_interior");
  ASSERT_TRUE(scene) << scene.error().message();
  float brightest = 0.0F;
  for (const Material& m : (*scene)->materials) {
    brightest = std::max({brightest, m.emission.x, m.emission.y, m.emission.z});
  }
  EXPECT_NEAR(brightest, 300.0F, 1e-3F);
  const Bounds bounds = (*scene)->bounds();
  const DVec3 eye = (*scene)->settings.scene_from_stage.transform_point({0.0, 1.6, 0.0});
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(eye[axis], bounds.minimum[axis]);
    EXPECT_LT(eye[axis], bounds.maximum[axis]);
  }
}

TEST(HandedSponza, StandsTheViewerOnTheFloorLookingAlongTheNave) {
  MACULA_NEEDS_HANDED_DATA(file_of("crytek_sponza"));
  const auto scene = load_handed("crytek_sponza");
  ASSERT_TRUE(scene) << scene.error().message();
  const Settings& settings = (*scene)->settings;
  // The court's floor lies at about y = 0 of the file, 1.3 m above the lowest vertex.
  EXPECT_NEAR(settings.scene_from_stage.position.y, 0.0, 0.15);
  EXPECT_NEAR(std::abs(settings.scene_from_stage.transform_direction({0, 0, -1}).x), 1.0, 1e-9);
  EXPECT_FALSE((*scene)->lights.empty()) << "a scene without light is given some";
  EXPECT_GE(settings.guesses.size(), 4U) << "and each guess is stated";
}

}  // namespace
}  // namespace macula::scene
