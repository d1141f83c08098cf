#include "server/kernels/registry.h"

#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "server/scene/load.h"
#include "server/visibility/device_count.h"

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

/// A picture of 16 x 16 cells from the scene's first camera by the kernel that "auto" stands for.
void render_small(const std::shared_ptr<const scene::Scene>& scene) {
  std::vector<std::string_view> registered;
  for (const KernelEntry& entry : kernel_table()) registered.push_back(entry.name);
  const auto chosen =
      scene::choose_kernel(scene::facts_of(*scene), scene::IndirectLight::NotWanted, registered);
  const auto kernel = make_kernel(chosen.kernel, {});
  const auto frame = SceneFrame::create(scene);
  ASSERT_TRUE(kernel && frame);
  View view;
  view.grid = foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), 16, 16});
  view.world_from_view = (*frame)->pose().world_from_view.front();
  const FoveationMap map({{view.grid, view.gaze, DVec2{1e-2}}}, foveation::RateModel{});
  History history;
  FrameBuffers buffers;
  scheduling::TileScheduler scheduler(1);
  (*kernel)->render({{&view, 1}, map, 0, 1}, **frame, history, scheduler, buffers);
  double sum = 0.0;
  for (const Rgb& value : buffers.views.front().radiance.pixels()) sum += value.x;
  EXPECT_GT(sum, 0.0);
}

TEST(KernelRegistry, APictureOfADistanceFieldMakesNoDeviceAndOneOfTrianglesDoes) {
  const auto field = scene::load_scene("columns");
  const auto triangles = scene::load_scene("cornell");
  ASSERT_TRUE(field && triangles);
  const std::uint64_t before = visibility::devices_made();
  render_small(*field);
  EXPECT_EQ(visibility::devices_made(), before);
  render_small(*triangles);
  EXPECT_GT(visibility::devices_made(), before);
}

}  // namespace
}  // namespace macula::kernels
