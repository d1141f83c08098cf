#include "client/reprojection/holes.h"

#include <gtest/gtest.h>

#include <string>

namespace macula::reprojection {
namespace {

/// '.' undrawn, 'N' near (1/m = 2), 'F' far (1/m = 0.5), 'S' sky (0); with colours to match.
struct Drawn {
  Fragments fragments;
  image::Plane<Rgb8> colors;
  image::Plane<Coverage> coverage;
};
Drawn drawn_of(const std::vector<std::string>& rows) {
  const int width = static_cast<int>(rows[0].size()), height = static_cast<int>(rows.size());
  Drawn made{Fragments(width, height), image::Plane<Rgb8>(width, height), {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const char c = rows[y][x];
      made.colors(x, y).r = static_cast<std::uint8_t>(c);
      if (c != '.') made.fragments.set(x, y, {c == 'N' ? 2.0F : c == 'F' ? 0.5F : 0.0F, 0, 0});
    }
  }
  return made;
}
void fill(Drawn& drawn) {
  Holes holes;
  for (int y = 0; y < drawn.colors.height(); ++y) holes.note_row(drawn.fragments, y);
  holes.classify_and_fill(drawn.fragments, WarpOptions::Holes::FillFartherSide, 1, drawn.colors,
                          &drawn.coverage);
}
/// The picture afterwards; lower case where filled.
std::vector<std::string> filled(Drawn drawn) {
  fill(drawn);
  std::vector<std::string> rows;
  for (int y = 0; y < drawn.colors.height(); ++y) {
    rows.emplace_back();
    for (int x = 0; x < drawn.colors.width(); ++x) {
      const char name = static_cast<char>(drawn.colors(x, y).r);
      const Coverage coverage = drawn.coverage(x, y);
      EXPECT_EQ(coverage == Coverage::Outside, name == '.');
      rows.back() += coverage == Coverage::Filled ? static_cast<char>(name + 'a' - 'A') : name;
    }
  }
  return rows;
}
using Rows = std::vector<std::string>;

TEST(Holes, AreFilledFromTheFartherSide) {
  EXPECT_EQ(filled(drawn_of({"NN..FF"})), Rows({"NNffFF"}));
  EXPECT_EQ(filled(drawn_of({"FF..NN"})), Rows({"FFffNN"}));
  EXPECT_EQ(filled(drawn_of({"N", ".", "F"})), Rows({"N", "f", "F"}));
  EXPECT_EQ(filled(drawn_of({"N", "F", ".", "N"})), Rows({"N", "F", "f", "N"}));
  EXPECT_EQ(filled(drawn_of({"NN.SS", "NN.FF"})), Rows({"NNsSS", "NNfFF"}));
}

TEST(Holes, OneSideAloneIsBeyondTheFramesEdge) {
  EXPECT_EQ(filled(drawn_of({"..FF", "..FF"})), Rows({"..FF", "..FF"}));
  EXPECT_EQ(filled(drawn_of({"....", "...."})), Rows({"....", "...."}));
  EXPECT_EQ(filled(drawn_of({".NN.", "...."})), Rows({".NN.", "...."}));
}

TEST(Holes, AreFilledAcrossTheirWidthNotAlongTheirLength) {
  // A post (N) moved right and uncovered a ball (F) before the sky, two pixels wide, four long.
  EXPECT_EQ(filled(drawn_of({"SSSS", "F..N", "F..N", "F..N", "F..N", "SSSS"})),
            Rows({"SSSS", "FffN", "FffN", "FffN", "FffN", "SSSS"}));
  EXPECT_EQ(filled(drawn_of({"SFFFFS", "S....S", "SNNNNS"})), Rows({"SFFFFS", "SffffS", "SNNNNS"}));
}

TEST(Holes, TheColourComesFromBehindTheMixedBorderOfTheSameSurface) {
  Drawn row = drawn_of({"NN.FFF"});
  row.colors(3, 0).g = 7;  // the border cell, mixed with what stood before it
  row.colors(4, 0).g = 8;
  Drawn same = row;
  fill(same);
  EXPECT_EQ(same.colors(2, 0).g, 8);
  Drawn other = row;
  other.fragments.set(4, 0, {0.1F, 0, 0});  // another surface begins right behind
  fill(other);
  EXPECT_EQ(other.colors(2, 0).g, 7);
}

TEST(Holes, FillsDoNotFeedOnFills) {
  // The hole in the third row would take the sky, had the one above it been filled first.
  EXPECT_EQ(filled(drawn_of({"SSS", "S.N", "N.N", "NNN"})), Rows({"SSS", "SsN", "NnN", "NNN"}));
}

}  // namespace
}  // namespace macula::reprojection
