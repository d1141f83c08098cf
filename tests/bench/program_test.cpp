// macula-bench as a person runs it.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/exr/exr.h"
#include "shared/image/png.h"
#include "tests/bench/run_program.h"
#include "tests/support/handed_data.h"

namespace macula::bench {
namespace {

using image::Plane;
namespace fs = std::filesystem;

Finished bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), MACULA_BENCH_PROGRAM);
  return run_program(arguments);
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
bool is_one_line(const std::string& text) {
  return std::ranges::count(text, '\n') == 1 && text.ends_with('\n');
}

/// The one row under the header.
std::map<std::string, double> row_of(const std::string& table) {
  std::istringstream lines(table);
  std::string header, values;
  std::getline(lines, header);
  std::getline(lines, values);
  std::istringstream names(header), numbers(values);
  std::map<std::string, double> row;
  std::string name, number;
  while (names >> name && numbers >> number) row[name] = std::stod(number);
  return row;
}

class Program : public testing::Test {
 protected:
  Program() : folder_(fs::path(testing::TempDir()) / ("macula_bench_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Program() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string grey_png(const std::string& name, std::uint8_t value, int width = 32) const {
    EXPECT_TRUE(image::write_png(path(name), Plane<Rgb8>(width, 24, Rgb8{value, value, value})));
    return path(name);
  }
  std::string grey_exr(const std::string& name, float value) const {
    EXPECT_TRUE(exr::write(path(name), Plane<Rgb>(32, 24, Rgb{value})));
    return path(name);
  }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  fs::path folder_;
};

TEST_F(Program, ListsTheExperimentsWhenItDoesNotKnowOne) {
  const Finished run = bench({"compair", "a.png", "b.png"});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_TRUE(contains(run.err, "compair") && contains(run.err, "compare")) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST_F(Program, ExplainsItself) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"compare", "--help"}}) {
    const Finished run = bench(arguments);
    EXPECT_EQ(run.status, 0);
    EXPECT_TRUE(contains(run.out, "compare")) << run.out;
    EXPECT_EQ(run.err, "");
  }
}

TEST_F(Program, RefusesBadArgumentsWithOneLine) {
  const std::string a = grey_png("a.png", 100);
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"compare"},
                                                    {"compare", a, a, "--ppd", "-3"},
                                                    {"compare", a, a, "--ppd", "x"},
                                                    {"compare", a, a, "--gaze", "12"},
                                                    {"compare", a, a, "--no-such-option"}}) {
    const Finished run = bench(arguments);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    EXPECT_EQ(run.out, "");
  }
}

TEST_F(Program, RefusesAStillThatCannotBeMeant) {
  const std::vector<std::string> fine = {"still", "--scene", "cornell", "--out", path("a.png")};
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--size", "0x0"},
                                                {"--mode", "quick"},
                                                {"--aov", "depth,smell"},
                                                {"--camera", "0,0,0;0,0,0;0,1,0;60"},
                                                {"--gaze", "200,0"},
                                                {"--bounces", "2"}}) {
    std::vector<std::string> arguments = fine;
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    const Finished run = bench(arguments);
    EXPECT_EQ(run.status, 2) << wrong[0];
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    EXPECT_TRUE(contains(run.err, wrong[0])) << run.err;
  }
  EXPECT_EQ(bench({"still", "--out", path("a.png")}).status, 2) << "no scene";
}

TEST_F(Program, WritesAStillWithItsPlanesAsOneExrAndAPictureAPlane) {
  const Finished run =
      bench({"still", "--scene", "cornell", "--size", "24x16", "--spp", "4", "--aov",
             "depth,normal,albedo,id,rate,samples,variance", "--out", path("still.exr")});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto row = row_of(run.out);
  // Channel names stand in the header as text, in alphabetical order.
  const std::string bytes = text_of(path("still.exr"));
  for (const char* channel :
       {"R", "G", "B", "depth.Z", "normal.X", "normal.Y", "normal.Z", "albedo.R", "albedo.G",
        "albedo.B", "id.Y", "rate.Y", "samples.Y", "variance.Y"}) {
    EXPECT_TRUE(contains(bytes, std::string(channel) + '\0')) << channel;
  }
  const auto beauty = exr::read(path("still.exr"));
  ASSERT_TRUE(beauty) << beauty.error().message();
  double mean = 0.0;
  for (const Rgb& pixel : beauty->pixels()) mean += pixel.x / (24.0 * 16.0);
  EXPECT_NEAR(mean, row.at("mean_r"), 1e-3 * mean) << "R, G, B are the beauty, not a plane";
  for (const char* plane : {"depth", "normal", "albedo", "id", "rate", "samples", "variance"}) {
    EXPECT_TRUE(image::read_png(path(std::string("still.") + plane + ".png"))) << plane;
  }
}

