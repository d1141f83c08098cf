// Servers that are killed, stopped, told another time, starved of memory, descriptors and disk.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "client/frames/decode.h"
#include "shared/base/text.h"
#include "tests/faults/faults_fixture.h"
#include "tests/support/measured_program.h"

namespace macula::faults {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kInstrumented = true;  ///< no limit on memory and no preloaded library stands it
#else
constexpr bool kInstrumented = false;
#endif

constexpr double kRefresh_ms = 1000.0 / 72.0;

template <class Event>
bool take_event(EndpointClient& viewer) {
  while (auto event = viewer.endpoint().take_event())
    if (std::holds_alternative<Event>(*event)) return true;
  return false;
}

/// How many of the frames do not decode.
int torn(const std::vector<net::ReceivedFrame>& frames) {
  const base::SteadyClock clock;
  frames::FrameDecoder decoder(clock);
  int count = 0;
  for (const net::ReceivedFrame& frame : frames) count += decoder.decode(frame) ? 0 : 1;
  return count;
}

TEST(ServerFaults, AKilledServerTearsNoFrameStopsNoDisplayAndIsFoundAgain) {
  const TemporaryFolder keys;
  auto server = std::make_unique<ServerProcess>(keys.path());
  const std::string endpoint = server->endpoint();
  const auto viewer = viewer_of(endpoint, keys.path());
  ASSERT_TRUE(viewer->step_until_frames(10));
  double longest_call_ms = 0.0;
  const double recovery_ms = least_of(4, 1000.0, [&] {
    server->signal(SIGKILL);
    server->status();
    std::vector<double> calls_ms;
    for (const auto down = Clock::now(); Clock::now() - down < 700ms;) {
      const auto begin = Clock::now();
      viewer->step(0ms);
      calls_ms.push_back(ms_since(begin));
      std::this_thread::sleep_for(2ms);
    }
    longest_call_ms = quantile(calls_ms, 0.99);
    server = std::make_unique<ServerProcess>(keys.path(), endpoint);
    const std::size_t before = viewer->frames().size();
    const auto up = Clock::now();
    EXPECT_TRUE(viewer->step_until_frames(before + 1));
    return ms_since(up);
  });
  const int torn_frames = torn(viewer->frames());
  EXPECT_EQ(torn_frames, 0);
  EXPECT_LE(longest_call_ms, kRefresh_ms);
  EXPECT_LE(recovery_ms, 1000.0);
  note_fault("server SIGKILL", "0 torn, display blocked <= 1 refresh, new frame <= 1 s",
             text(torn_frames, " torn of ", viewer->frames().size(), "; display's calls p99 ",
                  longest_call_ms, " ms; frame ", recovery_ms, " ms after the server is up"));
}

TEST(ServerFaults, AStoppedServerIsStaleWithinHalfASecondAndServesOnAfterwards) {
  const TemporaryFolder keys;
  const ServerProcess server(keys.path());
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  double recovery_ms = 0.0;
  const double stale_ms = least_of(4, 500.0, [&] {
    const std::size_t before = viewer->frames().size();
    EXPECT_TRUE(viewer->step_until_frames(before + 5));
    while (take_event<net::Stale>(*viewer)) {
    }
    server.signal(SIGSTOP);
    const auto stopped = Clock::now();
    while (!take_event<net::Stale>(*viewer) && Clock::now() - stopped < 20s)
      std::this_thread::sleep_for(1ms);
    const double stale = ms_since(stopped);
    server.signal(SIGCONT);
    const auto goes_on = Clock::now();
    const std::size_t shown = viewer->frames().size();
    EXPECT_TRUE(viewer->step_until_frames(shown + 3));
    recovery_ms = ms_since(goes_on);
    return stale;
  });
  EXPECT_LE(stale_ms, 500.0);
  note_fault("server SIGSTOP", "stale <= 500 ms",
             text("stale after ", stale_ms, " ms, third frame ", recovery_ms, " ms after SIGCONT"));
}

TEST(ServerFaults, BeatsComeWhileTheServerRendersAFrameForALongTime) {
  const TemporaryFolder keys;
  loopback::LoopbackServerOptions slow;
  slow.delays.render = 1500ms;
  LoopbackServer server(keys.path(), slow);
  const auto viewer = viewer_of(server->endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(1));
  // The least of several frames: a machine that stops for half a second looks the same.
  const double stales = least_of(3, 0.0, [&] {
    const int before = viewer->stales();
    EXPECT_TRUE(viewer->step_until_frames(viewer->frames().size() + 1));
    return static_cast<double>(viewer->stales() - before);
  });
  EXPECT_EQ(stales, 0.0) << "a stopped server is stale in as long a time, see above";
  note_fault("frame of 1.5 s", "beats every 100 ms from their own thread: not stale",
             text("stale ", stales, " times"));
}

TEST(ServerFaults, StopsCleanlyWhenTold) {
  for (const int number : {SIGTERM, SIGINT}) {
    int status = -1;
    const double took_ms = least_of(3, 1000.0, [&] {
      const TemporaryFolder keys;
      ServerProcess server(keys.path());
      const auto viewer = viewer_of(server.endpoint(), keys.path());
      EXPECT_TRUE(viewer->step_until_frames(3));
      const auto told = Clock::now();
      server.signal(number);
      status = server.status();
      return ms_since(told);
    });
    EXPECT_EQ(status, 0);
    EXPECT_LE(took_ms, 1000.0);
    note_fault(number == SIGTERM ? "SIGTERM" : "SIGINT", "<= 1 s, status 0",
               text(took_ms, " ms, status ", status));
  }
}

/// Time from server to client through the estimate: a frame was received by the server after its
/// view was sampled and before it came here. How far outside, ms; and the estimate's bound.
struct AgeError {
  double outside_ms = 0.0, bound_ms = 0.0;
};
AgeError age_error(EndpointClient& viewer) {
  AgeError error;
  const auto estimate = viewer.endpoint().clock();
  if (!estimate) return {1e9, 1e9};
  error.bound_ms = units::to_ms(estimate->bound);
  for (const net::ReceivedFrame& frame : viewer.frames()) {
    const ClientTime received = estimate->to_client(frame.end.view_received);
    const double early = units::to_ms(frame.begin.view_sampled - received);
    const double late = units::to_ms(received - frame.last_byte);
    error.outside_ms = std::max({error.outside_ms, early, late});
  }
  return error;
}

/// Another clock for one process (libfaketime): realtime and, unless said otherwise, monotonic.
class ShiftedClock : public testing::TestWithParam<const char*> {};

TEST_P(ShiftedClock, ChangesNothingThatIsSeen) {
  const std::string library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";
  if (kInstrumented || !std::filesystem::exists(library))
    GTEST_SKIP() << "needs libfaketime (package faketime) and no sanitizer";
  const TemporaryFolder keys;
  const std::string file = keys.path() + "/faketime";
  std::ofstream(file) << "+0";
  std::vector<std::string> launcher{"/usr/bin/env", "LD_PRELOAD=" + library,
                                    "FAKETIME_TIMESTAMP_FILE=" + file, "FAKETIME_NO_CACHE=1"};
  const std::string shift = GetParam();
  const bool real_only = shift.front() == 'r';
  if (real_only) launcher.push_back("DONT_FAKE_MONOTONIC=1");
  if (!real_only) std::ofstream(file) << shift;  // another epoch of all its clocks from the start
  const ServerProcess server(keys.path(), "tcp://127.0.0.1:0", launcher);
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(10));
  if (real_only) std::ofstream(file) << shift.substr(1);  // its wall clock jumps
  const auto jumped = Clock::now();
  double longest_ms = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto begin = Clock::now();
    ASSERT_TRUE(viewer->step_until_frames(viewer->frames().size() + 1));
    longest_ms = std::max(longest_ms, ms_since(begin));
  }
  ASSERT_TRUE(viewer->step_until([&] {
    const AgeError now = age_error(*viewer);
    return now.bound_ms <= 2.0 || Clock::now() - jumped > 10s;
  }));
  const AgeError error = age_error(*viewer);
  EXPECT_TRUE(kept_its_session(*viewer));
  EXPECT_LE(error.outside_ms, error.bound_ms);
  note_fault((real_only ? "realtime jump " : "all clocks ") + shift,
             "no visible effect, age error <= 2 ms",
             text("one session, ages within ", error.bound_ms, " ms, longest wait for a frame ",
                  longest_ms, " ms"));
}
INSTANTIATE_TEST_SUITE_P(Shifts, ShiftedClock,
                         testing::Values("r+3600", "r-3600", "+3600", "-3600"),
                         [](const auto& shift) {
                           std::string name = shift.param;
                           std::replace(name.begin(), name.end(), '+', 'f');
                           std::replace(name.begin(), name.end(), '-', 'b');
                           return name;
                         });

