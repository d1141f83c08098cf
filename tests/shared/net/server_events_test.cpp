#include "shared/net/server_events.h"

#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

ViewReceived viewed(std::uint64_t peer, std::uint64_t sequence, std::uint64_t received,
                    ServerTime at) {
  return {PeerId{peer}, make_view(sequence), {1, received, 0, 0, false}, at};
}
ViewReceived acked(std::uint64_t peer, std::uint64_t received, ServerTime at) {
  return {PeerId{peer}, std::nullopt, {1, received, 0, 0, false}, at};
}
template <class T>
std::optional<T> take(ServerEvents& events) {
  auto event = events.wait(0ms);
  if (!event || !std::holds_alternative<T>(*event)) return std::nullopt;
  return std::get<T>(*event);
}

TEST(ServerEvents, TheNewestViewReplacesTheOneNobodyTook) {
  ServerEvents events;
  for (std::uint64_t i = 1; i <= 10'000; ++i) events.put(viewed(1, i, 0, ServerTime{1ms}));
  const auto view = take<ViewReceived>(events);
  ASSERT_TRUE(view && view->view);
  EXPECT_EQ(view->view->sequence, 10'000U);
  EXPECT_FALSE(events.wait(0ms));
}

TEST(ServerEvents, AcksComeWithTheViewThatWaits) {
  ServerEvents events;
  events.put(viewed(1, 5, 2, ServerTime{1ms}));
  events.put(acked(1, 3, ServerTime{9ms}));
  const auto merged = take<ViewReceived>(events);
  ASSERT_TRUE(merged && merged->view);
  EXPECT_EQ(merged->view->sequence, 5U);
  EXPECT_EQ(merged->acks.received, 3U);
  EXPECT_EQ(merged->received, ServerTime{1ms});
}

TEST(ServerEvents, PeersAreKeptApart) {
  ServerEvents events;
  events.put(viewed(1, 5, 0, {}));
  events.put(viewed(2, 8, 0, {}));
  EXPECT_EQ(take<ViewReceived>(events)->view->sequence, 5U);
  EXPECT_EQ(take<ViewReceived>(events)->view->sequence, 8U);
}

TEST(ServerEvents, EveryFrameSentIsTold) {
  ServerEvents events;
  events.put(FrameSent{PeerId{1}, 1, 1, {}, {}, false});
  events.put(FrameSent{PeerId{1}, 1, 2, {}, {}, true});
  EXPECT_EQ(take<FrameSent>(events)->frame, 1U);
  EXPECT_EQ(take<FrameSent>(events)->frame, 2U);
}

TEST(ServerEvents, CloseWakesWhoWaits) {
  ServerEvents events;
  std::thread closer([&] { events.close(); });
  EXPECT_FALSE(events.wait(60s));
  closer.join();
}

}  // namespace
}  // namespace macula::net
