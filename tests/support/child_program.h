// A program that runs beside the test: what it prints can be waited for, signals be sent to it. It
// is killed with the test.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

namespace macula::test {

/// A child process whose stdout and stderr come back through one pipe.
class ChildProgram {
 public:
  ChildProgram(const std::string& file, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), file);
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
  ~ChildProgram() {
    if (!ended_) {
      signal(SIGKILL);
      status();
    }
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

}  // namespace macula::test
