#include "tests/bench/report_page.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "shared/image/png.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

namespace fs = std::filesystem;

class ReportPage : public testing::Test {
 protected:
  ReportPage() { fs::create_directories(folder_); }
  ~ReportPage() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string page(const std::vector<std::string>& inputs) const {
    const auto done = run_report_page({inputs, path("page.html")});
    EXPECT_TRUE(done) << done.error().message();
    std::ifstream in(path("page.html"));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("macula_page_" + std::to_string(getpid()));
};

Report tradeoff_of(const std::string& pictures) {
  Report report{"tradeoff", {{"pictures", pictures}}, {}};
  for (const bool uniform : {true, false})
    for (const double ms : {1.0, 10.0})
      report.rows.push_back({{"kernel", std::string("ray")},
                             {"scene", std::string("a</script>b")},
                             {"config", std::string("scale=1")},
                             {"cpu_ms", ms},
                             {"rmse_f10", (uniform ? 1.0 : 0.5) / ms},
                             {"rmse_ew", 1.0 / ms},
                             {"flip_out10", 1.0 / ms},
                             {"uniform", uniform},
                             {"on_front", !uniform},
                             {"scene_hash", std::string("0123456789abcdef")},
                             {"picture", std::string("one.png")}});
  return report;
}

TEST_F(ReportPage, NeedsNothingFromOutside) {
  ASSERT_TRUE(image::write_png(path("one.png"), image::Plane<Rgb8>(4, 4)));
  ASSERT_TRUE(write_json(path("tradeoff.json"), tradeoff_of(folder_.string())));
  const std::string html = page({folder_.string()});
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "url(", "<link"})
    EXPECT_FALSE(holds(html, outside)) << outside;
  EXPECT_TRUE(holds(html, "iVBORw0KGgo")) << "the picture is in the page";
}

TEST_F(ReportPage, TellsTheCommandMachineCommitAndScene) {
  ASSERT_TRUE(write_json(path("tradeoff.json"), tradeoff_of("")));
  const std::string html = page({path("tradeoff.json")});
  for (const char* part : {"test_bench", "commit", "cores", "0123456789abcdef", "Weier"})
    EXPECT_TRUE(holds(html, part)) << part;
}

TEST_F(ReportPage, NamesFromReportsCannotEndItsScripts) {
  ASSERT_TRUE(write_json(path("tradeoff.json"), tradeoff_of("")));
  const std::string html = page({path("tradeoff.json")});
  EXPECT_FALSE(holds(html, "a</script>b"));
  EXPECT_TRUE(holds(html, "a<\\/script>b"));
  EXPECT_TRUE(holds(html, "a&lt;/script&gt;b"));
}

TEST_F(ReportPage, AnyExperimentHasItsTable) {
  ASSERT_TRUE(
      write_json(path("codecs.json"), {"codecs", {}, {{{"bytes", 12345.0}, {"db", 40.0}}}}));
  EXPECT_TRUE(holds(page({path("codecs.json")}), "12345"));
}

TEST_F(ReportPage, WhatCouldNotBeMeasuredIsADash) {
  ASSERT_TRUE(write_json(path("codecs.json"),
                         {"codecs", {}, {{{"bytes", 1.0}, {"gain_db", std::nan("")}}}}));
  const std::string html = page({path("codecs.json")});
  EXPECT_TRUE(holds(html, "<td>\u2013</td>"));
  EXPECT_FALSE(holds(html, "<td>nan</td>"));
}

// Files are read by name; the page begins with what sums up and ends with what it does not know.
TEST_F(ReportPage, BeginsWithTheTradeOff) {
  for (const char* experiment : {"a-new-one", "codecs", "tradeoff"})
    ASSERT_TRUE(write_json(path(std::string(experiment) + ".json"),
                           {experiment, {}, {{{"scene", std::string("x")}, {"cpu_ms", 1.0}}}}));
  const std::string html = page({folder_.string()});
  const auto place = [&](const char* name) { return html.find(std::string("<h2>") + name); };
  EXPECT_LT(place("tradeoff"), place("codecs"));
  EXPECT_LT(place("codecs"), place("a-new-one"));
  EXPECT_NE(place("a-new-one"), std::string::npos);
}

TEST_F(ReportPage, SaysWhatAnExperimentShows) {
  ASSERT_TRUE(write_json(path("codecs.json"),
                         {"codecs", {}, {{{"codec", std::string("jpeg")}, {"psnr_f10_db", 1.0}}}}));
  const std::string html = page({path("codecs.json")});
  EXPECT_TRUE(holds(html, "Colour on its way"));
  EXPECT_TRUE(holds(html, "data-series=\"codec\""));
}

TEST_F(ReportPage, WhatIsNoReportIsNamed) {
  std::ofstream(path("odd.json")) << "[]";
  const auto done = run_report_page({{path("odd.json")}, path("page.html")});
  ASSERT_FALSE(done);
  EXPECT_TRUE(holds(done.error().message(), "odd.json"));
  EXPECT_FALSE(run_report_page({{path("nothing.json")}, path("page.html")}));
  EXPECT_FALSE(run_report_page({{folder_.string() + "/none"}, path("page.html")}));
}

}  // namespace
}  // namespace macula::bench
