#include "tests/bench/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

extern char** environ;

namespace macula::bench {
namespace {

/// A file that takes one output stream, gone with this object.
class Catch {
 public:
  explicit Catch(const char* stream)
      : path_((std::filesystem::temp_directory_path() /
               ("macula_" + std::string(stream) + "_" + std::to_string(getpid())))
                  .string()) {}
  ~Catch() { std::filesystem::remove(path_); }
  Catch(const Catch&) = delete;
  Catch& operator=(const Catch&) = delete;

  const char* path() const { return path_.c_str(); }
  std::string text() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  std::string path_;
};

}  // namespace

Finished run_program(const std::vector<std::string>& arguments) {
  const Catch out("out"), err("err");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.path(), kFlags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.path(), kFlags, 0600);

  std::vector<char*> words;
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawn(&child, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int state = 0;
  if (failed != 0 || waitpid(child, &state, 0) != child) return {};
  return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, out.text(), err.text()};
}

}  // namespace macula::bench
