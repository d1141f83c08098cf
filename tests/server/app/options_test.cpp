#include "server/app/options.h"

#include "server/app/settings_file.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

namespace macula::server_app {
namespace {

Result<Command> parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "macula-server");
  return parse_options(static_cast<int>(arguments.size()), arguments.data());
}

Options parsed(const std::vector<const char*>& arguments) {
  const auto result = parse(arguments);
  EXPECT_TRUE(result) << result.error().message();
  return result ? std::get<Options>(*result) : Options{};
}

std::string error_of(const std::vector<const char*>& arguments) {
  const auto result = parse(arguments);
  EXPECT_FALSE(result);
  return result ? "" : result.error().message();
}

class SettingsFile : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_.string();
  }
  ~SettingsFile() override { std::filesystem::remove(path_); }

  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) /
      ("macula_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
       ".toml");
};

TEST(Options, DefaultsServeThisMachineOnly) {
  const Options options = parsed({});
  EXPECT_EQ(options.bind, "tcp://127.0.0.1:7788");
  EXPECT_EQ(options.kernel, "auto");
  EXPECT_FALSE(options.target_ms);
}

TEST(Options, SubcommandsTakeTheKeyFolderBeforeAndAfter) {
  const auto pair = parse({"--keys", "/k", "pair", "--bind", "tcp://127.0.0.1:1"});
  ASSERT_TRUE(pair) << pair.error().message();
  EXPECT_EQ(std::get<PairCommand>(*pair).keys, "/k");
  EXPECT_EQ(std::get<PairCommand>(*pair).bind, "tcp://127.0.0.1:1");
  const auto revoke = parse({"clients", "revoke", "headset", "--keys", "/k"});
  ASSERT_TRUE(revoke) << revoke.error().message();
  EXPECT_EQ(std::get<ClientsCommand>(*revoke).revoke, "headset");
  EXPECT_EQ(std::get<ClientsCommand>(*revoke).keys, "/k");
  EXPECT_EQ(std::get<ClientsCommand>(*parse({"clients", "list"})).revoke, "");
  EXPECT_FALSE(parse({"clients"}));
  EXPECT_FALSE(parse({"clients", "revoke"}));
  EXPECT_FALSE(parse({"pear"}));
}

TEST(Options, EveryOptionLandsInItsField) {
  const Options o = parsed({"--scene",
                            "posts",
                            "--kernel",
                            "brute",
                            "--bind",
                            "tcp://*:1",
                            "--keys",
                            "k",
                            "--target-ms",
                            "12.5",
                            "--rate-model",
                            "sphere",
                            "--oversampling",
                            "1.5",
                            "--codec",
                            "lossless",
                            "--color-quality",
                            "70",
                            "--area-samples",
                            "3",
                            "--ambient-samples",
                            "0",
                            "--threads",
                            "2",
                            "--guard-deg",
                            "7.5",
                            "--predict-ms",
                            "60",
                            "--explain",
                            "--reuse",
                            "--verbose",
                            "--report",
                            "r"});
  EXPECT_EQ(o.scene, "posts");
  EXPECT_EQ(o.report, "r");
  EXPECT_EQ(o.kernel, "brute");
  EXPECT_EQ(o.bind, "tcp://*:1");
  EXPECT_EQ(o.keys, "k");
  EXPECT_EQ(o.target_ms, 12.5);
  EXPECT_EQ(o.rate_model, "sphere");
  EXPECT_EQ(o.oversampling, 1.5);
  EXPECT_EQ(o.guard_deg, 7.5);
  EXPECT_EQ(o.predict_ms, 60.0);
  EXPECT_EQ(o.codec, "lossless");
  EXPECT_EQ(o.color_quality, 70);
  EXPECT_EQ(o.area_samples, 3);
  EXPECT_EQ(o.ambient_samples, 0);
  EXPECT_EQ(o.threads, 2);
  EXPECT_TRUE(o.explain && o.reuse && o.verbose && !o.list_scenes);
}

TEST(Options, LightsArePerceivedOnlyWhereThatWasAskedFor) {
  EXPECT_FALSE(parsed({}).perceived_lights);
  EXPECT_TRUE(parsed({"--perceived-lights"}).perceived_lights);
}

TEST(Options, KnobsAreTurnedByHandOrByTheLadderButNotByBoth) {
  EXPECT_EQ(parsed({"--knobs", "budget=0.2"}).knobs, "budget=0.2");
  EXPECT_TRUE(parse({"--knobs", "budget=0.2", "--target-ms", "20"}));
  EXPECT_FALSE(parse({"--knobs", "budget=0.2", "--quality", "4"}));
  EXPECT_FALSE(parse({"--knobs", "budget=0.2", "--max-error", "0.1"}));
}

