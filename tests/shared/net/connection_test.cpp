#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

TEST(Connection, AFrameArrivesBitEqualWithEverythingItWasMadeWith) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  const auto client = make_client(client_options(server.endpoint().endpoint(), keys.path()));
  const auto hello = server.next<HelloReceived>();
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->client_key_z85, *load_public_key(keys.path() + "/client.pub"));
  ASSERT_TRUE(next_event<Welcomed>(*client));

  EncodedFrame sent = make_frame(server.epoch(), 1, 300'000);
  sent.begin.kernel = "ray";
  sent.begin.seed = 7;
  server.endpoint().send_frame(hello->peer, sent);
  const auto frame = client->wait_frame(20s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->payloads.at(0), *sent.payloads[0]);
  EXPECT_EQ(frame->begin.views.at(0).grid, sent.begin.views[0].grid);
  EXPECT_EQ(frame->begin.kernel, "ray");
  EXPECT_EQ(frame->begin.seed, 7U);
  EXPECT_LE(frame->first_byte, frame->last_byte);

  const auto acked = server.next<ViewReceived>();
  ASSERT_TRUE(acked);
  EXPECT_EQ(acked->acks.epoch, server.epoch());
}

}  // namespace
}  // namespace macula::net
