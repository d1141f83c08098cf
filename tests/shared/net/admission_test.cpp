#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "shared/base/text.h"
#include "shared/net/wire.h"
#include "shared/net/zap.h"
#include "shared/net/zmq_socket.h"
#include "tests/shared/net/net_fixture.h"
#include "tests/support/fault_table.h"

namespace macula::net {
namespace {

/// Keys of a client on another machine: it knows the server, the server does not know it.
struct StrangerKeys {
  explicit StrangerKeys(const std::string& server_keys) {
    std::filesystem::copy(server_keys + "/server.pub", folder.path() + "/server.pub");
  }
  std::string public_key() const { return *load_public_key(folder.path() + "/client.pub"); }
  TemporaryFolder folder;
};

TEST(Admission, AnUnknownClientGetsNothingAndEntersOnceAllowedWithoutARestart) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  StrangerKeys stranger(keys.path());
  const auto client =
      make_client(client_options(server.endpoint().endpoint(), stranger.folder.path()));
  const auto refused = next_event<Refused>(*client);
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->refusal.text.find(stranger.folder.path() + "/client.pub"), std::string::npos);
  EXPECT_NE(refused->refusal.text.find("allowed/"), std::string::npos);
  EXPECT_FALSE(server.next<HelloReceived>(1500ms));
  EXPECT_EQ(client->counters().bytes, 0U);
  EXPECT_GE(server.endpoint().counters().refused_handshakes, 1U);

  ASSERT_TRUE(allow_client(keys.path(), "stranger", stranger.public_key()));
  EXPECT_TRUE(meet(server, *client));
}

TEST(Admission, ARevokedClientIsExpelledWhileItStreamsAndIsNotHeardAgain) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  StrangerKeys guest(keys.path());
  const auto options = client_options(server.endpoint().endpoint(), guest.folder.path());
  ASSERT_TRUE(load_or_make_keys(guest.folder.path(), Role::Client));
  ASSERT_TRUE(allow_client(keys.path(), "guest", guest.public_key()));
  const auto client = make_client(options);
  ASSERT_TRUE(meet(server, *client));
  ASSERT_TRUE(revoke_client(keys.path(), "guest"));
  const auto bye = server.next<ByeReceived>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->peer, server.peer());
  ASSERT_TRUE(next_event<Refused>(*client));
  for (std::uint64_t i = 1; i <= 50; ++i) {
    client->publish(make_view(i));
    EXPECT_FALSE(server.next<ViewReceived>(10ms));
  }
}

TEST(Admission, AClientThatHoldsTheWrongServerKeyIsToldSo) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  auto options = client_options(server.endpoint().endpoint(), keys.path());
  options.server_key_z85 = make_key_pair().public_z85;
  const auto client = make_client(options);
  const auto refused = next_event<Refused>(*client);
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->refusal.text.find("server.pub"), std::string::npos) << refused->refusal.text;
  EXPECT_FALSE(server.next<HelloReceived>(500ms));
}

TEST(Admission, NobodyThereIsSaidAsSuch) {
  TemporaryFolder keys;
  ASSERT_TRUE(load_or_make_keys(keys.path(), Role::Server));
  std::string nowhere;
  {
    PlainServer server(keys.path());
    nowhere = server.endpoint().endpoint();
  }
  const auto client = make_client(client_options(nowhere, keys.path()));
  const auto disconnected = next_event<Disconnected>(*client);
  ASSERT_TRUE(disconnected);
  EXPECT_NE(disconnected->text.find("no server can be reached at " + nowhere), std::string::npos)
      << disconnected->text;
}

TEST(Admission, APortInUseIsNamedWithItsRemedy) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  base::SteadyClock clock;
  ServerEndpointOptions options;
  options.bind = server.endpoint().endpoint();
  options.key_folder = keys.path();
  const auto second = ServerEndpoint::create(options, clock);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().where, options.bind);
  EXPECT_NE(second.error().remedy.find("--bind"), std::string::npos);
}

TEST(Admission, AddressesThatCannotBeListenedOnAreRefused) {
  TemporaryFolder keys;
  base::SteadyClock clock;
  for (const char* bind : {"", "7788", "udp://127.0.0.1:1", "tcp://127.0.0.1", "tcp://127.0.0.1:x",
                           "tcp://127.0.0.1:70000", "tcp://nosuchhost:1", "tcp://192.0.2.1:0"}) {
    ServerEndpointOptions options;
    options.bind = bind;
    options.key_folder = keys.path();
    const auto created = ServerEndpoint::create(options, clock);
    ASSERT_FALSE(created) << bind;
    EXPECT_EQ(created.error().exit_status(), 2) << bind;
  }
}

