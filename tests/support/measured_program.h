// One run of a program with what it printed (both streams together) and what it cost, as the system
// accounts it: its own use and that of processes it waited for.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <vector>

namespace macula::test {

struct MeasuredRun {
  int status = -1;  ///< exit status, or minus the signal
  std::string output;
  double cpu_s = 0.0;           ///< user and system
  double peak_memory_mb = 0.0;  ///< resident, of the largest process
};

inline double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

inline MeasuredRun run_measured(std::vector<std::string> arguments) {
  MeasuredRun run;
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return run;
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    execv(words[0], words.data());
    _exit(127);
  }
  close(ends[1]);
  std::array<char, 4096> chunk;
  for (ssize_t count = 0; (count = read(ends[0], chunk.data(), chunk.size())) != 0;) {
    if (count < 0 && errno != EINTR) break;
    if (count > 0) run.output.append(chunk.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int state = 0;
  rusage used{};
  while (wait4(child, &state, 0, &used) < 0 && errno == EINTR) {
  }
  run.status = WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
  run.cpu_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  run.peak_memory_mb = static_cast<double>(used.ru_maxrss) / 1024.0;
  return run;
}

}  // namespace macula::test
