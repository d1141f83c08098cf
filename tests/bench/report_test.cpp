#include "tests/bench/report.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace macula::bench {
namespace {

TEST(Report, PrintsAlignedColumnsUnderTheirNames) {
  const std::string text = table_text({{{"name", std::string("a")}, {"time_ms", 1.25}},
                                       {{"name", std::string("longer")}, {"time_ms", 100.0}}});
  EXPECT_EQ(text,
            "  name  time_ms\n"
            "     a     1.25\n"
            "longer      100\n");
  EXPECT_EQ(table_text({}), "");
}

TEST(Report, WritesItsFieldsInOrderAndNullForNan) {
  const std::string file = (std::filesystem::path(testing::TempDir()) /
                            ("macula_report_" + std::to_string(getpid()) + ".json"))
                               .string();
  const Report report{"compare",
                      {{"ppd", 20.0}, {"quick", true}},
                      {{{"ssim", std::numeric_limits<double>::quiet_NaN()},
                        {"frames", std::int64_t{3}},
                        {"scene", std::string("a \"b\"")}}}};
  ASSERT_TRUE(write_json(file, report));
  std::ifstream in(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(file);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  EXPECT_TRUE(text.starts_with(R"({"experiment":"compare","machine":{"cpu":)")) << text;
  EXPECT_NE(text.find(R"("cores":)"), std::string::npos);
  EXPECT_NE(text.find(R"("isa":")"), std::string::npos);
  EXPECT_NE(text.find(R"("commit":")"), std::string::npos);
  EXPECT_NE(text.find(R"("config":{"ppd":20.0,"quick":true})"), std::string::npos) << text;
  EXPECT_NE(text.find(R"("rows":[{"ssim":null,"frames":3,"scene":"a\"b\""}]})"), std::string::npos)
      << text;
}

TEST(Report, SaysWhereItCannotBeWritten) {
  const auto result = write_json("/nonexistent-folder/report.json", {"compare", {}, {}});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message().find("/nonexistent-folder/report.json"), std::string::npos);
}

}  // namespace
}  // namespace macula::bench
