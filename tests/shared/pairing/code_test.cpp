#include "shared/pairing/code.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/shared/pairing/pairing_fixture.h"

namespace macula::pairing {
namespace {

TEST(PairingCode, ReadsSixDigitsHoweverTheyAreSpaced) {
  for (const char* typed : {"012345", "012 345", " 01-23-45 "}) {
    const auto code = Code::parse(typed);
    ASSERT_TRUE(code) << typed;
    EXPECT_EQ(code->digits(), "012345");
    EXPECT_EQ(code->spaced(), "012 345");
  }
}

TEST(PairingCode, RefusesWhatIsNotSixDigits) {
  for (const char* typed : {"", "12345", "1234567", "12345a", "١٢٣٤٥٦", "123456789012345678901"})
    EXPECT_FALSE(Code::parse(typed)) << typed;
}

/// Chi-square of the first digit over 20,000 codes: 9 degrees of freedom, 27.9 at p = 0.001.
TEST(PairingCode, IsDrawnUniformly) {
  const Random random = seeded_random(5);
  std::array<int, 10> counts{};
  constexpr int kDrawn = 20'000;
  for (int i = 0; i < kDrawn; ++i)
    ++counts[static_cast<std::size_t>(Code::draw(random).digits().front() - '0')];
  double chi_square = 0.0;
  for (const int count : counts)
    chi_square += (count - kDrawn / 10.0) * (count - kDrawn / 10.0) / (kDrawn / 10.0);
  EXPECT_LT(chi_square, 27.9);
}

}  // namespace
}  // namespace macula::pairing
