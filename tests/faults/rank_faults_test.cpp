// A server of two ranks under mpirun, one of which dies or hangs.
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "tests/faults/faults_fixture.h"

namespace macula::faults {
namespace {

using Arguments = std::vector<std::string>;

/// mpirun, as root in a container too.
Arguments two_ranks() {
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  return {MACULA_MPIRUN, "--oversubscribe", "--bind-to", "none", "-n", "2"};
}

/// The process of a rank: mpirun starts them one after the other.
pid_t rank_of(const ServerProcess& server, std::size_t rank) {
  const std::string pid = std::to_string(server.pid());
  std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
  std::vector<pid_t> all;
  for (pid_t child = 0; children >> child;) all.push_back(child);
  return rank < all.size() ? all[rank] : -1;
}

std::string farewell(EndpointClient& viewer) {
  for (const auto begin = Clock::now(); Clock::now() - begin < 10s;) {
    while (auto event = viewer.endpoint().take_event())
      if (const auto* gone = std::get_if<net::Disconnected>(&*event)) return gone->text;
    viewer.endpoint().publish(viewer.next_view());
    (void)viewer.endpoint().wait_frame(4ms);
  }
  return {};
}

/// Of a server that was started where the one before served.
double resumed_after_ms(EndpointClient& viewer, const std::string& keys,
                        const std::string& endpoint) {
  const std::size_t before = viewer.frames().size();
  const auto begin = Clock::now();
  const ServerProcess again(keys, endpoint, two_ranks());
  EXPECT_EQ(again.endpoint(), endpoint);
  EXPECT_TRUE(viewer.step_until_frames(before + 1));
  return ms_since(begin);
}

TEST(RankFaults, AKilledRankEndsTheServerAndAnotherOneIsFoundAgain) {
  const TemporaryFolder keys;
  ServerProcess server(keys.path(), "tcp://127.0.0.1:0", two_ranks());
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(5));
  const pid_t rank = rank_of(server, 1);
  ASSERT_GT(rank, 1);
  const auto killed = Clock::now();
  ::kill(rank, SIGKILL);
  EXPECT_NE(farewell(*viewer), "");
  EXPECT_NE(server.status(), 0);
  const double ended_ms = ms_since(killed);
  const double resumed_ms = resumed_after_ms(*viewer, keys.path(), server.endpoint());
  EXPECT_LE(ended_ms, 10'000.0);
  EXPECT_LE(resumed_ms, 5000.0);
  note_fault("rank SIGKILL", "server ends with a status, a new frame <= 5 s after the next starts",
             text("ended after ", ended_ms, " ms, frame ", resumed_ms, " ms after the start"));
}

TEST(RankFaults, AHungRankIsNoticedAndNamedToClients) {
  const TemporaryFolder keys;
  ServerProcess server(keys.path(), "tcp://127.0.0.1:0", two_ranks(),
                       {"--rank-timeout-ms", "1000"});
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(5));
  const pid_t rank = rank_of(server, 1);
  ASSERT_GT(rank, 1);
  const auto stopped = Clock::now();
  ::kill(rank, SIGSTOP);
  const std::string reason = farewell(*viewer);
  const double noticed_ms = ms_since(stopped);
  EXPECT_NE(reason.find("rank 1 of 2"), std::string::npos) << reason;
  EXPECT_EQ(server.status(), 1);
  const double resumed_ms = resumed_after_ms(*viewer, keys.path(), server.endpoint());
  EXPECT_LE(noticed_ms, 5000.0);
  EXPECT_LE(resumed_ms, 5000.0);
  note_fault("rank SIGSTOP, --rank-timeout-ms 1000", "named to clients, status 1, <= 5 s",
             text("named after ", noticed_ms, " ms, frame ", resumed_ms, " ms after the start"));
}

TEST(RankFaults, TwoRanksStopCleanlyWhenTold) {
  const TemporaryFolder keys;
  ServerProcess server(keys.path(), "tcp://127.0.0.1:0", two_ranks());
  const auto viewer = viewer_of(server.endpoint(), keys.path());
  ASSERT_TRUE(viewer->step_until_frames(3));
  ::kill(rank_of(server, 0), SIGTERM);
  EXPECT_EQ(server.status(), 0);
}

}  // namespace
}  // namespace macula::faults
