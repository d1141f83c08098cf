#include "shared/base/utf8.h"

#include <gtest/gtest.h>
#include <string>

namespace macula::base {
namespace {

bool is_valid(std::string_view text) {
  return valid_utf8_bytes(text) == text.size();
}

TEST(Utf8, TakesEveryLengthAtBothItsEnds) {
  for (const std::string_view text :
       {"", "a", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "gr\xC3\xBC\xC3\x9F"})
    EXPECT_TRUE(is_valid(text)) << text;
  EXPECT_TRUE(is_valid(std::string_view("\0", 1)));
}

TEST(Utf8, RefusesWhatIsOverlongASurrogateBeyondUnicodeOrCutOff) {
  for (const std::string_view text :
       {"\x80", "\xC0\x80", "\xC1\xBF", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF",
        "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF", "\xC3", "\xE2\x82", "\xF0\x9F\x98"})
    EXPECT_EQ(valid_utf8_bytes(text), 0U) << text;
}

TEST(Utf8, TellsWhereTheTextEnds) {
  EXPECT_EQ(valid_utf8_bytes("ab\xC3\xBC\xFFxy"), 4U);
}

}  // namespace
}  // namespace macula::base
