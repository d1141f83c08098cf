#include "server/kernels/registry.h"

#include <set>

#include <gtest/gtest.h>

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
  options.bounces = 1;
  EXPECT_TRUE(make_kernel("brute", options));
  const auto refused = make_kernel("ray", options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("bounces"), std::string::npos);
}

}  // namespace
}  // namespace macula::kernels
