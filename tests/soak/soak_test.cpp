// A server that is used for a while as badly as a link and clients can: two clients, each behind a
// proxy that delays, stalls, cuts, resets and damages, come, go and are killed. Afterwards the
// server holds what it held before. MACULA_SOAK_S: for how long (default 40; 3600 is the long run).
// Every two minutes both leave and the server may settle: a long run also bounds the slope of what
// it holds then, which no session's memory, there or not, can hide or feign. MACULA_SOAK_CSV: a
// file for what the server held over time.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <memory>
#include <random>
#include <thread>

#include "shared/base/text.h"
#include "tests/soak/process_size.h"
#include "tests/support/chaos_proxy.h"
#include "tests/support/child_program.h"
#include "tests/support/fault_table.h"
#include "tests/support/temporary_folder.h"

namespace macula::soak {
namespace {

using namespace std::chrono_literals;
using support::ChaosProxy;
using support::Direction;
using test::ChildProgram;
using Clock = std::chrono::steady_clock;

constexpr double kLongRun_s = 600.0;
constexpr double kRound_s = 120.0;  ///< of faults, before the server may settle
/// A silent connection is ended after 15 s, a session whose client was killed is freed after three.
constexpr auto kSettles = 25s, kSessionIsFreed = 4s;
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kInstrumented = true;  ///< freed memory is kept to find its users
#else
constexpr bool kInstrumented = false;
#endif

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double soak_time_s() {
  const char* const asked = ::getenv("MACULA_SOAK_S");
  return asked == nullptr ? 40.0 : std::stod(asked);
}

/// What the server held over time: kept in a file where one is asked for, told where it settled.
class Diary {
 public:
  Diary() {
    const char* const asked = ::getenv("MACULA_SOAK_CSV");
    if (asked == nullptr) return;
    file_.open(asked);
    file_ << "at_s,resident_mb,descriptors,threads,state" << std::endl;
  }
  void note(const ProcessSize& size) { write(size, "used"); }
  void note_settled(const ProcessSize& size) {
    settled_.push_back(size);
    write(size, "settled");
    std::cout << "after " << static_cast<int>(size.at_s) << " s, settled: " << size.resident_mb
              << " MB, " << size.descriptors << " descriptors, " << size.threads << " threads"
              << std::endl;
  }
  /// Without the first quarter, in which everything is made that is made at first use.
  double settled_slope_mb_per_h() const {
    const auto warm = static_cast<std::ptrdiff_t>(settled_.size() / 4);
    return resident_slope_mb_per_h({settled_.begin() + warm, settled_.end()});
  }

 private:
  void write(const ProcessSize& size, const char* state) {
    file_ << size.at_s << ',' << size.resident_mb << ',' << size.descriptors << ',' << size.threads
          << ',' << state << std::endl;
  }

  std::vector<ProcessSize> settled_;
  std::ofstream file_;
};

/// How clients ended: well, with a message, killed by the test, or by a signal nobody sent.
struct Visits {
  int satisfied = 0, disappointed = 0, killed = 0, crashed = 0;
  Visits& operator+=(const Visits& more) {
    satisfied += more.satisfied;
    disappointed += more.disappointed;
    killed += more.killed;
    crashed += more.crashed;
    return *this;
  }
};

/// One client after the other through one proxy; some are killed, the others end by themselves.
class Visitor {
 public:
  Visitor(const std::string& server, const std::string& folder, std::uint64_t seed)
      : random_(seed), proxy_(*ChaosProxy::create(server, seed)), folder_(folder) {
    come();
  }

