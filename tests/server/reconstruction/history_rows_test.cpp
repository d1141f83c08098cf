#include "server/reconstruction/history_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace macula::reconstruction {
namespace {

constexpr int kWidth = 37, kHeight = 9;

/// Everything at 1 m, and colours that are linear in the cell's coordinates.
struct Picture {
  image::Plane<float> inverse_depth{kWidth, kHeight, 1.0F};
  image::Plane<Texel> color{kWidth, kHeight};

  Picture() {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x)
        color(x, y) = Texel(at(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F));
    }
  }
  static Rgb at(float x, float y) { return {x, 2.0F * y, x - y}; }
};

/// A row of places half a cell apart, a quarter of one below the centres of row 4.
RowPlaces some_places(std::size_t count) {
  RowPlaces places;
  places.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    places.x[i] = 0.3F + 0.5F * static_cast<float>(i);
    places.y[i] = 4.75F;
    places.inverse_depth[i] = 1.0F;
  }
  return places;
}

std::vector<Texel> read(const Picture& picture, const RowPlaces& places, Reading reading,
                        RowReads& reads) {
  judge_places({picture.inverse_depth, 0.02F, reading}, places, reads);
  std::vector<Texel> row(places.x.size(), Texel(Rgb{-1.0F}));
  const PictureRow picture_row{picture.color, row};
  read_row(reads, {&picture_row, 1});
  return row;
}

TEST(HistoryRows, WhatIsLinearIsReadExactlyBetweenCentres) {
  const Picture picture;
  const RowPlaces places = some_places(70);
  for (const Reading reading : {Reading::Bilinear, Reading::Bicubic}) {
    RowReads reads;
    const std::vector<Texel> row = read(picture, places, reading, reads);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const float x = std::clamp(places.x[i], 0.5F, kWidth - 0.5F);
      const Rgb expected = Picture::at(x, 4.75F);
      ASSERT_NE(reads.known[i], Known::Nothing);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(row[i].rgb()[c], expected[c], 1e-4F) << i;
    }
    const auto bicubic = std::ranges::count(reads.known, Known::Bicubic);
    EXPECT_EQ(bicubic > 50, reading == Reading::Bicubic);
  }
}

TEST(HistoryRows, OtherDepthsAndPlacesOutsideAreNotRead) {
  Picture picture;
  RowPlaces places = some_places(8);
  places.inverse_depth[0] = 1.05F;  // 2 % are allowed
  places.inverse_depth[1] = 1.015F;
  places.x[2] = -0.1F, places.x[3] = kWidth + 0.1F, places.y[4] = -3.0F;
  places.inverse_depth[5] = -1.0F;
  places.x[6] = NAN;
  RowReads reads;
  const std::vector<Texel> row = read(picture, places, Reading::Bilinear, reads);
  for (const int i : {0, 2, 3, 4, 5, 6}) {
    EXPECT_EQ(reads.known[i], Known::Nothing) << i;
    EXPECT_EQ(row[i].r, -1.0F) << i;
  }
  for (const int i : {1, 7}) EXPECT_EQ(reads.known[i], Known::Bilinear) << i;
}

TEST(HistoryRows, UnknownCellsHaveNoShare) {
  Picture picture;
  picture.inverse_depth(9, 4) = -1.0F;
  picture.color(9, 4) = Texel(Rgb{1e6F});
  RowPlaces places = some_places(40);
  RowReads reads;
  const std::vector<Texel> row = read(picture, places, Reading::Bicubic, reads);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (reads.known[i] == Known::Nothing) continue;
    EXPECT_LT(row[i].r, kWidth) << i;
    if (reads.known[i] == Known::Bicubic) continue;
    const float sum = reads.share[0][i] + reads.share[1][i] + reads.share[2][i] + reads.share[3][i];
    EXPECT_NEAR(sum, 1.0F, 1e-5F);
  }
  const auto inside = static_cast<std::size_t>((9.3F - 0.3F) / 0.5F);
  EXPECT_EQ(reads.known[inside], Known::Nothing);
}

TEST(HistoryRows, BicubicReadsAreExactAtCentresAndNeverOvershoot) {
  Picture picture;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) picture.color(x, y) = Texel(Rgb{x % 5 < 2 ? 1.0F : 0.0F});
  }
  RowPlaces places = some_places(60);
  for (std::size_t i = 0; i < 30; ++i) {
    places.x[i] = static_cast<float>(i) + 2.5F, places.y[i] = 4.5F;
  }
  RowReads reads;
  const std::vector<Texel> row = read(picture, places, Reading::Bicubic, reads);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(reads.known[i], Known::Bicubic);
    EXPECT_EQ(row[i].r, picture.color(static_cast<int>(i) + 2, 4).r);
  }
  for (const Texel& texel : row) EXPECT_TRUE(texel.r >= 0.0F && texel.r <= 1.0F);
}

TEST(HistoryRows, WhatIsShownIsTheSumOfSquares) {
  for (const std::size_t width : {1U, 5U, 64U}) {
    const std::vector<Texel> color(width, Texel(Rgb{1.0F, 2.0F, 3.0F}));
    const std::vector<Texel> sampled(width, Texel(Rgb{2.0F}));
    std::vector<Rgb> shown(width + 1, Rgb{-1.0F});
    show_row(color, sampled, {shown.data(), width});
    EXPECT_EQ(shown[width - 1], Rgb(5.0F, 8.0F, 13.0F));
    EXPECT_EQ(shown[width], Rgb(-1.0F)) << "nothing may be written past the row";
    show_row(color, {}, {shown.data(), width});
    EXPECT_EQ(shown[0], Rgb(1.0F, 4.0F, 9.0F));
  }
}

}  // namespace
}  // namespace macula::reconstruction
