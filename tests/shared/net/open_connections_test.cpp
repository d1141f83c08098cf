#include "shared/net/open_connections.h"

#include <gtest/gtest.h>

namespace macula::net {
namespace {

using std::chrono::seconds;

constexpr SteadyTime kStart{std::chrono::hours{1}};

TEST(OpenConnections, AreDeadOnceTheyAreOldAndNoPeers) {
  OpenConnections connections;
  for (int fd = 10; fd < 15; ++fd) connections.on({ZMQ_EVENT_ACCEPTED, fd}, kStart);
  EXPECT_EQ(connections.open(), 5U);
  EXPECT_EQ(connections.dead(2, kStart + seconds{14}), 0U) << "a handshake may still go on";
  EXPECT_EQ(connections.dead(2, kStart + seconds{15}), 3U);
  EXPECT_EQ(connections.dead(7, kStart + seconds{15}), 0U) << "some of the peers are new";
}

TEST(OpenConnections, ThatEndAreCountedNoMore) {
  OpenConnections connections;
  for (int fd = 10; fd < 15; ++fd) connections.on({ZMQ_EVENT_ACCEPTED, fd}, kStart);
  for (int fd = 10; fd < 13; ++fd) connections.on({ZMQ_EVENT_DISCONNECTED, fd}, kStart);
  EXPECT_EQ(connections.dead(0, kStart + seconds{20}), 2U);
  connections.on({ZMQ_EVENT_ACCEPTED, 13}, kStart + seconds{20});
  EXPECT_EQ(connections.dead(0, kStart + seconds{20}), 1U) << "the descriptor is used anew";
}

}  // namespace
}  // namespace macula::net
