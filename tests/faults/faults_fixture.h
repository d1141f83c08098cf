// The built server as a process that can be killed, stopped and starved, and a viewer in this
// process that measures what it notices.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/loopback/server_fixture.h"
#include "tests/soak/process_size.h"
#include "tests/support/child_program.h"
#include "tests/support/fault_table.h"

namespace macula::faults {

using namespace std::chrono_literals;
using loopback::EndpointClient;
using loopback::LoopbackServer;
using loopback::TemporaryFolder;
using test::note_fault;
using test::times;
using Clock = std::chrono::steady_clock;

inline double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

template <class... Parts>
std::string text(Parts&&... parts) {
  std::ostringstream out;
  out.precision(3);
  (out << ... << parts);
  return out.str();
}

inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

/// The least of up to `attempts` measurements, ending early once one is within `bound`: a busy
/// machine may lengthen one, the bound is the system's.
template <class Measure>
double least_of(int attempts, double bound, Measure&& measure) {
  double least = 1e300;
  for (int i = 0; i < attempts && least > bound; ++i) least = std::min(least, measure());
  return least;
}

/// macula-server as a process; `launcher` (a program and its arguments) may run it.
class ServerProcess {
 public:
  explicit ServerProcess(const std::string& keys, const std::string& bind = "tcp://127.0.0.1:0",
                         std::vector<std::string> launcher = {},
                         const std::vector<std::string>& more = {}) {
    launcher.insert(launcher.end(), {MACULA_SERVER_PROGRAM, "--scene", "cornell", "--kernel", "ray",
                                     "--bind", bind, "--keys", keys, "--threads", "1",
                                     "--area-samples", "1", "--ambient-samples", "0"});
    launcher.insert(launcher.end(), more.begin(), more.end());
    const std::string program = launcher.front();
    launcher.erase(launcher.begin());
    program_ = std::make_unique<test::ChildProgram>(program, launcher);
    const std::string line = program_->wait_for("ready on ");
    const std::size_t end = line.find(' ', 9);
    if (line.size() > 9) endpoint_ = line.substr(9, end - 9);
    program_->discard_output();
  }
  const std::string& endpoint() const { return endpoint_; }
  void signal(int number) const { program_->signal(number); }
  pid_t pid() const { return program_->pid(); }
  int status() { return program_->status(); }
  soak::ProcessSize size() const { return soak::size_of(program_->pid(), 0.0); }
  /// From now on its address space may grow by this much and no more.
  void limit_more_memory(std::uint64_t bytes) const {
    double pages = 0.0;
    std::ifstream("/proc/" + std::to_string(program_->pid()) + "/statm") >> pages;
    const auto most = static_cast<rlim_t>(pages) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) +
                      static_cast<rlim_t>(bytes);
    const rlimit limit{most, most};
    ASSERT_EQ(::prlimit(program_->pid(), RLIMIT_AS, &limit, nullptr), 0);
  }
  bool runs() const { return soak::size_of(program_->pid(), 0.0).resident_mb > 0.0; }

 private:
  std::unique_ptr<test::ChildProgram> program_;
  std::string endpoint_;
};

/// Whether a viewer has had one session all the time. (A busy machine may make it connect again.)
inline bool kept_its_session(const EndpointClient& viewer) {
  const auto& welcomes = viewer.welcomes();
  return !welcomes.empty() && std::all_of(welcomes.begin() + 1, welcomes.end(),
                                          [](const auto& again) { return again.resumed; });
}

/// A viewer whose keys the server of the same folder trusts.
inline std::unique_ptr<EndpointClient> viewer_of(const std::string& endpoint,
                                                 const std::string& keys) {
  return std::make_unique<EndpointClient>(endpoint, keys, "");
}

}  // namespace macula::faults