  /// Something happens to the link or the client, or nothing does.
  void blow() {
    switch (random_() % 10) {
      case 0:
        proxy_->cut();
        break;
      case 1:
        proxy_->reset();
        break;
      case 2:
        proxy_->flip_bit_after(direction(), random_() % 100'000);
        break;
      case 3:
        proxy_->stall(direction());
        break;
      case 4:
        proxy_->leave_half_open();
        break;
      case 5:
        proxy_->shape(direction(), {.delay = std::chrono::milliseconds{random_() % 80},
                                    .jitter = 20ms,
                                    .bytes_per_s = 100e3});
        break;
      case 6:
        client_->signal(SIGKILL);
        break;
      default:
        calm();
    }
  }
  void calm() {
    for (const Direction way : {Direction::ToServer, Direction::ToClient}) {
      proxy_->resume(way);
      proxy_->shape(way, {});
    }
  }
  /// A client that has ended is followed by the next.
  void attend() {
    const auto status = client_->status_if_ended();
    if (!status) return;
    leave(*status);
    come();
  }
  void end() {
    client_->signal(SIGTERM);
    leave(client_->status());
  }

  const Visits& visits() const { return visits_; }

 private:
  Direction direction() { return random_() % 2 == 0 ? Direction::ToServer : Direction::ToClient; }
  void come() {
    client_ = std::make_unique<ChildProgram>(
        MACULA_CLIENT_PROGRAM,
        std::vector<std::string>{"--connect", proxy_->endpoint(), "--keys", folder_ + "/keys",
                                 "--display", "headless", "--size", "96x96", "--frames", "40",
                                 "--loop", "--out", folder_ + "/out"});
    client_->discard_output();
  }
  void leave(int status) {
    if (status == 0) ++visits_.satisfied;
    if (status > 0) ++visits_.disappointed;
    if (status == -SIGKILL) ++visits_.killed;
    if (status < 0 && status != -SIGKILL) ++visits_.crashed;
  }

  std::mt19937_64 random_;
  std::unique_ptr<ChaosProxy> proxy_;
  std::string folder_;
  std::unique_ptr<ChildProgram> client_;
  Visits visits_;
};

class Soak : public testing::Test {
 protected:
  Soak() {
    server_ = std::make_unique<ChildProgram>(
        MACULA_SERVER_PROGRAM,
        std::vector<std::string>{"--scene", "cornell", "--bind", "tcp://127.0.0.1:0", "--keys",
                                 folder_ + "/keys", "--threads", "2"});
    const std::string line = server_->wait_for("ready on ");
    endpoint_ = line.substr(9, line.find(' ', 9) - 9);
    server_->discard_output();
  }
  /// Two visitors and their links, gone when it returns; every round has chances of its own.
  Visits soak(double lasts_s, Diary& diary) {
    Visitor a(endpoint_, folder_, ++seed_), b(endpoint_, folder_, ++seed_);
    for (const auto start = Clock::now(); seconds_since(start) < lasts_s;) {
      for (Visitor* visitor : {&a, &b}) {
        visitor->blow();
        visitor->attend();
      }
      std::this_thread::sleep_for(500ms);
      diary.note(size());
    }
    Visits all;
    for (Visitor* visitor : {&a, &b}) {
      visitor->calm();
      visitor->end();
      all += visitor->visits();
    }
    return all;
  }
  /// What it holds once the last client's traces are gone, or at the end of the patience.
  ProcessSize settled_size(const ProcessSize& before) const {
    const auto start = Clock::now();
    while (size().descriptors > before.descriptors && Clock::now() - start < kSettles)
      std::this_thread::sleep_for(200ms);
    std::this_thread::sleep_for(kSessionIsFreed);
    return size();
  }
  ProcessSize size() const { return size_of(server_->pid(), seconds_since(begin_)); }

  const test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string endpoint_;
  std::unique_ptr<ChildProgram> server_;  ///< ends before its folder does
  std::uint64_t seed_ = 1;                ///< of the visitor before
  Clock::time_point begin_ = Clock::now();
};

TEST_F(Soak, AServerUsedBadlyHoldsAfterwardsWhatItHeldBefore) {
  // Once without faults: everything that is made at first use is made.
  {
    Visitor first(endpoint_, folder_, 1);
    for (int i = 0; i < 300 && first.visits().satisfied == 0;
         ++i, std::this_thread::sleep_for(100ms))
      first.attend();
    first.end();
  }
  std::this_thread::sleep_for(4s);
  const ProcessSize before = size();

  const double lasts_s = soak_time_s();
  Diary diary;
  Visits visits;
  ProcessSize after = before;
  while (after.at_s < before.at_s + lasts_s) {
    visits += soak(std::min(kRound_s, before.at_s + lasts_s - after.at_s), diary);
    after = settled_size(before);
    diary.note_settled(after);
  }
  const double slope = diary.settled_slope_mb_per_h();
  std::cout << "soak " << lasts_s << " s: clients satisfied " << visits.satisfied << ", killed "
            << visits.killed << ", disappointed " << visits.disappointed << "; server resident "
            << before.resident_mb << " -> " << after.resident_mb << " MB, slope " << slope
            << " MB/h; descriptors " << before.descriptors << " -> " << after.descriptors
            << ", threads " << before.threads << " -> " << after.threads << std::endl;
  macula::test::note_fault(
      "soak, 2 clients, random faults", "0 descriptors and threads more, 1 MB/h in 1 h",
      base::concat(lasts_s, " s: ", before.descriptors, " -> ", after.descriptors, " descriptors, ",
                   before.threads, " -> ", after.threads, " threads, ", before.resident_mb, " -> ",
                   after.resident_mb, " MB, ", slope, " MB/h; clients satisfied ", visits.satisfied,
                   ", killed ", visits.killed, ", crashed ", visits.crashed));
  EXPECT_EQ(visits.crashed, 0);
  EXPECT_GT(visits.satisfied, 0);
  EXPECT_LE(after.descriptors, before.descriptors);
  EXPECT_LE(after.threads, before.threads);
  // A short run sees the allocator's high-water mark, not a leak.
  if (lasts_s >= kLongRun_s) {
    EXPECT_LE(slope, 1.0);
  } else if (!kInstrumented) {
    EXPECT_LE(after.resident_mb, before.resident_mb + 64.0);
  }
  server_->signal(SIGTERM);
  EXPECT_EQ(server_->status(), 0);
}

}  // namespace
}  // namespace macula::soak
