#include "server/kernels/registry.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "server/scene/load.h"

namespace macula::kernels {
namespace {

TEST(KernelRegistry, AnUnknownNameAnswersWithTheNamesThereAre) {
  const auto made = make_kernel("lightspeed", {});
  ASSERT_FALSE(made);
  const std::string message = made.error().message();
  EXPECT_NE(message.find("lightspeed"), std::string::npos);
  for (const KernelEntry& entry : kernel_table()) {
    EXPECT_NE(message.find(entry.name), std::string::npos) << message;
  }
  EXPECT_EQ(made.error().exit_status(), 2);
}

TEST(KernelRegistry, EveryNameIsUniqueAndMakesAKernel) {
  std::set<std::string_view> names;
  for (const KernelEntry& entry : kernel_table()) {
    EXPECT_TRUE(names.insert(entry.name).second);
    EXPECT_TRUE(make_kernel(entry.name, {}));
  }
}

TEST(KernelRegistry, OptionsOutOfRangeAreRefusedByName) {
  KernelOptions options;
  options.samples_per_cell = 0;
  EXPECT_FALSE(make_kernel("ray", options));
  options = {};
  options.area_light_samples = 0;
  EXPECT_FALSE(make_kernel("brute", options));
  options = {};
  options.ambient_samples = -1;
  EXPECT_FALSE(make_kernel("ray", options));
  options = {};
  options.samples_per_cell = 17;
  EXPECT_TRUE(make_kernel("ray", options));
  EXPECT_FALSE(make_kernel("sphere", options));
  options = {};
  options.bounces = 1;
  EXPECT_TRUE(make_kernel("brute", options));
  const auto refused = make_kernel("ray", options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("bounces"), std::string::npos);
}

TEST(KernelRegistry, AKernelIsOnlyGivenScenesOfItsKind) {
  const auto field = scene::load_scene("primitives");
  const auto triangles = scene::load_scene("cornell");
  ASSERT_TRUE(field && triangles);
  EXPECT_TRUE(check_scene("sphere", **field));
  for (const char* kernel : {"ray", "lightcuts", "brute"}) {
    EXPECT_TRUE(check_scene(kernel, **triangles)) << kernel;
    EXPECT_TRUE(check_scene(kernel, **field)) << kernel;
  }
  const auto refused = check_scene("sphere", **triangles);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("lightcuts"), std::string::npos);
}

TEST(KernelRegistry, AutoRendersADistanceFieldWithSphereAndBuildsNoTriangleDevice) {
  const auto field = scene::load_scene("columns");
  ASSERT_TRUE(field);
  std::vector<std::string_view> registered;
  for (const KernelEntry& entry : kernel_table()) registered.push_back(entry.name);
  const scene::SceneFacts facts = scene::facts_of(**field);
  EXPECT_EQ(scene::choose_kernel(facts, scene::IndirectLight::NotWanted, registered).kernel,
            "sphere");
  EXPECT_FALSE(scene::ScenePlan(facts).has(scene::Step::TriangleBvh));
  const auto frame = SceneFrame::create(*field);
  ASSERT_TRUE(frame);
  EXPECT_FALSE((*frame)->triangles().has_device());
}

}  // namespace
}  // namespace macula::kernels
