#include "tests/bench/culling_equal_time.h"

#include <gtest/gtest.h>

namespace macula::bench {
namespace {

Fields row(const std::string& method, double cpu_ms, double rmse,
           const std::string& scene = "nave") {
  return {{"scene", scene},     {"motion", std::string("both")},
          {"method", method},   {"asked_for", std::int64_t{1024}},
          {"rmse_in150", rmse}, {"rmse_out150", 2.0 * rmse},
          {"cpu_ms", cpu_ms}};
}

double over(const std::vector<Fields>& told, const std::string& rival) {
  for (const Fields& fields : told)
    if (std::get<std::string>(value_in(fields, "rival")) == rival)
      return std::get<double>(value_in(fields, "over_in150"));
  return -1.0;
}

// power's error falls as chance does, fir's has come to the end of its fall: what it leaves out
// stays at any time. One point of either, carried over by the root of time, would say 1.41 for
// both.
TEST(CullingEqualTime, ReadsRivalsOffTheirCurves) {
  const std::vector<Fields> rows{row("flc", 200.0, 0.01), row("power", 100.0, 0.02),
                                 row("power", 400.0, 0.01), row("fir", 100.0, 0.02),
                                 row("fir", 400.0, 0.02)};
  const auto told = errors_at_equal_time(rows);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NEAR(over(told, "power"), 1.4142, 1e-3);
  EXPECT_NEAR(over(told, "fir"), 2.0, 1e-3);
}

TEST(CullingEqualTime, EndsWithTheGeometricMeansOfWhatWasMetOften) {
  const std::vector<Fields> rows{
      row("flc", 100.0, 0.01),           row("power", 100.0, 0.02),
      row("power", 400.0, 0.01),         row("flc", 100.0, 0.01, "city"),
      row("power", 100.0, 0.08, "city"), row("power", 400.0, 0.04, "city")};
  const auto told = errors_at_equal_time(rows);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(std::get<std::string>(value_in(told[2], "scene")), "(mean)");
  EXPECT_NEAR(std::get<double>(value_in(told[2], "over_in150")), 4.0, 1e-9);  // of 2 and 8
}

TEST(CullingEqualTime, SaysNothingOfOnePointAnotherSceneOrAnEarlierTime) {
  EXPECT_TRUE(errors_at_equal_time({row("flc", 200.0, 0.01), row("power", 100.0, 0.02)}).empty());
  EXPECT_TRUE(errors_at_equal_time(
                  {row("flc", 50.0, 0.01), row("power", 100.0, 0.02), row("power", 400.0, 0.01)})
                  .empty());
  EXPECT_TRUE(errors_at_equal_time({row("flc", 200.0, 0.01), row("power", 100.0, 0.02, "city"),
                                    row("power", 400.0, 0.01, "city")})
                  .empty());
}

}  // namespace
}  // namespace macula::bench