TEST(Admission, AClientWithoutTheServersKeyIsToldWhereItBelongs) {
  TemporaryFolder keys;
  base::SteadyClock clock;
  const auto created =
      ClientEndpoint::create(client_options("tcp://127.0.0.1:1", keys.path()), clock);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().where, keys.path() + "/server.pub");
  EXPECT_NE(created.error().remedy.find("server.pub"), std::string::npos);
}

TEST(Admission, ZapAdmitsExactKeysOfCurveAndNothingElse) {
  TemporaryFolder keys;
  const KeyPair pair = make_key_pair();
  ASSERT_TRUE(allow_client(keys.path(), "one", pair.public_z85));
  std::string raw(32, '\0');
  zmq_z85_decode(reinterpret_cast<std::uint8_t*>(raw.data()), pair.public_z85.c_str());
  const ZapRequest good{"1.0", "macula", "192.0.2.7", "CURVE", raw};
  EXPECT_EQ(admitted_key(good, "macula", keys.path()), pair.public_z85);
  const auto refused = [&](auto&& spoil) {
    ZapRequest request = good;
    spoil(request);
    return admitted_key(request, "macula", keys.path()).empty();
  };
  EXPECT_TRUE(refused([](ZapRequest& r) { r.key[31] ^= 1; }));
  EXPECT_TRUE(refused([](ZapRequest& r) { r.key.pop_back(); }));
  EXPECT_TRUE(refused([](ZapRequest& r) { r.key.clear(); }));
  EXPECT_TRUE(refused([](ZapRequest& r) { r.mechanism = "NULL"; }));
  EXPECT_TRUE(refused([](ZapRequest& r) { r.domain = "other"; }));
  EXPECT_TRUE(refused([](ZapRequest& r) { r.version = "2.0"; }));
}

TEST(Admission, TheOwnClientKeyIsTrustedOnLoopbackOnly) {
  TemporaryFolder keys;
  const auto own = load_or_make_keys(keys.path(), Role::Client);
  std::string raw(32, '\0');
  zmq_z85_decode(reinterpret_cast<std::uint8_t*>(raw.data()), own->public_z85.c_str());
  const auto admitted = [&](const char* address) {
    return !admitted_key({"1.0", "d", address, "CURVE", raw}, "d", keys.path()).empty();
  };
  EXPECT_TRUE(admitted("127.0.0.1"));
  EXPECT_TRUE(admitted("::1"));
  EXPECT_FALSE(admitted("192.0.2.7"));
  EXPECT_FALSE(admitted(""));
}

/// A client of our own making, allowed by its key, that says whatever the test wants.
class RawClient {
 public:
  RawClient(const std::string& endpoint, const std::string& folder)
      : socket_(context_, SocketKind::Dealer) {
    const auto keys = load_or_make_keys(folder, Role::Client);
    set_common_options(socket_, Limits{});
    socket_.set(ZMQ_CURVE_SERVERKEY, *load_public_key(folder + "/server.pub"));
    socket_.set(ZMQ_CURVE_PUBLICKEY, keys->public_z85);
    socket_.set(ZMQ_CURVE_SECRETKEY, keys->secret_z85);
    EXPECT_TRUE(socket_.connect(endpoint));
  }
  void say(const std::string& bytes) {
    EXPECT_TRUE(eventually([&] {
      return socket_.send({bytes, nullptr, 0, 0}) == SendOutcome::Sent;
    }));
  }
  std::optional<Refusal> hear_refusal() {
    std::optional<Refusal> refusal;
    eventually([&] {
      Incoming message;
      if (!socket_.receive(message)) return false;
      const auto decoded = decode_envelope(message.parts[0].bytes());
      if (!decoded || !std::holds_alternative<Refusal>(*decoded)) return false;
      refusal = std::get<Refusal>(*decoded);
      return true;
    });
    return refusal;
  }

 private:
  Context context_;
  Socket socket_;
};

