#include "server/scene/side_file.h"

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/load.h"
#include "server/scene/settle.h"

namespace macula::scene {
namespace {

using test::replaced;
using test::TemporaryFolder;

TEST(SideFile, LiesBesideTheSceneUnderItsName) {
  EXPECT_EQ(side_file_of("/a/b/hall.gltf"), "/a/b/hall.macula.toml");
  EXPECT_EQ(side_file_of("hall.v2.glb"), "hall.v2.macula.toml");
}

TEST(SideFile, EveryKeyIsRead) {
  const TemporaryFolder folder;
  const auto side = read_side_file(folder.write("s.macula.toml", R"(
meters_per_unit = 0.01
exposure_ev = 1.5
tone_curve = "linear"
ambient = [0.1, 0.2, 0.3]
ambient_distance_m = 3
[scene_from_stage]
position_m = [1, 2.5, -3]
yaw_deg = 90.0
[[light]]
kind = "spot"
position_m = [0.0, 3.0, 0.0]
direction = [0.0, -2.0, 0.0]
intensity = [10.0, 9.0, 8.0]
inner_cone_deg = 20.0
outer_cone_deg = 30.0
[[light]]
kind = "directional"
)"));
  ASSERT_TRUE(side) << side.error().message();
  EXPECT_EQ(side->meters_per_unit, 0.01);
  EXPECT_EQ(side->exposure_ev, 1.5F);
  EXPECT_EQ(side->tone_curve, image::ToneCurve::Linear);
  EXPECT_EQ(side->ambient, Rgb(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(side->ambient_distance_m, 3.0);
  ASSERT_TRUE(side->scene_from_stage);
  EXPECT_EQ(side->scene_from_stage->position, DVec3(1.0, 2.5, -3.0));
  // 90 degrees to the left: what was ahead (-z) is now to the left (-x).
  EXPECT_NEAR(side->scene_from_stage->transform_direction({0, 0, -1}).x, -1.0, 1e-12);
  ASSERT_EQ(side->lights.size(), 2U);
  EXPECT_EQ(side->lights[0].kind, LightKind::Spot);
  EXPECT_EQ(side->lights[0].direction, Vec3(0.0F, -1.0F, 0.0F));
  EXPECT_NEAR(Degrees(side->lights[0].outer_cone).value(), 30.0, 1e-12);
  EXPECT_EQ(side->lights[1].kind, LightKind::Directional);
}

TEST(SideFile, NoFileIsAnEmptySideFile) {
  const TemporaryFolder folder;
  const auto side = read_side_file(folder.path() + "/none.macula.toml");
  ASSERT_TRUE(side);
  EXPECT_FALSE(side->meters_per_unit || side->scene_from_stage || side->exposure_ev ||
               side->ambient);
}

struct Mistake {
  const char* text;
  const char* says;
};
class SideFileMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SideFileMistakes, AreNamedWithTheirLine) {
  const TemporaryFolder folder;
  const auto side = read_side_file(folder.write("m.macula.toml", GetParam().text));
  ASSERT_FALSE(side);
  const std::string message = side.error().message();
  EXPECT_NE(message.find("m.macula.toml"), std::string::npos) << message;
  EXPECT_NE(message.find(GetParam().says), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_FALSE(side.error().remedy.empty());
}
INSTANTIATE_TEST_SUITE_P(
    Each, SideFileMistakes,
    testing::Values(Mistake{"exposure_ev = 1\n\nmeter_per_unit = 0.01\n",
                            "line 3: unknown key 'meter_per_unit'"},
                    Mistake{"[scene_from_stage]\nyaw = 3\n", "line 2: unknown key 'yaw'"},
                    Mistake{"[[light]]\ncolour = 3\n", "line 2: unknown key 'colour'"},
                    Mistake{"meters_per_unit = -1.0\n", "line 1: meters_per_unit"},
                    Mistake{"meters_per_unit = nan\n", "line 1: meters_per_unit"},
                    Mistake{"meters_per_unit = \"cm\"\n", "line 1: meters_per_unit"},
                    Mistake{"ambient = [1, 2]\n", "line 1: ambient"},
                    Mistake{"ambient = 3\n", "line 1: ambient"},
                    Mistake{"tone_curve = \"film\"\n", "filmic"},
                    Mistake{"light = 3\n", "line 1: light"},
                    Mistake{"[[light]]\ndirection = [0, 0, 0]\n", "direction"},
                    Mistake{"[scene_from_stage]\nrotation = [0, 0, 0, 0]\n", "quaternion"},
                    Mistake{"exposure_ev = = 3\n", "TOML"},
                    Mistake{"a = 1\nb = '''\xC3'''\n", "no UTF-8 text from byte 13 on"}));

TEST(SideFile, OverridesEveryGuess) {
  // A triangle 2000 units long without light: unit, stage, light and exposure are all guessed,
  // until a side file says them.
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes({0, 0, 0, 2000, 0, 0, 0, 0, -2000}));
  const std::string path = folder.write("t.gltf", test::triangle_json());
  const auto guessed = load_scene(path);
  ASSERT_TRUE(guessed) << guessed.error().message();
  EXPECT_EQ((*guessed)->settings.meters_per_unit, 0.01);
  EXPECT_EQ((*guessed)->settings.guesses.size(), 4U);
  EXPECT_EQ((*guessed)->lights.size(), 1U);
  EXPECT_NEAR((*guessed)->bounds().size().x, 20.0, 1e-9);

  folder.write("t.macula.toml",
               "meters_per_unit = 0.001\nexposure_ev = 2\nambient = [1, 1, 1]\n"
               "[scene_from_stage]\nposition_m = [1, 0, 0]\n");
  const auto stated = load_scene(path);
  ASSERT_TRUE(stated) << stated.error().message();
  EXPECT_TRUE((*stated)->settings.guesses.empty());
  EXPECT_NEAR((*stated)->bounds().size().x, 2.0, 1e-9);
  EXPECT_EQ((*stated)->settings.tone.exposure_ev, 2.0F);
  EXPECT_EQ((*stated)->settings.ambient, Rgb(1.0F));
  EXPECT_EQ((*stated)->settings.scene_from_stage.position, DVec3(1.0, 0.0, 0.0));
  EXPECT_TRUE((*stated)->lights.empty());
}

// Floats lose 8 mm a hundred kilometers away: what a node carries there is brought to the origin,
// and the way back is kept for places that are given in the file's own numbers.
TEST(Settle, ASceneFarFromItsOriginIsBroughtToIt) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  const std::string node = R"("nodes":[{"mesh":0,"translation":[100000.25,-70000,40000]}])";
  const std::string path =
      folder.write("t.gltf", replaced(test::triangle_json(), R"("nodes":[{"mesh":0}])", node));
  const auto far = load_scene(path);
  ASSERT_TRUE(far) << far.error().message();
  EXPECT_LT(glm::length((*far)->settings.scene_from_stage.position), 1.0);
  EXPECT_LT(glm::length((*far)->bounds().centre()), 2.0);
  const DVec3 corner = (*far)->bounds().minimum + (*far)->settings.file_from_scene_m;
  EXPECT_EQ(corner.x, 100000.25);
  EXPECT_FALSE((*far)->settings.guesses.empty());

  folder.write("t.gltf", test::triangle_json());
  const auto near = load_scene(path);
  ASSERT_TRUE(near) << near.error().message();
  EXPECT_EQ((*near)->settings.file_from_scene_m, DVec3{0.0}) << "what is near stays where it is";
}

TEST(Guesses, TakeLargeScenesForCentimetersAndHugeOnesForMillimeters) {
  EXPECT_EQ(guess_meters_per_unit(30.0), 1.0);
  EXPECT_EQ(guess_meters_per_unit(3720.0), 0.01);
  EXPECT_EQ(guess_meters_per_unit(1e5), 0.001);
}

}  // namespace
}  // namespace macula::scene
