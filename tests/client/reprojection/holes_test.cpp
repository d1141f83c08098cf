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

TEST(Holes, FillsDoNotFeedOnFills) {
  // The middle column takes the sky above its hole; the left hole has no sky in its row or column.
  EXPECT_EQ(filled(fragments_of({"NSN", "N.N", "FNF", "F.N"})), Rows({"NSN", "NsN", "FNF", "FfN"}));
  EXPECT_EQ(filled(fragments_of({"NNS", "N.N", "N.F", "NNN"})), Rows({"NNS", "NnN", "NfF", "NNN"}));
}

}  // namespace
}  // namespace macula::reprojection
