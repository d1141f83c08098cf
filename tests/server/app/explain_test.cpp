// --explain as a user reads it: what is built and run for a scene, what is left out, and why. Eight
// scenes and more; that forcing what is left out changes no pixel is held in tests/conformance.
#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "shared/image/png.h"
#include "tests/server/scene/gltf_file.h"
#include "tests/support/handed_data.h"
#include "tests/support/measured_program.h"

namespace macula {
namespace {

using scene::test::replaced;
using scene::test::TemporaryFolder;

struct Explained {
  test::MeasuredRun run;
  std::map<std::string, bool> used;           ///< by step
  std::map<std::string, std::string> reason;  ///< by step
};

Explained explain(const std::string& scene, std::vector<std::string> more = {}) {
  const TemporaryFolder keys;
  std::vector<std::string> arguments{
      MACULA_SERVER_PROGRAM, "--explain", "--scene", scene, "--keys", keys.path()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Explained explained{test::run_measured(arguments), {}, {}};
  std::istringstream lines(explained.run.output);
  for (std::string line; std::getline(lines, line);) {
    const bool used = line.starts_with("  used      "), left = line.starts_with("  left out  ");
    if (!used && !left) continue;
    const std::size_t colon = line.find(": ");
    const std::string step = line.substr(12, colon - 12);
    explained.used[step] = used;
    explained.reason[step] = line.substr(colon + 2);
  }
  return explained;
}

constexpr const char* kPaint = R"({"name":"paint"})";
constexpr const char* kMatt = R"("extensions":{"KHR_materials_specular":{"specularFactor":0}},)"
                              R"("pbrMetallicRoughness":{"metallicFactor":0})";

/// The triangle in one material, lit by the side file's lamp unless `side` says otherwise.
struct OwnScene {
  std::string material = std::string("{") + kMatt + "}";
  std::string side = "[[light]]\nposition_m = [0.0, 0.0, 5.0]\n";
  std::string more = "";  ///< JSON behind the material list

  std::string write(const TemporaryFolder& folder) const {
    folder.write("t.bin", scene::test::triangle_bytes());
    folder.write("own.macula.toml", side);
    EXPECT_TRUE(
        image::write_png(folder.path() + "/a.png", image::Plane<Rgb8>(2, 2, Rgb8{9, 9, 9})));
    return folder.write("own.gltf",
                        replaced(scene::test::triangle_json(), kPaint, material + more));
  }
};

const std::string kTexture =
    R"(],"images":[{"uri":"a.png"}],"textures":[{"source":0}],"extras":[{})";

struct Expected {
  const char* name;
  OwnScene scene;
  std::vector<std::string> used;  ///< every other step is left out
};
const Expected kOwn[] = {
    {"MattUnderALamp", {}, {"triangle BVH", "point, spot and directional lights"}},
    {"Metal",
     {.material = R"({"pbrMetallicRoughness":{"metallicFactor":1}})"},
     {"triangle BVH", "specular lobe", "point, spot and directional lights"}},
    {"Textured",
     {.material = std::string("{") + kMatt + R"(,"emissiveTexture":{"index":0}})",
      .more = kTexture},
     {"triangle BVH", "texture mip maps", "point, spot and directional lights"}},
    {"Masked",
     {.material =
          R"({"extensions":{"KHR_materials_specular":{"specularFactor":0}},"alphaMode":"MASK",)"
          R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0}}})",
      .more = kTexture},
     {"triangle BVH", "alpha test", "texture mip maps", "point, spot and directional lights"}},
    {"MaskedByNothing",
     {.material = std::string("{") + kMatt + R"(,"alphaMode":"MASK"})"},
     {"triangle BVH", "point, spot and directional lights"}},
    {"AreaLight",
     {.material = std::string("{") + kMatt + R"(,"emissiveFactor":[1,1,1]})", .side = ""},
     {"triangle BVH", "area-light table and sampling"}},
    {"AmbientOnly", {.side = "ambient = [1.0, 1.0, 1.0]\n"}, {"triangle BVH", "ambient occlusion"}},
};

/// What no mesh shows does not count: glTF's default material, metallic and rough, is in all of
/// them.
class ExplainedScene : public testing::TestWithParam<Expected> {};

TEST_P(ExplainedScene, UsesExactlyWhatItNeedsAndSaysWhy) {
  const TemporaryFolder folder;
  const Explained explained = explain(GetParam().scene.write(folder));
  ASSERT_EQ(explained.run.status, 0) << explained.run.output;
  EXPECT_GE(explained.used.size(), 9U);
  for (const auto& [step, used] : explained.used) {
    const auto& wanted = GetParam().used;
    EXPECT_EQ(used, std::find(wanted.begin(), wanted.end(), step) != wanted.end())
        << step << ": " << explained.reason.at(step);
    EXPECT_FALSE(explained.reason.at(step).empty()) << step;
  }
}
INSTANTIATE_TEST_SUITE_P(Each, ExplainedScene, testing::ValuesIn(kOwn),
                         [](const auto& expected) { return std::string(expected.param.name); });

TEST(Explain, ACornellBoxNeedsItsAreaLightAndNoSpecularLobe) {
  const Explained cornell = explain("cornell");
  EXPECT_TRUE(cornell.used.at("area-light table and sampling"));
  EXPECT_FALSE(cornell.used.at("specular lobe"));
}

TEST(Explain, WhatIsAskedForCountsToo) {
  EXPECT_TRUE(explain("posts").used.at("ambient occlusion"));
  const Explained without = explain("posts", {"--ambient-samples", "0"});
  EXPECT_FALSE(without.used.at("ambient occlusion"));
  EXPECT_EQ(without.reason.at("ambient occlusion"), "0 ambient samples are asked for");
}

TEST(Explain, HandedScenesAreExplainedByTheirCounts) {
  MACULA_NEEDS_HANDED_DATA("scenes/bistro_interior/bistro_interior.gltf");
  const auto path = test::handed_data() / "scenes/bistro_interior/bistro_interior.gltf";
  const Explained bistro = explain(path.string());
  EXPECT_EQ(bistro.reason.at("area-light table and sampling"), "41753 emissive triangles");
  EXPECT_EQ(bistro.reason.at("triangle BVH"), "202440 triangles");
  EXPECT_NE(bistro.run.output.find("assumed: meters_per_unit = 0.01"), std::string::npos);
}

}  // namespace
}  // namespace macula
