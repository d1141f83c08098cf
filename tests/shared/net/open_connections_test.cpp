#include "shared/net/open_connections.h"

#include <gtest/gtest.h>

namespace macula::net {
namespace {

using std::chrono::seconds;

constexpr SteadyTime kStart{std::chrono::hours{1}};

OpenConnections five_accepted() {
  OpenConnections connections(seconds{15});
  for (int fd = 10; fd < 15; ++fd) connections.on({ZMQ_EVENT_ACCEPTED, fd}, kStart);
  return connections;
}

TEST(OpenConnections, AreSilentOnceNothingCameForLong) {
  OpenConnections connections = five_accepted();
  EXPECT_EQ(connections.open(), 5U);
  for (const int fd : {11, 13}) connections.heard(fd, kStart + seconds{10});
  EXPECT_TRUE(connections.take_silent(kStart + seconds{14}).empty());
  EXPECT_EQ(connections.take_silent(kStart + seconds{15}), (std::vector<int>{10, 12, 14}));
}

TEST(OpenConnections, AreNamedAgainOnlyAfterAsLong) {
  OpenConnections connections = five_accepted();
  EXPECT_EQ(connections.take_silent(kStart + seconds{15}).size(), 5U);
  EXPECT_TRUE(connections.take_silent(kStart + seconds{29}).empty());
  EXPECT_EQ(connections.take_silent(kStart + seconds{30}).size(), 5U);
}

TEST(OpenConnections, ThatEndAreForgottenAndTheirDescriptorsUsedAnew) {
  OpenConnections connections = five_accepted();
  for (int fd = 10; fd < 14; ++fd) connections.on({ZMQ_EVENT_DISCONNECTED, fd}, kStart);
  connections.on({ZMQ_EVENT_ACCEPTED, 13}, kStart + seconds{10});
  connections.heard(12, kStart + seconds{10});  // too late
  EXPECT_EQ(connections.take_silent(kStart + seconds{20}), (std::vector<int>{14}));
}

TEST(OpenConnections, ThatEndWithoutAWordAreCounted) {
  OpenConnections connections = five_accepted();
  connections.heard(10, kStart);
  for (int fd = 10; fd < 13; ++fd) connections.on({ZMQ_EVENT_DISCONNECTED, fd}, kStart);
  EXPECT_EQ(connections.ended_mute(), 2U);
  connections.on({ZMQ_EVENT_DISCONNECTED, 12}, kStart);
  EXPECT_EQ(connections.ended_mute(), 2U) << "an end of nothing";
}

}  // namespace
}  // namespace macula::net
