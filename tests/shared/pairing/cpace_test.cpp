// The published vectors of draft-irtf-cfrg-cpace-13, appendix B.3 (ristretto255 and SHA-512).
#include "shared/pairing/cpace.h"

#include <gtest/gtest.h>

#include <vector>

namespace macula::pairing {
namespace {

std::vector<unsigned char> from_hex(std::string_view hex) {
  std::vector<unsigned char> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(
        static_cast<unsigned char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  return bytes;
}
template <class Array>
Array array_from_hex(std::string_view hex) {
  Array out{};
  const auto bytes = from_hex(hex);
  EXPECT_EQ(bytes.size(), out.size());
  std::copy(bytes.begin(), bytes.end(), out.begin());
  return out;
}
std::string text_from_hex(std::string_view hex) {
  const auto bytes = from_hex(hex);
  return {bytes.begin(), bytes.end()};
}

const std::string kChannelOfDraft =
    "oc\x0b"
    "B_responder\x0b"
    "A_initiator";
const std::string kSession = text_from_hex("7e4b4791d6a8ef019b936c79fb7f2c57");
const Share kGenerator =
    array_from_hex<Share>("a6fc82c3b8968fbb2e06fee81ca858586dea50d248f0c7ca6a18b0902a30b36b");
const Scalar kScalarA =
    array_from_hex<Scalar>("da3d23700a9e5699258aef94dc060dfda5ebb61f02a5ea77fad53f4ff0976d08");
const Scalar kScalarB =
    array_from_hex<Scalar>("d2316b454718c35362d83d69df6320f38578ed5984651435e2949762d900b80d");
const Share kShareA =
    array_from_hex<Share>("d40fb265a7abeaee7939d91a585fe59f7053f982c296ec413c624c669308f87a");
const Share kShareB =
    array_from_hex<Share>("08bcf6e9777a9c313a3db6daa510f2d398403319c2341bd506a92e672eb7e307");
const SessionKey kKey = array_from_hex<SessionKey>(
    "4c5469a16b2364c4b944ebc1a79e51d1674ad47db26e8718154f59faebfaa52d"
    "8346f30aa58377117eb20d527f2cbc5c76381f7fd372e89df8239f87f2e02ed1");

TEST(Cpace, DerivesThePublishedGeneratorAndShares) {
  EXPECT_EQ(cpace_generator({"Password", kChannelOfDraft, kSession}), kGenerator);
  EXPECT_EQ(cpace_share(kGenerator, kScalarA), kShareA);
  EXPECT_EQ(cpace_share(kGenerator, kScalarB), kShareB);
}

TEST(Cpace, DerivesThePublishedKeyOnBothSides) {
  const CpaceTranscript transcript{kShareA, kShareB, "ADa", "ADb"};
  EXPECT_EQ(cpace_key(kSession, kScalarA, kShareB, transcript), kKey);
  EXPECT_EQ(cpace_key(kSession, kScalarB, kShareA, transcript), kKey);
}

TEST(Cpace, EveryInputChangesTheGenerator) {
  for (const CpaceInputs& other : {CpaceInputs{"Passwore", kChannelOfDraft, kSession},
                                   CpaceInputs{"Password", "another channel", kSession},
                                   CpaceInputs{"Password", kChannelOfDraft, "another session"}})
    EXPECT_NE(cpace_generator(other), kGenerator);
}

TEST(Cpace, EverythingSaidChangesTheKey) {
  for (const CpaceTranscript& other : {CpaceTranscript{kShareB, kShareA, "ADa", "ADb"},
                                       CpaceTranscript{kShareA, kShareB, "ADx", "ADb"},
                                       CpaceTranscript{kShareA, kShareB, "ADa", "ADx"}})
    EXPECT_NE(cpace_key(kSession, kScalarA, kShareB, other), kKey);
}

TEST(Cpace, RefusesSharesThatAreNoElementsOrNeutral) {
  Share all_ones{};
  all_ones.fill(0xFF);
  const Share neutral{};
  for (const Share& hostile : {all_ones, neutral})
    EXPECT_FALSE(cpace_key(kSession, kScalarA, hostile, {kShareA, hostile, "ADa", "ADb"}));
}

TEST(Cpace, AScalarIsBelowTheGroupsOrder) {
  Scalar most{};
  most.fill(0xFF);
  EXPECT_EQ(cpace_scalar(most).back(), 0x0F);
}

}  // namespace
}  // namespace macula::pairing
