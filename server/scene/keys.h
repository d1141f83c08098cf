// Where a time falls among the keys of a track. Internal to this room.
#pragma once

#include <cstddef>
#include <vector>

namespace macula::scene {

/// Between keys `before` and `after`; the same key twice outside the keys' range.
struct KeySpan {
  std::size_t before = 0, after = 0;
  double u = 0.0;         ///< share of the way, in [0, 1)
  double length_s = 0.0;  ///< from key to key
};
/// `times_s` is not empty and strictly increasing.
KeySpan locate(const std::vector<double>& times_s, double seconds);

}  // namespace macula::scene
