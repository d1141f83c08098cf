#include "client/reprojection/holes.h"

#include <gtest/gtest.h>

#include <string>

namespace macula::reprojection {
namespace {

/// '.' undrawn, 'N' near (1/m = 2, u = 1), 'F' far (1/m = 0.5, u = 2), 'S' sky (0, u = 3).
Fragments fragments_of(const std::vector<std::string>& rows) {
  Fragments made(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < made.height(); ++y) {
    for (int x = 0; x < made.width(); ++x) {
      const char c = rows[y][x];
      if (c == 'N') made(x, y) = {2.0F, 1.0F, 0.0F};
      if (c == 'F') made(x, y) = {0.5F, 2.0F, 0.0F};
      if (c == 'S') made(x, y) = {0.0F, 3.0F, 0.0F};
    }
  }
  return made;
}
/// The picture afterwards; lower case where filled.
std::vector<std::string> filled(Fragments fragments) {
  image::Plane<Coverage> coverage;
  classify_and_fill(fragments, WarpOptions::Holes::FillFartherSide, coverage);
  std::vector<std::string> rows;
  for (int y = 0; y < fragments.height(); ++y) {
    rows.emplace_back();
    for (int x = 0; x < fragments.width(); ++x) {
      const char name = ".NFS"[static_cast<int>(fragments(x, y).u)];
      EXPECT_EQ(coverage(x, y) == Coverage::Outside, name == '.');
      rows.back() +=
          coverage(x, y) == Coverage::Filled ? static_cast<char>(name + 'a' - 'A') : name;
    }
  }
  return rows;
}
using Rows = std::vector<std::string>;

TEST(Holes, AreFilledFromTheFartherSide) {
  EXPECT_EQ(filled(fragments_of({"NN..FF"})), Rows({"NNffFF"}));
  EXPECT_EQ(filled(fragments_of({"FF..NN"})), Rows({"FFffNN"}));
  EXPECT_EQ(filled(fragments_of({"N", ".", "F"})), Rows({"N", "f", "F"}));
  EXPECT_EQ(filled(fragments_of({"N", "F", ".", "N"})), Rows({"N", "F", "f", "N"}));
  EXPECT_EQ(filled(fragments_of({"NN.SS", "NN.FF"})), Rows({"NNsSS", "NNfFF"}));
}

TEST(Holes, OneSideAloneIsBeyondTheFramesEdge) {
  EXPECT_EQ(filled(fragments_of({"..FF", "..FF"})), Rows({"..FF", "..FF"}));
  EXPECT_EQ(filled(fragments_of({"....", "...."})), Rows({"....", "...."}));
  EXPECT_EQ(filled(fragments_of({".NN.", "...."})), Rows({".NN.", "...."}));
}

TEST(Holes, AreFilledAcrossTheirWidthNotAlongTheirLength) {
  // A post (N) moved right and uncovered a ball (F) before the sky, two pixels wide, four long.
  EXPECT_EQ(filled(fragments_of({"SSSS", "F..N", "F..N", "F..N", "F..N", "SSSS"})),
            Rows({"SSSS", "FffN", "FffN", "FffN", "FffN", "SSSS"}));
  EXPECT_EQ(filled(fragments_of({"SFFFFS", "S....S", "SNNNNS"})),
            Rows({"SFFFFS", "SffffS", "SNNNNS"}));
}

TEST(Holes, TheColourComesFromBehindTheMixedBorderOfTheSameSurface) {
  Fragments row = fragments_of({"NN.FFF"});
  row(3, 0).u = 7.0F;  // the border cell, whose colour is mixed with what stood before it
  row(4, 0).u = 8.0F;
  image::Plane<Coverage> coverage;
  Fragments same = row;
  classify_and_fill(same, WarpOptions::Holes::FillFartherSide, coverage);
  EXPECT_EQ(same(2, 0).u, 8.0F);
  Fragments other = row;
  other(4, 0).inverse_depth = 0.1F;  // another surface begins right behind
  classify_and_fill(other, WarpOptions::Holes::FillFartherSide, coverage);
  EXPECT_EQ(other(2, 0).u, 7.0F);
}

TEST(Holes, FillsDoNotFeedOnFills) {
  // The hole in the third row would take the sky, had the one above it been filled first.
  EXPECT_EQ(filled(fragments_of({"SSS", "S.N", "N.N", "NNN"})), Rows({"SSS", "SsN", "NnN", "NNN"}));
}

}  // namespace
}  // namespace macula::reprojection
