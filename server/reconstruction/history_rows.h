// Reading an earlier picture row by row, in vectors: which of a row's places in it show the surface
// that is looked for, and what its cells show between their centres. Pure; safe from any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/reconstruction/row_warp.h"
#include "server/reconstruction/texel.h"
#include "shared/image/plane.h"

namespace macula::reconstruction {

/// What is known of a place in the earlier picture.
enum class Known : std::uint8_t {
  Nothing,   ///< outside, or something else lies there, or nothing is known
  Bilinear,  ///< its cell and maybe others of the four around it
  Bicubic,   ///< all of the sixteen cells around it
};

/// How a row's cells are to be read; each plane has the row's width.
struct RowReads {
  std::vector<Known> known;
  std::vector<std::int32_t> first;   ///< index of the upper left of the four cells around a place
  std::vector<float> across, down;   ///< fractions of the way from its centre to the next ones
  std::vector<float> share[4];       ///< where Bilinear: of the four cells; 0 for unknown ones
  std::vector<std::int32_t> within;  ///< index of the cell that contains a place; outside: any

  void resize(std::size_t width);
  /// Makes entry i as `from` has entry k.
  void copy(std::size_t i, const RowReads& from, std::size_t k);
};

/// How many cells a place is read from: four, or sixteen where all of them are known.
enum class Reading { Bilinear, Bicubic };

struct ReadJob {
  /// Of the earlier picture, at least 2 x 2; 1/m: 0 infinitely far, negative where nothing is
  /// known.
  const image::Plane<float>& inverse_depth;
  float tolerance = 0.02F;  ///< how far depths may differ, relative to the nearer one
  Reading reading = Reading::Bicubic;
};

/// Which of the places are known, and from which cells.
void judge_places(const ReadJob& job, const RowPlaces& places, RowReads& reads);

/// A plane of the earlier picture, of the size of its depths, and the row that is read from it.
struct PictureRow {
  const image::Plane<Texel>& picture;
  std::span<Texel> row;
};

/// The earlier picture at every place that is known; other cells of the rows stay as they are.
/// Bicubic reads (Catmull-Rom) are held within what the four middle cells show.
void read_row(const RowReads& reads, std::span<const PictureRow> rows);

/// shown[i] = color[i]^2 + sampled[i]^2; the latter may be empty.
void show_row(std::span<const Texel> color, std::span<const Texel> sampled, std::span<Rgb> shown);

}  // namespace macula::reconstruction