/// TCP connections that say nothing.
class SilentCrowd {
 public:
  SilentCrowd(const std::string& endpoint, int count) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port =
        htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (int i = 0; i < count; ++i) {
      sockets_.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
      ::connect(sockets_.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
  }
  ~SilentCrowd() {
    for (const int socket : sockets_) ::close(socket);
  }

 private:
  std::vector<int> sockets_;
};

TEST(ServerFaults, WithoutDescriptorsItKeepsItsClientAndTakesOthersLater) {
  const TemporaryFolder keys;
  const ServerProcess server(keys.path(), "tcp://127.0.0.1:0", {"/usr/bin/prlimit", "--nofile=64"});
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(5));
  int most = 0;
  {
    const SilentCrowd crowd(server.endpoint(), 200);
    ASSERT_TRUE(viewer->step_until([&] {
      most = std::max(most, server.size().descriptors);
      return most >= 63;
    }));
    const std::size_t before = viewer->frames().size();
    EXPECT_TRUE(viewer->step_until_frames(before + 20));
    EXPECT_TRUE(server.runs());
  }
  const bool kept = kept_its_session(*viewer);
  EXPECT_TRUE(kept);
  const auto newcomer = viewer_of(server.endpoint(), keys.path());
  EXPECT_TRUE(newcomer->step_until_frames(3));
  note_fault("EMFILE", "shed load, keep the session",
             text(most, " of 64 descriptors in use, 20 frames meanwhile, session ",
                  kept ? "kept" : "begun anew", ", a newcomer served after"));
}

