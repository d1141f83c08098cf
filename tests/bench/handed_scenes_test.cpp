// Scenes made by other people, from their files to a first picture: what that costs.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/handed_data.h"
#include "tests/support/measured_program.h"

namespace macula::bench {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kInstrumented = true;
#else
constexpr bool kInstrumented = false;
#endif

class HandedSceneProgram : public testing::TestWithParam<const char*> {};

TEST_P(HandedSceneProgram, IsReadBuiltAndShownInTwoSecondsOfProcessorTime) {
  const std::string file = std::string("scenes/") + GetParam();
  MACULA_NEEDS_HANDED_DATA(file);
  const std::string out = testing::TempDir() + "macula_handed_scene.png";
  const auto run =
      test::run_measured({MACULA_BENCH_PROGRAM, "still", "--scene",
                          (test::handed_data() / file).string(), "--size", "16x16", "--out", out});
  EXPECT_EQ(run.status, 0) << run.output;
  if (!kInstrumented) {
    EXPECT_LE(run.cpu_s, 2.0);
  }
  RecordProperty("cpu_ms", static_cast<int>(1e3 * run.cpu_s));
  RecordProperty("peak_mb", static_cast<int>(run.peak_memory_mb));
  std::filesystem::remove(out);
}
INSTANTIATE_TEST_SUITE_P(
    Each, HandedSceneProgram,
    testing::Values("crytek_sponza/crytek_sponza.gltf", "bistro_interior/bistro_interior.gltf",
                    "living_room/living_room.gltf", "modern_hall/modern_hall.gltf",
                    "breakfast_room/breakfast_room.gltf", "cornell_box/cornell_box.gltf",
                    "cornell_box/cornell_box.obj", "veach_mis/veach_mis.gltf",
                    "ignis_direct/Bottom.ply", "ignis_direct/Top.ply"),
    [](const auto& file) {
      std::string name = std::filesystem::path(file.param).filename().string();
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

}  // namespace
}  // namespace macula::bench