TEST(Admission, AnotherWireVersionIsRefusedNamingBoth) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  RawClient client(server.endpoint().endpoint(), keys.path());
  std::string bytes = encode_envelope(Ping{1, {}});
  bytes[3] = 7;
  const auto said = std::chrono::steady_clock::now();
  client.say(bytes);
  const auto refusal = client.hear_refusal();
  const Nanoseconds took = std::chrono::steady_clock::now() - said;
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, RefusalCode::VersionMismatch);
  EXPECT_NE(refusal->text.find("version 1"), std::string::npos) << refusal->text;
  EXPECT_NE(refusal->text.find("version 7"), std::string::npos) << refusal->text;
  macula::test::note_fault("another protocol version", "<= 1 s, names both",
                           base::concat("after ", units::to_ms(took), " ms: ", refusal->text));
}

TEST(Admission, AHelloOfAnotherVersionIsRefusedNamingBoth) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  auto options = client_options(server.endpoint().endpoint(), keys.path());
  options.hello.protocol_version = 3;
  const auto client = make_client(options);
  std::optional<Refused> refused;
  std::thread other([&] { refused = next_event<Refused>(*client); });
  EXPECT_FALSE(server.next<HelloReceived>(500ms));
  other.join();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->refusal.code, RefusalCode::VersionMismatch);
  EXPECT_NE(refused->refusal.text.find("version 1"), std::string::npos);
  EXPECT_NE(refused->refusal.text.find("version 3"), std::string::npos);
}

TEST(Admission, NonsenseFromAnAllowedClientIsRefusedAndCounted) {
  TemporaryFolder keys;
  PlainServer server(keys.path());
  RawClient client(server.endpoint().endpoint(), keys.path());
  client.say("GET / HTTP/1.1");
  const auto refusal = client.hear_refusal();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, RefusalCode::BadRequest);
  EXPECT_TRUE(eventually([&] { return server.endpoint().counters().malformed == 1; }));
}

/// Strangers with a key each, from all over 127.0.0.0/8, who know the server's key and say Hello.
/// MACULA_STRANGERS: how many (default 1000; 100000 is the long run).
TEST(Admission, StrangersFromEverywhereGetNothing) {
  const char* const asked = ::getenv("MACULA_STRANGERS");
  const int strangers = asked == nullptr ? 1000 : std::stoi(asked);
  constexpr int kAtOnce = 50;
  TemporaryFolder keys;
  PlainServer server(keys.path());
  const std::string endpoint = server.endpoint().endpoint().substr(6);  // after "tcp://"
  const std::string hello = encode_envelope(client_options("", "").hello);
  const Context context;
  std::uint64_t answers = 0;
  for (int done = 0; done < strangers; done += kAtOnce) {
    std::vector<std::unique_ptr<Socket>> sockets;
    for (int i = done; i < std::min(done + kAtOnce, strangers); ++i) {
      auto& socket = *sockets.emplace_back(std::make_unique<Socket>(context, SocketKind::Dealer));
      const KeyPair pair = make_key_pair();
      set_common_options(socket, Limits{});
      socket.set(ZMQ_IMMEDIATE, 0);
      socket.set(ZMQ_CURVE_SERVERKEY, server.endpoint().public_key_z85());
      socket.set(ZMQ_CURVE_PUBLICKEY, pair.public_z85);
      socket.set(ZMQ_CURVE_SECRETKEY, pair.secret_z85);
      const std::string source =
          base::concat("127.", 1 + i / 65025 % 255, ".", i / 255 % 255, ".", 1 + i % 255);
      ASSERT_TRUE(socket.connect("tcp://" + source + ":0;" + endpoint));
      socket.send({hello, nullptr, 0, 0});
    }
    const auto refused = static_cast<std::uint64_t>(done) + sockets.size();
    EXPECT_TRUE(
        eventually([&] { return server.endpoint().counters().refused_handshakes >= refused; }));
    Incoming answer;
    for (const auto& socket : sockets) answers += socket->receive(answer) ? 1 : 0;
  }
  EXPECT_EQ(answers, 0U);
  EXPECT_FALSE(server.endpoint().wait(std::chrono::milliseconds{200}))
      << "an event from a stranger";
  EXPECT_EQ(server.endpoint().counters().views, 0U);
  macula::test::note_fault(
      "strangers with unknown keys", "0 frames, 0 poses in 1e5 attempts (1e3 in every test run)",
      base::concat(strangers, " from all over 127.0.0.0/8: ", answers, " answers, ",
                   server.endpoint().counters().views, " views"));
}

}  // namespace
}  // namespace macula::net
