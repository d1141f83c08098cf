// The two built programs with key folders of their own, as on two machines: strangers, pairing, a
// stream, revocation.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/child_program.h"
#include "tests/support/measured_program.h"
#include "tests/support/temporary_folder.h"

namespace macula::test {
namespace {

/// What follows `prefix` in a line, up to a blank or, for the rest of the line, its end.
std::string word_after(const std::string& line, const std::string& prefix,
                       const char* ends = " \n") {
  const std::size_t begin = line.find(prefix) + prefix.size();
  return line.substr(begin, line.find_first_of(ends, begin) - begin);
}

class TwoMachines : public testing::Test {
 protected:
  TwoMachines() {
    server_ = std::make_unique<ChildProgram>(
        MACULA_SERVER_PROGRAM,
        std::vector<std::string>{"--scene", "cornell", "--bind", "tcp://127.0.0.1:0", "--keys",
                                 server_keys()});
    endpoint_ = word_after(server_->wait_for("ready on "), "ready on ");
  }
  std::string server_keys() const { return folder_.path() + "/server"; }
  std::string client_keys() const { return folder_.path() + "/client"; }

  MeasuredRun client(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), MACULA_CLIENT_PROGRAM);
    arguments.insert(arguments.end(), {"--keys", client_keys()});
    return run_measured(std::move(arguments));
  }
  MeasuredRun stream() const {
    return client({"--connect", endpoint_, "--display", "headless", "--size", "64x64", "--frames",
                   "3", "--connect-patience", "4", "--out", folder_.path() + "/out"});
  }
  MeasuredRun clients(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {MACULA_SERVER_PROGRAM, "clients"});
    arguments.insert(arguments.end(), {"--keys", server_keys()});
    return run_measured(std::move(arguments));
  }
  /// `pair` on both sides; the client types what the server shows, or `other`.
  MeasuredRun pair(const std::string& other = {}) const {
    ChildProgram host(MACULA_SERVER_PROGRAM,
                      {"pair", "--bind", "tcp://127.0.0.1:0", "--keys", server_keys()});
    const std::string where = word_after(host.wait_for("pairing on "), "pairing on ");
    const std::string shown = word_after(host.wait_for("code: "), "code: ", "\n");
    MeasuredRun joined = client(
        {"pair", "--connect", where, "--code", other.empty() ? shown : other, "--name", "headset"});
    if (joined.status == 0) {
      EXPECT_NE(host.wait_for("paired: 'headset'"), "");
      EXPECT_EQ(host.status(), 0);
    }
    return joined;
  }

  const test::TemporaryFolder folder_;
  std::string endpoint_;
  std::unique_ptr<ChildProgram> server_;
};

TEST_F(TwoMachines, PairedOnceTheClientStreamsUntilItIsRevoked) {
  const MeasuredRun stranger = stream();
  EXPECT_EQ(stranger.status, 2) << stranger.output;
  EXPECT_NE(stranger.output.find("macula-server pair"), std::string::npos) << stranger.output;

  const MeasuredRun paired = pair();
  ASSERT_EQ(paired.status, 0) << paired.output;
  const MeasuredRun listed = clients({"list"});
  EXPECT_NE(listed.output.find("headset\t"), std::string::npos) << listed.output;
  const MeasuredRun streamed = stream();
  EXPECT_EQ(streamed.status, 0) << streamed.output;

  EXPECT_EQ(clients({"revoke", "nobody"}).status, 2);
  ASSERT_EQ(clients({"revoke", "headset"}).status, 0);
  const MeasuredRun refused = stream();
  EXPECT_EQ(refused.status, 1) << refused.output;
  EXPECT_NE(refused.output.find("does not know this client"), std::string::npos) << refused.output;
}

TEST_F(TwoMachines, TheDoctorSaysWhatIsMissingAndThenThatAllIsWell) {
  const auto examine = [&] {
    return client({"--doctor", "--connect", endpoint_, "--display", "headless", "--size", "64x64"});
  };
  const MeasuredRun before = examine();
  EXPECT_EQ(before.status, 1) << before.output;
  EXPECT_NE(before.output.find("BAD   server"), std::string::npos) << before.output;
  EXPECT_NE(before.output.find("macula-client pair"), std::string::npos) << before.output;
  ASSERT_EQ(pair().status, 0);
  const MeasuredRun after = examine();
  EXPECT_EQ(after.status, 0) << after.output;
  EXPECT_NE(after.output.find("ok    connection"), std::string::npos) << after.output;
  EXPECT_NE(after.output.find("all is well"), std::string::npos) << after.output;
}

TEST_F(TwoMachines, AWrongCodePairsNobody) {
  const MeasuredRun wrong = pair("000 000");  // right once in a million runs
  EXPECT_EQ(wrong.status, 1) << wrong.output;
  EXPECT_NE(wrong.output.find("the code is wrong"), std::string::npos) << wrong.output;
  EXPECT_EQ(pair("12345").status, 2) << "five digits";
  EXPECT_NE(clients({"list"}).output.find("no client is allowed"), std::string::npos);
}

}  // namespace
}  // namespace macula::test