TEST_F(Program, PutsScenesOnOneSheetWithTheirFigures) {
  const Finished run = bench({"contact-sheet", "--scenes", "cornell,posts", "--size", "48x32",
                              "--spp", "1", "--lspp", "1", "--columns", "2", "--out",
                              path("sheet.png"), "--json", path("sheet.json")});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "cornell") && contains(run.out, "posts")) << run.out;
  const auto sheet = image::read_png(path("sheet.png"));
  ASSERT_TRUE(sheet);
  EXPECT_EQ(sheet->width(), 2 * 48 + 4) << "two tiles and the gap between them";
  EXPECT_GT(sheet->height(), 32) << "a line of text under each";
  EXPECT_TRUE(contains(text_of(path("sheet.json")), "\"primary_mrays_per_cpu_s\""));
  const Finished wrong =
      bench({"contact-sheet", "--scenes", "cornell,nowhere", "--out", path("sheet.png")});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(contains(wrong.err, "nowhere")) << wrong.err;
}

/// Rows of a table by column, in order; words are 0.
std::vector<std::map<std::string, double>> rows_of(const std::string& table) {
  std::istringstream lines(table);
  std::string header, line;
  std::getline(lines, header);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(lines, line)) {
    std::istringstream names(header), values(line);
    auto& row = rows.emplace_back();
    std::string name, value;
    while (names >> name && values >> value) row[name] = std::strtod(value.c_str(), nullptr);
  }
  return rows;
}

/// Pictures of 180 x 200 pixels: rows and columns, not their figures.
std::vector<std::string> small_sphere(const std::string& json, const std::string& methods) {
  return {"sphere",  "--scenes",     "primitives", "--size",    "180x200",  "--ssaa", "1",
          "--fovea", "7.5",          "--refresh",  "1,4",       "--frames", "3",      "--threads",
          "1",       "--key-frames", "1",          "--methods", methods,    "--json", json};
}

TEST_F(Program, SphereMakesARowForEveryMethodFoveaAndRefresh) {
  const Finished run = bench(small_sphere(path("s.json"), "full,ipr,fipr"));
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream header(run.out.substr(0, run.out.find('\n')));
  const std::vector<std::string> columns(std::istream_iterator<std::string>(header), {});
  EXPECT_EQ(columns, (std::vector<std::string>{
                         "scene", "method", "fovea_deg", "ssaa", "refresh", "edges", "views",
                         "evals_per_px", "evals_s", "fma_share", "cpu_ms", "wall_ms", "speedup",
                         "speedup_best", "ssim", "flip", "flip_fovea", "wrong_hits"}));
  const auto rows = rows_of(run.out);
  ASSERT_EQ(rows.size(), 4U) << run.out;
  EXPECT_EQ(rows[0].at("speedup"), 1.0) << "full is its own baseline";
  EXPECT_EQ(rows[0].at("flip"), 0.0);
  EXPECT_EQ(rows[2].at("refresh"), 1.0);
  EXPECT_EQ(rows[3].at("refresh"), 0.25);
  EXPECT_LT(rows[1].at("evals_per_px"), rows[0].at("evals_per_px"));
  EXPECT_LT(rows[3].at("evals_per_px"), rows[2].at("evals_per_px"));
  for (const auto& row : rows) {
    EXPECT_GT(row.at("ssim"), 0.7) << run.out;
    EXPECT_GT(row.at("fma_share"), 0.0) << run.out;
    EXPECT_LT(row.at("fma_share"), 1.0) << run.out;
  }
}

