#include "server/kernels/knobs.h"

#include <gtest/gtest.h>

#include "server/kernels/registry.h"

namespace macula::kernels {
namespace {

Result<std::unique_ptr<Kernel>> turned(const char* kernel, const char* knobs) {
  return make_kernel(kernel, {}, *parse_knobs(knobs));
}

TEST(Knobs, WordsAreReadAndWrittenBack) {
  const auto knobs = parse_knobs("kept=512  space=cells ");
  ASSERT_TRUE(knobs);
  EXPECT_EQ(*knobs, (KnobValues{{"kept", "512"}, {"space", "cells"}}));
  EXPECT_EQ(text_of(*knobs), "kept=512 space=cells");
  EXPECT_TRUE(parse_knobs("")->empty());
}

TEST(Knobs, WhatIsNoWordIsRefused) {
  for (const char* text : {"kept", "=512", "kept="}) EXPECT_FALSE(parse_knobs(text)) << text;
}

TEST(Knobs, EveryKernelTakesItsOwn) {
  EXPECT_TRUE(turned("ray", "samples=4 lights=1 method=foveated support=3.5 mask=independent"));
  EXPECT_TRUE(turned("lightcuts", "nodes=4 sizes=perceived source=reservoirs denoise=yes"));
  EXPECT_TRUE(turned("culling", "kept=256 hiding=lamp-maps space=log-polar classes=16 asked=0"));
  EXPECT_TRUE(turned("sphere", "samples=16 fovea=5 refresh=4 tracing=full-best edges=shaded"));
}

TEST(Knobs, AnUnknownOneAnswersWithTheList) {
  const auto made = turned("ray", "kept=512");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message().find("samples, lights"), std::string::npos);
  EXPECT_FALSE(turned("brute", "samples=4"));
}

TEST(Knobs, AValueOutOfRangeAnswersWithWhatIsAllowed) {
  const auto made = turned("sphere", "samples=17");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message().find("1 to 16"), std::string::npos);
  for (const char* knobs : {"samples=0", "samples=four", "samples=4.5", "samples=4x", "samples=-1",
                            "budget=nan", "method=fast", "k_max=0.01"})
    EXPECT_FALSE(turned("ray", knobs)) << knobs;
  for (const char* knobs : {"classes=3", "kept=0", "points=0", "map=0"})
    EXPECT_FALSE(turned("culling", knobs)) << knobs;
}

}  // namespace
}  // namespace macula::kernels
