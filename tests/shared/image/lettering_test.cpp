#include "shared/image/lettering.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace macula::image {
namespace {

constexpr Rgb8 kInk{255, 255, 255};

Plane<Rgb8> written(const std::string& text, int dot_px = 1) {
  Plane<Rgb8> picture(text_width_px(text, dot_px), text_height_px(dot_px));
  draw_text(picture, {0, 0}, text, dot_px, kInk);
  return picture;
}

std::string dots(const Plane<Rgb8>& picture) {
  std::string result;
  for (const Rgb8& pixel : picture.pixels()) result += pixel == kInk ? '#' : '.';
  return result;
}

TEST(Lettering, EveryLetterAndDigitLooksDifferent) {
  std::set<std::string> shapes;
  const std::string letters = "abcdefghijklmnopqrstuvwxyz0123456789-+.,:/()_%=@";
  for (const char letter : letters) shapes.insert(dots(written(std::string(1, letter))));
  EXPECT_EQ(shapes.size(), letters.size());
  EXPECT_EQ(shapes.count(dots(written("?"))), 0U) << "what has no glyph is told from what has";
}

TEST(Lettering, DrawsATAsABarOnAPost) {
  EXPECT_EQ(dots(written("T")),
            "#####"
            "..#.."
            "..#.."
            "..#.."
            "..#.."
            "..#.."
            "..#..");
  EXPECT_EQ(dots(written("t")), dots(written("T")));
}

TEST(Lettering, FillsTheSizeItStates) {
  const Plane<Rgb8> picture = written("me", 3);
  EXPECT_EQ(picture.width(), 33);
  EXPECT_EQ(picture.height(), 21);
  EXPECT_EQ(picture(0, 0), kInk);
  EXPECT_EQ(picture(32, 20), kInk) << "the e's foot ends in the last pixel";
}

TEST(Lettering, IsClippedAtTheEdges) {
  Plane<Rgb8> picture(6, 6);
  draw_text(picture, {-3, -3}, "888", 2, kInk);
  EXPECT_GT(std::ranges::count(picture.pixels(), kInk), 0);
}

}  // namespace
}  // namespace macula::image