TEST_F(Program, SphereMeasuresOnlyRowsThatItsReportLacks) {
  const std::string json = path("resumed.json");
  const Finished first = bench(small_sphere(json, "full,ipr"));
  ASSERT_EQ(first.status, 0) << first.err;
  const std::string report = text_of(json);
  const Finished again = bench(small_sphere(json, "full,ipr"));
  EXPECT_EQ(again.out, first.out) << "times and all: nothing was measured";
  EXPECT_EQ(text_of(json), report);
  const Finished more = bench(small_sphere(json, "full,ipr,full_best"));
  ASSERT_EQ(more.status, 0) << more.err;
  const auto before = rows_of(first.out), after = rows_of(more.out);
  ASSERT_EQ(after.size(), 3U) << more.out;
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(after[i].at("cpu_ms"), before[i].at("cpu_ms")) << "row " << i << " is kept";

  const auto other_size = [&] {
    std::vector<std::string> arguments = small_sphere(json, "full");
    *std::ranges::find(arguments, "180x200") = "180x202";
    return bench(arguments);
  }();
  EXPECT_EQ(other_size.status, 2) << "a report of other pictures is not mixed in";
  EXPECT_TRUE(contains(other_size.err, json)) << other_size.err;
}

TEST_F(Program, SphereRefusesWhatIsNoField) {
  const Finished triangles = bench({"sphere", "--scenes", "cornell", "--size", "180x200"});
  EXPECT_EQ(triangles.status, 2);
  EXPECT_TRUE(contains(triangles.err, "distance field")) << triangles.err;
  const Finished method =
      bench({"sphere", "--scenes", "primitives", "--size", "180x200", "--methods", "fast"});
  EXPECT_EQ(method.status, 2);
  EXPECT_TRUE(contains(method.err, "full_best")) << method.err;
}

TEST_F(Program, NamesAMissingPictureAndWhatToDo) {
  const std::string a = grey_png("a.png", 100);
  for (const char* name : {"missing.png", "missing.exr"}) {
    const Finished run = bench({"compare", a, path(name)});
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    EXPECT_TRUE(contains(run.err, path(name))) << run.err;
    EXPECT_TRUE(run.err.ends_with(")\n")) << "a remedy in brackets: " << run.err;
  }
}

TEST_F(Program, RefusesUnreadableUnequalAndUnknownPictures) {
  const std::string a = grey_png("a.png", 100), narrow = grey_png("narrow.png", 100, 31);
  std::ofstream(path("text.png")) << "not a picture";
  std::ofstream(path("text.exr")) << "not a picture";
  std::ofstream(path("picture.bmp")) << "BM";
  EXPECT_TRUE(exr::write(path("nan.exr"), Plane<Rgb>(32, 24, Rgb{0.0F / 0.0F})));
  for (const std::string& other : {narrow, path("text.png"), path("text.exr"), path("picture.bmp"),
                                   path("nan.exr"), path("")}) {
    const Finished run = bench({"compare", a, other});
    EXPECT_EQ(run.status, 2) << other << ": " << run.err;
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
  }
  EXPECT_TRUE(contains(bench({"compare", a, narrow}).err, "31x24")) << "both sizes are named";
}

TEST_F(Program, ComparesTwoGreysByTheirClosedForms) {
  // 8-bit 100 and 120 are .127438 and .187821 in linear light.
  const Finished run = bench({"compare", grey_png("a.png", 100), grey_png("b.png", 120)});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto row = row_of(run.out);
  ASSERT_EQ(row.size(), 9U) << run.out;
  EXPECT_NEAR(row.at("rmse"), 0.187821 - 0.127438, 1e-5);
  EXPECT_NEAR(row.at("psnr_db"), 22.110204, 1e-3);
  EXPECT_NEAR(row.at("ew_psnr_db"), 22.110204, 1e-3) << "weights do not matter for a constant";
  EXPECT_NEAR(row.at("ssim"), 0.98361092, 1e-5);
}

