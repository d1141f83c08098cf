// The built program as a user meets it: exit status and one-line messages.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace {

/// A child process whose stdout and stderr come back through one pipe.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), MACULA_SERVER_PROGRAM);
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      close(ends[0]);
      close(ends[1]);
      std::vector<char*> argv;
      for (std::string& argument : arguments) argv.push_back(argument.data());
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ~Program() {
    if (!ended_) {
      signal(SIGKILL);
      status();
    }
    if (output_ != nullptr) fclose(output_);
  }

  void signal(int number) const { kill(pid_, number); }
  /// Reads lines until one contains `text`; that line, or an empty one at the end of output.
  std::string wait_for(const std::string& text) {
    std::array<char, 4096> line{};
    while (fgets(line.data(), line.size(), output_) != nullptr) {
      all_ += line.data();
      if (std::string(line.data()).find(text) != std::string::npos) return line.data();
    }
    return {};
  }
  const std::string& read_all() {
    wait_for("\001 never printed");
    return all_;
  }
  /// Exit status, or -signal.
  int status() {
    int raw = 0;
    waitpid(pid_, &raw, 0);
    ended_ = true;
    return WIFEXITED(raw) ? WEXITSTATUS(raw) : -WTERMSIG(raw);
  }

 private:
  pid_t pid_ = -1;
  FILE* output_ = nullptr;
  std::string all_;
  bool ended_ = false;
};

struct Ended {
  int status;
  std::string output;
};
Ended run(const std::vector<std::string>& arguments) {
  Program program(arguments);
  const std::string output = program.read_all();
  return {program.status(), output};
}

long lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

class ServerProgram : public testing::Test {
 protected:
  ServerProgram() {
    std::string pattern = testing::TempDir() + "macula_keys_XXXXXX";
    keys_ = mkdtemp(pattern.data());
  }
  ~ServerProgram() override { std::filesystem::remove_all(keys_); }
  std::vector<std::string> serving(const std::string& bind = "tcp://127.0.0.1:0") const {
    return {"--scene", "cornell", "--bind", bind, "--keys", keys_, "--threads", "1"};
  }
  std::string keys_;
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
  expect_bad_input({"--quality", "101"}, "1 to 100");
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

TEST_F(ServerProgram, SaysWhenItIsReadyAndEndsWithZeroOnASignal) {
  for (const int number : {SIGINT, SIGTERM}) {
    Program program(serving());
    const std::string ready = program.wait_for("ready on tcp://127.0.0.1:");
    ASSERT_NE(ready, "");
    EXPECT_NE(ready.find("public key "), std::string::npos);
    program.signal(number);
    EXPECT_EQ(program.status(), 0);
  }
}

TEST_F(ServerProgram, APortInUseIsNamed) {
  Program first(serving());
  const std::string ready = first.wait_for("ready on ");
  const std::string endpoint = ready.substr(9, ready.find(' ', 9) - 9);
  Program second(serving(endpoint));
  const std::string message = second.wait_for("macula-server:");
  EXPECT_NE(message.find(endpoint.substr(endpoint.rfind(':') + 1)), std::string::npos) << message;
  EXPECT_NE(second.status(), 0);
}

}  // namespace
