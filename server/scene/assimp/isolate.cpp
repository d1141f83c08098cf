#include "server/scene/assimp/isolate.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <new>
#include <optional>

#include "shared/base/text.h"

namespace macula::scene::assimp {
namespace {

constexpr int kOutOfMemory = 3, kFailed = 4;  ///< exit statuses of the child

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kInstrumented = true;  // shadow memory is larger than any limit, and all is slower
#else
constexpr bool kInstrumented = false;
#endif

constexpr const char* kDamaged = "the file is damaged; export it again, best as glTF";

/// Address space in use, as the limit counts it.
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void limit(int resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit value{soft, hard};
  setrlimit(static_cast<__rlimit_resource>(resource), &value);
}

void confine(const Limits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto cpu_s = static_cast<std::uint64_t>(limits.cpu_s) * (kInstrumented ? 20 : 1);
  limit(RLIMIT_CPU, cpu_s, cpu_s + 1);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  if (!kInstrumented) {
    const std::uint64_t memory = address_space_bytes() + limits.memory_bytes;
    limit(RLIMIT_AS, memory, memory);
  }
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGPIPE}) {
    std::signal(number, SIG_DFL);
  }
  if (const int null = open("/dev/null", O_RDWR); null >= 0) {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, stream);
  }
}

void write_all(int to, const Bytes& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = write(to, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(kFailed);
    done += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void run_child(const std::function<Bytes()>& work, const Limits& limits, int to) {
  confine(limits);
  try {
    write_all(to, work());
  } catch (const std::bad_alloc&) {
    _exit(kOutOfMemory);
  } catch (...) {
    _exit(kFailed);
  }
  _exit(EXIT_SUCCESS);
}

/// Everything the child writes; nullopt when that is more than allowed.
std::optional<Bytes> read_all(int from, std::uint64_t most) {
  Bytes bytes;
  std::array<std::byte, 1 << 16> chunk;
  while (true) {
    const ssize_t count = read(from, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + count);
    if (bytes.size() > most) return std::nullopt;
  }
}

int wait_for(pid_t child) {
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  return state;
}

Result<Bytes> judge(int state, std::optional<Bytes> answer, const Limits& limits,
                    const std::string& place) {
  if (!answer)
    return base::bad_input("the file holds more than can be taken over", place, kDamaged);
  if (WIFEXITED(state) && WEXITSTATUS(state) == EXIT_SUCCESS) return std::move(*answer);
  if (WIFEXITED(state) && WEXITSTATUS(state) == kOutOfMemory) {
    return base::bad_input(
        base::concat("reading it needs more than ", limits.memory_bytes >> 20, " MB"), place,
        kDamaged);
  }
  if (WIFSIGNALED(state) && (WTERMSIG(state) == SIGXCPU || WTERMSIG(state) == SIGKILL)) {
    return base::bad_input(
        base::concat("reading it takes longer than ", limits.cpu_s, " s of processor time"), place,
        kDamaged);
  }
  return base::bad_input("the importer broke down on this file", place, kDamaged);
}

}  // namespace

Result<Bytes> run_isolated(const std::function<Bytes()>& work, const Limits& limits,
                           const std::string& place) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    return base::runtime_error("no pipe can be made", place, "close other programs");
  }
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(work, limits, ends[1]);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return base::runtime_error("no process can be made", place, "close other programs");
  }
  std::optional<Bytes> answer = read_all(ends[0], limits.answer_bytes);
  close(ends[0]);
  if (!answer) kill(child, SIGKILL);
  return judge(wait_for(child), std::move(answer), limits, place);
}

}  // namespace macula::scene::assimp
