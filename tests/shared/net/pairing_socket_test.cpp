// Pairing over real sockets, and what a stranger gets from them.
#include "shared/net/pairing_socket.h"

#include <fstream>
#include <future>

#include "shared/net/zmq_socket.h"
#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

const base::SteadyClock kClock;

std::unique_ptr<PairingHost> make_host(const std::string& folder) {
  PairingHostOptions options;
  options.bind = "tcp://127.0.0.1:*";
  options.key_folder = folder;
  auto host = PairingHost::create(options, kClock);
  EXPECT_TRUE(host) << (host ? "" : host.error().message());
  return std::move(*host);
}

/// Runs a guest while the host serves; both results.
struct Met {
  Result<pairing::Identity> guest;
  std::optional<std::string> admitted;
};
Met meet_with(PairingHost& host, const std::string& folder, const pairing::Code& code,
              const std::string& name = "headset") {
  static const std::atomic<bool> never{false};
  auto guest = std::async(std::launch::async, [&] {
    return pair_with_server({host.endpoint(), folder, name, 10s}, code, kClock, never);
  });
  std::optional<std::string> admitted;
  while (guest.wait_for(0s) != std::future_status::ready) {
    auto served = host.serve(10ms);
    EXPECT_TRUE(served) << (served ? "" : served.error().message());
    if (served && *served) admitted = **served;
  }
  return {guest.get(), admitted};
}

TEST(PairingSocket, PairedMachinesStreamWithoutARestart) {
  TemporaryFolder server_keys, client_keys;
  PlainServer server(server_keys.path());
  const auto host = make_host(server_keys.path());
  const Met met = meet_with(*host, client_keys.path(), *host->state().code(kClock.now()));
  ASSERT_TRUE(met.guest) << met.guest.error().message();
  EXPECT_EQ(met.admitted, "headset");
  EXPECT_EQ(z85_key(met.guest->key), server.endpoint().public_key_z85());
  const auto client = make_client(client_options(server.endpoint().endpoint(), client_keys.path()));
  EXPECT_TRUE(meet(server, *client));
}

TEST(PairingSocket, AWrongCodeLeavesBothFoldersAsTheyWere) {
  TemporaryFolder server_keys, client_keys;
  const auto host = make_host(server_keys.path());
  const std::string right = host->state().code(kClock.now())->digits();
  const auto wrong = pairing::Code::parse(right == "000000" ? "000001" : "000000");
  const Met met = meet_with(*host, client_keys.path(), *wrong);
  ASSERT_FALSE(met.guest);
  EXPECT_NE(met.guest.error().what.find("code is wrong"), std::string::npos);
  EXPECT_FALSE(met.admitted);
  EXPECT_TRUE(list_clients(server_keys.path()).empty());
  EXPECT_FALSE(std::filesystem::exists(client_keys.path() + "/server.pub"));
}

TEST(PairingSocket, NobodyThereIsSaidWithWhatToDo) {
  TemporaryFolder keys;
  const std::atomic<bool> never{false};
  const auto paired = pair_with_server({"tcp://127.0.0.1:1", keys.path(), "x", 200ms},
                                       *pairing::Code::parse("123456"), kClock, never);
  ASSERT_FALSE(paired);
  EXPECT_NE(paired.error().remedy.find("macula-server pair"), std::string::npos);
}

/// What is no pairing message, or longer than a kilobyte, costs no try and hurts nobody.
TEST(PairingSocket, GarbageGetsAtMostADenial) {
  TemporaryFolder server_keys, client_keys;
  const auto host = make_host(server_keys.path());
  Context context;
  Socket stranger(context, SocketKind::Dealer);
  stranger.set(ZMQ_LINGER, 0);
  ASSERT_TRUE(stranger.connect(host->endpoint()));
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    std::string noise(random() % 4096, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    if (i % 2 == 0) noise.replace(0, std::min<std::size_t>(5, noise.size()), "MACP\x01");
    stranger.send({noise, nullptr, 0, 0});
    ASSERT_TRUE(host->serve(1ms));
  }
  const std::size_t denial_bytes = encode(pairing::Message{pairing::Denial{}}).size();
  for (Incoming answer; stranger.receive(answer);)
    EXPECT_EQ(answer.parts[0].bytes().size(), denial_bytes);
  EXPECT_EQ(host->state().counters().wrong_codes, 0U);
  const Met met = meet_with(*host, client_keys.path(), *host->state().code(kClock.now()));
  EXPECT_TRUE(met.guest);
}

TEST(ClientList, ListsAndRevokesByName) {
  TemporaryFolder keys;
  const std::string one = make_key_pair().public_z85, two = make_key_pair().public_z85;
  EXPECT_EQ(*allow_new_client(keys.path(), "head set/1", one), "head-set-1");
  EXPECT_EQ(*allow_new_client(keys.path(), "head set/1", two), "head-set-1-2");
  EXPECT_EQ(*allow_new_client(keys.path(), "another", one), "head-set-1") << "known already";
  ASSERT_EQ(list_clients(keys.path()).size(), 2U);
  const auto unknown = revoke_client(keys.path(), "nobody");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().remedy.find("head-set-1-2"), std::string::npos);
  ASSERT_TRUE(revoke_client(keys.path(), "head-set-1"));
  EXPECT_EQ(*allowed_clients(keys.path(), TrustOwnClient::No), std::vector<std::string>{two});
}

TEST(ClientList, NoNameLeavesTheFolder) {
  TemporaryFolder keys;
  for (const std::string hostile : {"../../etc/passwd", "..", "", ".hidden", "a\nb",
                                    "a name that is longer than any file name may be, by far, and "
                                    "then some more of it to be sure"}) {
    const auto name = allow_new_client(keys.path(), hostile, make_key_pair().public_z85);
    ASSERT_TRUE(name) << hostile << ": " << name.error().message();
    EXPECT_TRUE(std::filesystem::exists(keys.path() + "/allowed/" + *name + ".pub"));
  }
  EXPECT_FALSE(revoke_client(keys.path(), "../server"));
}

}  // namespace
}  // namespace macula::net
