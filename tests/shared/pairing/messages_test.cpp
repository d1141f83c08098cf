#include "shared/pairing/messages.h"

#include <gtest/gtest.h>

#include "tests/shared/pairing/pairing_fixture.h"

namespace macula::pairing {
namespace {

std::vector<Message> one_of_each() {
  Share share{};
  share.fill(7);
  return {Greeting{{1, 2, 3}}, Offer{{4, 5, 6}, share}, Proof{share, "sealed bytes"},
          Grant{"other sealed bytes"}, Denial{DenialReason::LockedOut, 300}};
}

TEST(PairingMessages, SurviveTheWire) {
  for (const Message& message : one_of_each()) {
    const auto decoded = decode(encode(message));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->index(), message.index());
    EXPECT_EQ(encode(*decoded), encode(message));
  }
}

TEST(PairingMessages, OfAnotherLengthVersionOrKindAreRefused) {
  for (const Message& message : one_of_each()) {
    const std::string good = encode(message);
    const bool is_open_ended =
        std::holds_alternative<Proof>(message) || std::holds_alternative<Grant>(message);
    EXPECT_EQ(decode(good + "x").has_value(), is_open_ended);
    EXPECT_FALSE(decode(good.substr(0, 5)));
    std::string other = good;
    other[4] = 2;
    EXPECT_FALSE(decode(other)) << "version";
    other = good;
    other[5] = 99;
    EXPECT_FALSE(decode(other)) << "kind";
  }
  EXPECT_FALSE(decode(encode(Grant{std::string(kMostBytes, 'x')}))) << "longer than allowed";
}

TEST(Seal, OpensUnderItsKeyAndDirectionOnly) {
  SessionKey key{};
  key.fill(3);
  const std::string sealed = seal(kHeadset, key, Direction::FromGuest);
  EXPECT_EQ(open_seal(sealed, key, Direction::FromGuest), kHeadset);
  EXPECT_FALSE(open_seal(sealed, key, Direction::FromHost));
  SessionKey other = key;
  other[63] ^= 1;
  EXPECT_FALSE(open_seal(sealed, other, Direction::FromGuest));
}

TEST(Seal, IsBrokenByAnyBit) {
  SessionKey key{};
  const std::string sealed = seal(kHeadset, key, Direction::FromHost);
  for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    std::string damaged = sealed;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    EXPECT_FALSE(open_seal(damaged, key, Direction::FromHost)) << bit;
  }
  for (std::size_t size = 0; size < sealed.size(); ++size)
    EXPECT_FALSE(open_seal(sealed.substr(0, size), key, Direction::FromHost)) << size;
}

TEST(Seal, HidesKeyAndName) {
  SessionKey key{};
  const std::string sealed = seal(kHeadset, key, Direction::FromGuest);
  EXPECT_EQ(sealed.find(kHeadset.name), std::string::npos);
  EXPECT_EQ(sealed.find(std::string(8, static_cast<char>(0xC1))), std::string::npos);
}

}  // namespace
}  // namespace macula::pairing