TEST(Options, LightIsBouncedOnlyWhereThatWasAskedFor) {
  EXPECT_EQ(parsed({}).bounced_rays, 0);
  EXPECT_EQ(parsed({"--bounced-rays", "120000"}).bounced_rays, 120'000);
  EXPECT_FALSE(parse({"--bounced-rays", "-1"}));
}

TEST(Options, HelpShowsOptionsAndExamples) {
  const auto help = parse({"--help"});
  ASSERT_TRUE(help);
  const std::string& text = std::get<PrintAndExit>(*help).text;
  for (const char* part : {"--target-ms", "--list-scenes", "Examples:", "tcp://127.0.0.1:7788",
                           "Speed against quality:"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST(Options, ValuesOutOfRangeAreNamedWithWhatIsAllowed) {
  EXPECT_NE(error_of({"--color-quality", "0"}).find("--color-quality"), std::string::npos);
  EXPECT_NE(error_of({"--color-quality", "0"}).find("1 to 100"), std::string::npos);
  EXPECT_NE(error_of({"--target-ms", "-3"}).find("--target-ms"), std::string::npos);
  EXPECT_NE(error_of({"--target-ms", "nan"}).find("--target-ms"), std::string::npos);
  EXPECT_NE(error_of({"--oversampling", "1.2"}).find("1.5"), std::string::npos);
  EXPECT_NE(error_of({"--guard-deg", "40"}).find("0 to 15"), std::string::npos);
  EXPECT_NE(error_of({"--predict-ms", "500"}).find("--predict-ms"), std::string::npos);
  EXPECT_NE(error_of({"--codec", "gif"}).find("jpeg, h264, lossless"), std::string::npos);
  EXPECT_NE(error_of({"--rate-model", "flat"}).find("cortical"), std::string::npos);
  EXPECT_NE(error_of({"--threads", "many"}).find("--threads"), std::string::npos);
  EXPECT_NE(error_of({"--colour"}).find("--colour"), std::string::npos);
}

TEST_F(SettingsFile, FillsInWhatTheCommandLineLeavesOpen) {
  const std::string file =
      write("scene = \"posts\"\ncolor_quality = 60\ntarget_ms = 20\nverbose = true\n");
  const Options o = parsed({"--config", file.c_str(), "--color-quality", "70"});
  EXPECT_EQ(o.scene, "posts");
  EXPECT_EQ(o.color_quality, 70);
  EXPECT_EQ(o.target_ms, 20.0);
  EXPECT_TRUE(o.verbose);
}

TEST_F(SettingsFile, AnUnknownKeyIsAnErrorWithItsLine) {
  const std::string file = write("scene = \"posts\"\n\nqualty = 60\n");
  const std::string error = error_of({"--config", file.c_str()});
  EXPECT_NE(error.find(file + ":3"), std::string::npos) << error;
  EXPECT_NE(error.find("'qualty'"), std::string::npos) << error;
  EXPECT_NE(error.find("target_ms"), std::string::npos) << "the known keys are listed";
}

TEST_F(SettingsFile, AValueOfTheWrongTypeIsAnErrorWithItsLine) {
  const std::string file = write("# a comment\ncolor_quality = \"high\"\n");
  const std::string error = error_of({"--config", file.c_str()});
  EXPECT_NE(error.find(file + ":2"), std::string::npos) << error;
}

TEST_F(SettingsFile, BrokenTomlAndMissingFilesAreOneLineErrors) {
  const std::string file = write("scene = = 3\n");
  EXPECT_EQ(error_of({"--config", file.c_str()}).find('\n'), std::string::npos);
  EXPECT_NE(error_of({"--config", "/nowhere.toml"}).find("/nowhere.toml"), std::string::npos);
}

TEST_F(SettingsFile, WhatIsDescribedCanBeReadBack) {
  Options told = parsed({"--scene", "posts", "--target-ms", "12.5", "--oversampling", "2"});
  const std::string file = write(describe(told));
  EXPECT_EQ(describe(parsed({"--config", file.c_str()})), describe(told));
}

/// deploy/server.toml with every setting taken out of its comment, and the keys they set.
struct SampleSettings {
  std::string text;
  std::vector<std::string> keys;
};
SampleSettings sample_settings() {
  SampleSettings sample;
  std::ifstream in(MACULA_SOURCE_DIR "/deploy/server.toml");
  for (std::string line; std::getline(in, line);) {
    const std::size_t equals = line.find(" = ");
    const bool is_setting =
        line.rfind("# ", 0) == 0 && equals != std::string::npos && line.find(' ', 2) == equals;
    if (!is_setting) continue;
    sample.keys.push_back(line.substr(2, equals - 2));
    sample.text += line.substr(2) + "\n";
  }
  return sample;
}

TEST_F(SettingsFile, TheSampleHasEveryKeyOnceWithItsDefault) {
  SampleSettings sample = sample_settings();
  auto known = settings_keys();
  std::sort(known.begin(), known.end());
  std::sort(sample.keys.begin(), sample.keys.end());
  EXPECT_EQ(sample.keys, known);
  const Options defaults;
  const std::string path = write(sample.text);
  Options set = parsed({"--config", path.c_str()});
  set.config.clear();
  set.target_ms.reset(), set.quality.reset(), set.max_error.reset();  // by default there are none
  EXPECT_EQ(describe(set), describe(defaults));
}

}  // namespace
}  // namespace macula::server_app