TEST_F(Program, WritesAReportAndAnErrorMap) {
  const Finished run =
      bench({"compare", grey_png("a.png", 0), grey_png("b.png", 255), "--ppd", "20", "--gaze",
             "3,4.5", "--json", path("report.json"), "--map", path("map.png")});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string report = text_of(path("report.json"));
  for (const char* part :
       {"\"experiment\": \"compare\"", "\"machine\"", "\"commit\"", "\"pixels_per_degree\": 20.0",
        "\"gaze_y_px\": 4.5", "\"rows\"", "\"gp_psnr_db\"", "\"ssim_rgb\""}) {
    EXPECT_TRUE(contains(report, part)) << part << "\n" << report;
  }
  const auto map = image::read_png(path("map.png"));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->width(), 32);
}

TEST_F(Program, JudgesTwoExrPicturesByHdrFlip) {
  // Far above white a display shows no difference; HDR-FLIP lowers the exposure and sees one.
  const std::string a = grey_exr("a.exr", 10.0F), b = grey_exr("b.exr", 40.0F);
  const auto row = row_of(bench({"compare", a, b}).out);
  EXPECT_EQ(row.at("psnr_db"), 99.0);
  EXPECT_GT(row.at("flip"), 0.1);
  const auto darker = row_of(bench({"compare", a, b, "--exposure", "-6"}).out);
  EXPECT_LT(darker.at("psnr_db"), 20.0);
}

TEST_F(Program, JudgesAnExrBesideAPngAsADisplayShowsIt) {
  const auto row = row_of(bench({"compare", grey_png("a.png", 255), grey_exr("b.exr", 7.0F)}).out);
  EXPECT_EQ(row.at("flip"), 0.0);
  EXPECT_EQ(row.at("mse"), 0.0);
}

struct Outside {
  const char *reference, *test;
  double flip, flip_weighted_median, psnr_db, ssim;
};

// NVIDIA FLIP v1.6 and scikit-image 0.19.3 on the same files.
TEST_F(Program, AgreesWithOutsideProgramsOnDisplayPictures) {
  MACULA_NEEDS_HANDED_DATA("metrics");
  constexpr Outside kPairs[] = {
      {"tree_ref.png", "tree_test.png", 0.133276, 0.333201, 22.28412, 0.740346},
      {"hall_ref.png", "hall_foveated.png", 0.10451, 0.208809, 27.664778, 0.862049},
  };
  const fs::path folder = test::handed_data() / "metrics";
  for (const Outside& pair : kPairs) {
    const Finished run = bench({"compare", folder / pair.reference, folder / pair.test});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto row = row_of(run.out);
    EXPECT_NEAR(row.at("flip"), pair.flip, 1e-4);
    EXPECT_NEAR(row.at("flip_weighted_median"), pair.flip_weighted_median, 1e-3);
    EXPECT_NEAR(row.at("psnr_db"), pair.psnr_db, 1e-3);
    EXPECT_NEAR(row.at("ssim"), pair.ssim, 1e-3);
  }
}

TEST_F(Program, AgreesWithOutsideProgramsOnRadiance) {
  MACULA_NEEDS_HANDED_DATA("metrics");
  const fs::path folder = test::handed_data() / "metrics";
  const std::vector<std::string> pair = {"compare", folder / "veachmis_hdr_ref.exr",
                                         folder / "veachmis_hdr_test.exr"};
  const auto row = row_of(bench(pair).out);
  EXPECT_NEAR(row.at("flip"), 0.18631, 1e-3);
  EXPECT_NEAR(row.at("flip_weighted_median"), 0.289413, 1e-3);
}

TEST_F(Program, StillsOfAMovingSceneRepeatAfterItsCycle) {
  const auto still = [&](const char* time, const std::string& name) {
    const Finished run = bench(
        {"still", "--scene", "moving", "--time", time, "--size", "48x36", "--out", path(name)});
    EXPECT_EQ(run.status, 0) << run.err;
    return text_of(path(name));
  };
  const std::string start = still("0", "start.exr");
  EXPECT_EQ(still("24", "cycle.exr"), start);
  EXPECT_NE(still("3.2", "later.exr"), start);
}

