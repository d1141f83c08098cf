// The built program, as a user's script sees it: what it prints and its exit status.
#include <sys/wait.h>

#include <gtest/gtest.h>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>

namespace macula::client_app {
namespace {

struct Outcome {
  int status = -1;  ///< -1: ended by a signal
  std::string output;
};

Outcome run(const std::string& arguments) {
  const std::string keys = " --keys '" + testing::TempDir() + "program_keys' 2>&1";
  std::FILE* pipe = ::popen(
      ("XR_RUNTIME_JSON=/nowhere.json " MACULA_CLIENT_PROGRAM " " + arguments + keys).c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.output.append(buffer.data(), got);
  }
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

TEST(ClientProgram, EndsWithTwoAndNamesThePlaceOfAMalformedTrace) {
  const std::string path = testing::TempDir() + "malformed.csv";
  std::ofstream(path) << "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\n0,0,0,0,0,0,0,1,,,\n"
                         "0.01,0,0,zero,0,0,0,1,,,\n";
  const Outcome outcome = run("--display headless --trace '" + path + "' --out '" +
                              testing::TempDir() + "program_out'");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find("malformed.csv:3, column 4 (pz): 'zero' is not a finite number"),
            std::string::npos)
      << outcome.output;
}

TEST(ClientProgram, EndsWithTwoAtAnUnknownOption) {
  const Outcome outcome = run("--frobnicate");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find("--frobnicate"), std::string::npos);
}

TEST(ClientProgram, EndsWithZeroAfterHelp) {
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("--as-fast-as-possible"), std::string::npos);
}

// Wherever this runs, one of the two is missing: a display, or the runtime that this name hides.
TEST(ClientProgram, EndsWithOneAndOneHelpfulLineWithoutAHeadset) {
  const Outcome outcome = run("--display openxr");
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("macula-client: "), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("--display "), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace macula::client_app
