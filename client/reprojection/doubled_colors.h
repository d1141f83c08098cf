// DoubledColors: colours of fragments, one for every four pixels, brought to all of them. Where
// cells are wider than two pixels the picture has no more detail than its fragments, so colours
// between those that hang together are interpolated; at silhouettes each pixel takes its nearest
// fragment's. A third of what DoubledRows costs, which finds each pixel's own place in the source.
// Internal to this room; one thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/reprojection/fragments.h"
#include "client/reprojection/resolve.h"

namespace macula::reprojection {

class DoubledColors {
 public:
  /// A picture begins, of rows of `width` fragments.
  void begin(int width);
  /// Of row `y` of the picture twice as wide and high, whole in `out`: the pixels made of fragments
  /// [first, end). The fragments' band holds the rows above and below its half, as far as there are
  /// any; rows come in order. Pixels right of those may be written to as well.
  void draw(const Fragments& fragments, const Resolver& resolver, int y, int first, int end,
            std::span<Rgb8> out);

 private:
  /// Colours of a row of fragments, four bytes each.
  const std::uint32_t* words(const Fragments& fragments, const Resolver& resolver, int row);
  void join(const Fragments& fragments, int row);

  static constexpr int kNone = -1;
  static constexpr std::size_t kKept = 3;  ///< rows: one and those above and below it
  int width_ = 0;
  std::array<std::vector<std::uint32_t>, kKept> words_;
  std::array<int, kKept> rows_{};
  /// All bits set where a fragment hangs together with the one to its right.
  std::vector<std::uint32_t> joined_;
  int joined_row_ = kNone;
  /// Between two rows: red and blue, green, as 16 bits each and four times their size.
  std::vector<std::uint32_t> red_blue_, green_;
};

}  // namespace macula::reprojection