TEST(ServerFaults, WithoutMemoryItRefusesTheLargeFrameAndKeepsTheSmallOnes) {
  if (kInstrumented) GTEST_SKIP() << "the sanitizer's shadow needs more than any limit";
  const TemporaryFolder keys;
  // What it has after a frame, and 150 MB: enough for small eyes, far too little for huge ones.
  double settled_mb = 0.0;
  const ServerProcess server(keys.path());
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(5));
  settled_mb = server.size().resident_mb;
  server.limit_more_memory(150ULL << 20);
  const TemporaryFolder other_keys;
  const auto other = net::load_or_make_keys(other_keys.path(), net::Role::Client);
  ASSERT_TRUE(other);
  ASSERT_TRUE(net::allow_client(keys.path(), "huge", other->public_z85));
  EndpointClient huge(server.endpoint(), other_keys.path(),
                      net::load_or_make_keys(keys.path(), net::Role::Server)->public_z85, 4096);
  for (int i = 0; i < 200; ++i) {
    huge.step(1ms);
    viewer->step(4ms);
  }
  const std::size_t before = viewer->frames().size();
  EXPECT_TRUE(viewer->step_until_frames(before + 10));
  EXPECT_TRUE(server.runs());
  EXPECT_TRUE(kept_its_session(*viewer));
  note_fault("memory limit", "shed load, keep the session, no abort",
             text(settled_mb, " MB and 150 more allowed: frames of 2 x 4096 x 4096 got ",
                  huge.frames().size(), ", the small client went on"));
}

/// Scenes are read at the start: what cannot be read ends it with a sentence, before anyone is
/// served.
TEST(ServerFaults, ScenesThatCannotBeReadEndItWithASentence) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, const std::string& contents) {
    std::ofstream(folder.path() + "/" + name) << contents;
    return folder.path() + "/" + name;
  };
  const std::vector<std::string> scenes{
      folder.path() + "/missing.gltf",
      write("empty.gltf", ""),
      write("truncated.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":)"),
      write("truncated.ply", "ply\nformat ascii 1.0\nelement vertex 9\n"),
      write("nothing.obj", "o a\n"),
      write("damaged.sdf.json", "{\"shape\":"),
      folder.path()};
  int told = 0;
  for (const std::string& scene : scenes) {
    const auto run =
        test::run_measured({MACULA_SERVER_PROGRAM, "--scene", scene, "--keys", folder.path()});
    EXPECT_EQ(run.status, 2) << scene << ": " << run.output;
    EXPECT_NE(run.output.find(scene), std::string::npos) << run.output;
    told += run.status == 2 ? 1 : 0;
  }
  note_fault("scene missing, truncated, no scene", "0 crashes, a sentence",
             text(told, " of ", scenes.size(), " named, status 2"));
}

TEST(ServerFaults, AFullDiskEndsNoServer) {
  const TemporaryFolder keys;
  const ServerProcess recording(keys.path(), "tcp://127.0.0.1:0", {}, {"--record", "/dev/full"});
  const auto viewer = viewer_of(recording.endpoint(), keys.path());
  EXPECT_TRUE(viewer->step_until_frames(30));
  EXPECT_TRUE(recording.runs());
  // Its log, once it is ready, goes to a full disk too.
  const TemporaryFolder log_keys;
  const ServerProcess logging(log_keys.path(), "tcp://127.0.0.1:0",
                              {"/bin/sh", "-c", "exec \"$@\" 2>/dev/full", "sh"}, {"--verbose"});
  const auto other = viewer_of(logging.endpoint(), log_keys.path());
  EXPECT_TRUE(other->step_until_frames(30));
  EXPECT_TRUE(logging.runs());
  note_fault("disk full (ENOSPC)", "no abort",
             text("recording: ", viewer->frames().size(),
                  " frames streamed, log: ", other->frames().size()));
}

}  // namespace
}  // namespace macula::faults