TEST_F(Program, MethodsOfLightcutsAreHeldToEqualCutsAndTheEyeGetsMostWhereItLooks) {
  const Finished run =
      bench({"lightcuts", "--scene", "cornell-lights", "--quick", "--reference-nodes", "2",
             "--methods", "sl,sl_as,paper_no_reuse,paper,paper_denoised,ours_exact,ours",
             "--warm-up", "0", "--pictures", path("maps"), "--json", path("lightcuts.json")});
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream lines(run.out);
  std::string line;
  std::getline(lines, line);
  std::istringstream heads(line);
  const std::vector<std::string> names{std::istream_iterator<std::string>(heads), {}};
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  ASSERT_LT(column("gain_f25"), names.size()) << line;
  ASSERT_LT(column("reuse"), names.size()) << line;
  int curve = 0;
  std::vector<std::string> methods;
  while (std::getline(lines, line) && !line.empty()) {  // a table of means follows
    std::istringstream words(line);
    const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    ASSERT_EQ(fields.size(), names.size()) << line;
    const std::string& method = fields[column("method")];
    if (method.starts_with("sl") && method != "sl_as") {
      EXPECT_EQ(fields[column("lspp_f25")], fields[column("lspp_out25")]) << line;
      if (method == "sl") {
        EXPECT_EQ(fields[column("gain_f25")], "1") << line;
      }
      curve += method == "sl";
    } else {
      EXPECT_GT(std::stod(fields[column("lspp_f25")]),
                2.0 * std::stod(fields[column("lspp_out25")]))
          << line;
      methods.push_back(method);
    }
    const double reuse = std::stod(fields[column("reuse")]);
    const bool shares = method == "paper" || method == "ours_exact";
    EXPECT_EQ(reuse > 0.1, shares) << line;
    EXPECT_EQ(reuse > 0.0, shares || method == "paper_denoised" || method == "ours")
        << line << "\n(small cuts alone, few here)";
  }
  EXPECT_GE(curve, 2) << "as far as the methods read";
  EXPECT_LE(curve, 6);
  EXPECT_EQ(std::ranges::count(methods, "paper"), 1);
  for (const char* sheet : {"maps", "errors", "stages"})
    EXPECT_TRUE(fs::exists(path("maps") + "/" + sheet + ".png")) << sheet;
  EXPECT_TRUE(fs::exists(path("maps") + "/map_attenuation.png"));
  EXPECT_FALSE(fs::exists(path("maps") + "/alphas.png")) << "one alpha is no figure of alphas";
}

TEST_F(Program, ReprojectionKeepsThePictureAtTheSamePoseAndGainsWithEveryStage) {
  const std::vector<std::string> asked{"reprojection",
                                       "--scenes",
                                       "posts",
                                       "--side",
                                       "120",
                                       "--poses",
                                       "2",
                                       "--latencies",
                                       "0,60",
                                       "--source-scales",
                                       "1",
                                       "--methods",
                                       "stale,rotation_guard,mesh_cut_splat",
                                       "--json",
                                       path("reprojection.json")};
  const Finished run = bench(asked);
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream lines(run.out);
  std::string line;
  std::getline(lines, line);
  std::istringstream heads(line);
  const std::vector<std::string> names{std::istream_iterator<std::string>(heads), {}};
  const auto psnr = static_cast<std::size_t>(std::ranges::find(names, "psnr_db") - names.begin());
  ASSERT_LT(psnr, names.size());
  std::vector<double> psnr_db;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    ASSERT_EQ(fields.size(), names.size()) << line;
    psnr_db.push_back(std::stod(fields[psnr]));
  }
  ASSERT_EQ(psnr_db.size(), 6U);
  for (int i = 0; i < 3; ++i) EXPECT_GE(psnr_db[i], 60.0);
  EXPECT_GT(psnr_db[4], psnr_db[3] + 5.0);
  EXPECT_GT(psnr_db[5], psnr_db[4] + 0.5);  // the made-up viewer sways by millimeters
  EXPECT_EQ(bench(asked).out, run.out) << "rows that are known are not measured again";
}

