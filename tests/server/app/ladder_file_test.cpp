#include "server/app/ladder_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "server/kernels/registry.h"

namespace macula::server_app {
namespace {

constexpr const char* kGood = R"(kernel = "ray"
scenes = ["posts"]
[[step]]
quality = 0
scale = 0.3
knobs = "lights=1 ambient=1"
cost = 0.1
rmse = 0.05
[[step]]
quality = 10.0
scale = 1
knobs = ""
cost = 1.0
rmse = 0.02
)";

class LadderFileTest : public testing::Test {
 protected:
  ~LadderFileTest() override { std::filesystem::remove(path_); }
  Result<LadderFile> load(std::string text) {
    std::ofstream(path_) << text;
    return load_ladder_file(path_);
  }
  /// The good file with one line changed.
  std::string error_with(const std::string& from, const std::string& to) {
    std::string text = kGood;
    text.replace(text.find(from), from.size(), to);
    const auto file = load(text);
    return file ? std::string("no error") : file.error().message();
  }
  const std::string path_ =
      testing::TempDir() + "macula_ladder_" + std::to_string(getpid()) + ".toml";
};

TEST_F(LadderFileTest, StepsAreReadAsTheyAreWritten) {
  const auto file = load(kGood);
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_EQ(file->kernel, "ray");
  ASSERT_EQ(file->ladder.steps().size(), 2U);
  const session::QualityStep& step = file->ladder.steps()[0];
  EXPECT_EQ(step.scale, 0.3);
  EXPECT_EQ(step.rmse, 0.05);
  EXPECT_EQ(kernels::text_of(step.knobs), "lights=1 ambient=1");
}

TEST_F(LadderFileTest, WhatIsWrongIsNamedWithItsFile) {
  EXPECT_NE(error_with("scale = 0.3\n", "").find("'scale'"), std::string::npos);
  EXPECT_NE(error_with("cost = 0.1", "cost = \"low\"").find(path_ + ":7"), std::string::npos);
  EXPECT_NE(error_with("cost = 0.1", "cost = 2.0").find("rises"), std::string::npos);
  EXPECT_NE(error_with("lights=1 ", "lights ").find("'lights' is no knob"), std::string::npos);
  EXPECT_NE(error_with("kernel = \"ray\"", "").find("no quality ladder"), std::string::npos);
  EXPECT_NE(error_with("scale = 1", "scale = = 1").find(path_), std::string::npos);
  EXPECT_NE(load_ladder_file("/nowhere.toml").error().message().find("/nowhere.toml"),
            std::string::npos);
}

// What ships is read, fits its kernel, and every step of it can be rendered.
TEST(ShippedLadders, EachKernelTakesEveryStepOfItsOwn) {
  for (const char* kernel : {"ray", "lightcuts", "culling", "sphere"}) {
    const auto file = load_ladder_file(std::string(MACULA_LADDERS) + "/" + kernel + ".toml");
    ASSERT_TRUE(file) << file.error().message();
    EXPECT_EQ(file->kernel, kernel);
    EXPECT_GE(file->ladder.steps().size(), 3U);
    for (const session::QualityStep& step : file->ladder.steps()) {
      EXPECT_GT(step.rmse, 0.0);
      const auto made = kernels::make_kernel(kernel, {}, step.knobs);
      EXPECT_TRUE(made) << kernel << ": " << made.error().message();
    }
  }
}

}  // namespace
}  // namespace macula::server_app
