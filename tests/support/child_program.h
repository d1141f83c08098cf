// A program that runs beside the test: what it prints can be waited for, signals be sent to it. It
// is killed with the test.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace macula::test {

/// A child process whose stdout and stderr come back through one pipe.
class ChildProgram {
 public:
  ChildProgram(const std::string& file, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), file);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
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
  ~ChildProgram() {
    if (!ended_) {
      signal(SIGKILL);
      status();
    }
    if (reader_.joinable()) reader_.join();
    if (output_ != nullptr) fclose(output_);
  }

  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

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
  pid_t pid() const { return pid_; }
  /// What it prints from now on goes nowhere, so that it never waits for a reader.
  void discard_output() {
    reader_ = std::thread([this] { read_all(); });
  }
  /// Exit status, or -signal.
  int status() {
    int raw = 0;
    waitpid(pid_, &raw, 0);
    return ended(raw);
  }
  std::optional<int> status_if_ended() {
    int raw = 0;
    if (waitpid(pid_, &raw, WNOHANG) != pid_) return std::nullopt;
    return ended(raw);
  }

 private:
  int ended(int raw) {
    ended_ = true;
    return WIFEXITED(raw) ? WEXITSTATUS(raw) : -WTERMSIG(raw);
  }

  pid_t pid_ = -1;
  FILE* output_ = nullptr;
  std::string all_;
  bool ended_ = false;
  std::thread reader_;
};

}  // namespace macula::test