TEST_F(Program, CullingKeepsLightWithFewerRaysThanAllLightsTakeAndGoesOnWhereItEnded) {
  const std::vector<std::string> asked = {"culling",
                                          "--scenes",
                                          "cornell",
                                          "--motions",
                                          "both",
                                          "--methods",
                                          "all_vpls,flc_rays,flc_no_logpolar",
                                          "--side",
                                          "128",
                                          "--kept",
                                          "256",
                                          "--warm-up",
                                          "2",
                                          "--frames",
                                          "2",
                                          "--reference-samples",
                                          "512",
                                          "--references",
                                          path("references"),
                                          "--json",
                                          path("culling.json")};
  const Finished run = bench(asked);
  ASSERT_EQ(run.status, 0) << run.err;
  const auto rows = rows_of(run.out);
  ASSERT_EQ(rows.size(), 3U) << run.out;
  const auto value = [&](std::size_t row, const char* key) { return rows[row].at(key); };
  EXPECT_EQ(rows[0].at("vpls"), rows[0].at("kept"));
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_LE(value(i, "kept"), 256.0) << i;
    EXPECT_NEAR(value(i, "brightness_error_pct"), 0.0, 5.0) << i;
    EXPECT_LT(value(i, "from_vpls_in150"), 0.1) << i;
    EXPECT_LT(value(i, "mrays"), 0.5 * value(0, "mrays")) << i;
  }
  EXPECT_EQ(bench(asked).out, run.out) << "rows that are known are not measured again";
}

TEST_F(Program, CullingNamesItsMethods) {
  const Finished run = bench({"culling", "--methods", "none"});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(contains(run.err, "flc_rays, flc_some")) << run.err;
}

TEST_F(Program, ReprojectionRefusesTracesThatAreTooShort) {
  std::ofstream(path("short.csv")) << "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\n"
                                      "0,0,1.6,0,0,0,0,1,,,\n1,0,1.6,0,0,0,0,1,,,\n";
  const Finished run = bench({"reprojection", "--traces", path("short.csv")});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(contains(run.err, "shorter than 4 s")) << run.err;
}

TEST_F(Program, TheWarpsFasterWaysShowWhatTheSlowOneShows) {
  const Finished run = bench({"warp", "--scenes", "posts", "--grids", "foveal", "--size", "160x160",
                              "--repetitions", "1", "--methods", "every_cell,full"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::size_t last = run.out.find_last_of(" ");
  EXPECT_GT(std::stod(run.out.substr(last)), 50.0) << run.out;
}

TEST_F(Program, AMomentOfEveryKindOfMotionCostsLessThanBuildingAnew) {
  const Finished run = bench({"motion", "--quick"});
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream lines(run.out);
  std::string header, line;
  std::getline(lines, header);
  EXPECT_TRUE(header.ends_with("moment_cpu_ms  rebuild_cpu_ms")) << header;
  int rows = 0;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    ASSERT_EQ(fields.size(), 9U) << line;
    EXPECT_LT(std::stod(fields[7]), std::stod(fields[8])) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 6);
}

TEST_F(Program, StreamsOverALinkAndAccountsForEveryMillisecond) {
  const std::string json = path("streaming.json");
  const Finished run =
      bench({"streaming", "--links", "4ms", "--seconds", "2", "--size", "64x64", "--json", json});
  ASSERT_EQ(run.status, 0) << run.err;
  std::ifstream file(json);
  const auto report = nlohmann::json::parse(file);
  ASSERT_EQ(report["rows"].size(), 1U);
  const auto& row = report["rows"][0];
  EXPECT_GT(row["fps"], 1.0);
  EXPECT_GE(row["transit_p50_ms"], 4.0);
  EXPECT_GE(row["age_p50_ms"], 8.0);
  EXPECT_LE(row["closure_error_max_ms"], 0.2);
  EXPECT_EQ(row["clock_bound_broken"], 0);
  EXPECT_GT(row["psnr_f10_db"], 20.0);
}

TEST_F(Program, AnUnknownLinkIsAnsweredWithTheOnesThereAre) {
  const Finished run = bench({"streaming", "--links", "pigeon"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("100-to-2mbit"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace macula::bench
