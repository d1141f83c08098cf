// The built program as a user meets it: exit status and one-line messages.
#include <gtest/gtest.h>
#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

#include "tests/support/child_program.h"
#include "tests/support/temporary_folder.h"

namespace {

struct ServerProcess : macula::test::ChildProgram {
  explicit ServerProcess(std::vector<std::string> arguments)
      : ChildProgram(MACULA_SERVER_PROGRAM, std::move(arguments)) {}
};

struct Ended {
  int status;
  std::string output;
};
Ended run(const std::vector<std::string>& arguments) {
  ServerProcess program(arguments);
  const std::string output = program.read_all();
  return {program.status(), output};
}

long lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

class ServerProgram : public testing::Test {
 protected:
  std::vector<std::string> serving(const std::string& bind = "tcp://127.0.0.1:0") const {
    return {"--scene", "cornell", "--bind", bind, "--keys", keys_, "--threads", "1"};
  }
  const macula::test::TemporaryFolder folder_;
  const std::string keys_ = folder_.path();
};

void expect_bad_input(const std::vector<std::string>& arguments, const std::string& mentions) {
  const Ended ended = run(arguments);
  EXPECT_EQ(ended.status, 2) << ended.output;
  EXPECT_EQ(lines_of(ended.output), 1) << ended.output;
  EXPECT_NE(ended.output.find(mentions), std::string::npos) << ended.output;
}

TEST_F(ServerProgram, BadInputEndsWithTwoAndOneLineThatSaysWhatIsAllowed) {
  expect_bad_input({"--no-such-option"}, "--no-such-option");
  expect_bad_input({"--scene", "atlantis"}, "cornell");
  expect_bad_input({"--scene", "/nowhere/model.gltf"}, "/nowhere/model.gltf");
  expect_bad_input({"--kernel", "crystal-ball", "--scene", "cornell"}, "ray");
  expect_bad_input({"--config", "/nowhere.toml"}, "/nowhere.toml");
  expect_bad_input({"--color-quality", "101"}, "1 to 100");
  expect_bad_input({"--quality", "85"}, "--color-quality is that of colour");
}

TEST_F(ServerProgram, ListsScenesAndExplainsItsChoices) {
  const Ended list = run({"--list-scenes"});
  EXPECT_EQ(list.status, 0);
  EXPECT_NE(list.output.find("cornell"), std::string::npos);
  const Ended explained = run({"--scene", "cornell", "--explain", "--keys", keys_});
  EXPECT_EQ(explained.status, 0);
  EXPECT_NE(explained.output.find("kernel ray"), std::string::npos) << explained.output;
  EXPECT_NE(explained.output.find("used      triangle BVH"), std::string::npos);
  EXPECT_NE(explained.output.find("left out  distance-field tracer"), std::string::npos);
}

TEST_F(ServerProgram, ExplainsTheReflectedLightThatIsAskedForInTheTree) {
  const auto explained = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"--scene",   "cornell", "--kernel", "lightcuts",
                                       "--explain", "--keys",  keys_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments).output;
  };
  const std::string wanted = explained({"--bounced-rays", "5000"});
  EXPECT_NE(wanted.find("used      virtual point lights: light that surfaces have reflected once, "
                        "of 5000 rays"),
            std::string::npos)
      << wanted;
  EXPECT_NE(explained({}).find("left out  virtual point lights"), std::string::npos);
}

TEST_F(ServerProgram, ExplainsThePlaceOnTheLadderThatIsAskedFor) {
  const auto explained = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"--scene", "cornell", "--explain", "--keys", keys_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.status, 0) << ended.output;
    return ended.output;
  };
  const std::string low = explained({"--quality", "0"}), high = explained({"--quality", "10"});
  EXPECT_NE(low.find("quality 0 of 10"), std::string::npos) << low;
  EXPECT_NE(high.find("quality 10 of 10"), std::string::npos) << high;
  EXPECT_NE(low.find("measured error"), std::string::npos);
  EXPECT_EQ(explained({}).find("of 10"), std::string::npos) << "nobody asked";
  EXPECT_NE(explained({"--max-error", "0.000001"}).find("less than the ladder's best"),
            std::string::npos);
  expect_bad_input(
      {"--scene", "cornell", "--quality", "5", "--ladders", "/nowhere", "--keys", keys_},
      "/nowhere/ray.toml");
}

TEST_F(ServerProgram, SaysWhenItIsReadyAndEndsWithZeroOnASignal) {
  for (const int number : {SIGINT, SIGTERM}) {
    ServerProcess program(serving());
    const std::string ready = program.wait_for("ready on tcp://127.0.0.1:");
    ASSERT_NE(ready, "");
    EXPECT_NE(ready.find("public key "), std::string::npos);
    program.signal(number);
    EXPECT_EQ(program.status(), 0);
  }
}

TEST_F(ServerProgram, SaysWhatIsMissingWhereOthersCanReachItButNoneIsAllowed) {
  ServerProcess open(serving("tcp://*:0"));
  EXPECT_NE(open.wait_for("macula-server pair"), "");
  EXPECT_NE(open.wait_for("ready on "), "");
  ServerProcess own(serving());
  std::string said;
  for (std::string line = own.wait_for("\n"); !line.empty(); line = own.wait_for("\n")) {
    said += line;
    if (line.find("ready on ") == 0) break;
  }
  EXPECT_EQ(said.find("macula-server pair"), std::string::npos) << said;
}

TEST_F(ServerProgram, APortInUseIsNamed) {
  ServerProcess first(serving());
  const std::string ready = first.wait_for("ready on ");
  const std::string endpoint = ready.substr(9, ready.find(' ', 9) - 9);
  ServerProcess second(serving(endpoint));
  const std::string message = second.wait_for("macula-server:");
  EXPECT_NE(message.find(endpoint.substr(endpoint.rfind(':') + 1)), std::string::npos) << message;
  EXPECT_NE(second.status(), 0);
}

}  // namespace
