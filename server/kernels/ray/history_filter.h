// How the earlier picture is read between its cells: shares of nearby cells that something is
// remembered of. Source of the printed form: section 3.2.
#pragma once

#include <array>
#include <cstdint>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"

namespace macula::kernels::ray {

/// Cells and their shares of one value; shares sum to 1.
struct Taps {
  struct Tap {
    int x = 0, y = 0;
    float weight = 0.0F;
  };
  std::array<Tap, 16> tap;
  int count = 0;

  void add(int x, int y, float weight) { tap[count++] = {x, y, weight}; }
};

class HistoryTaps {
 public:
  /// Refers to both; they must outlive it.
  HistoryTaps(const Cache& then, const View& view, HistoryFilter filter, std::uint64_t frame)
      : then_(then), view_(view), filter_(filter), frame_(frame) {}

  /// For cell (x, y) now, which lay at `place` (cell i's centre is i + 0.5); the cell that contains
  /// it must be remembered.
  Taps at(int x, int y, const Vec2& place) const;

 private:
  void add_known(int x, int y, float weight, Taps& taps) const;
  Taps bilinear(const Vec2& place) const;
  Taps bicubic(const Vec2& place) const;
  Taps normal(int x, int y, const Vec2& place) const;

  const Cache& then_;
  const View& view_;
  HistoryFilter filter_;
  std::uint64_t frame_;
};

/// The sum of weight * plane. Where weights go negative it is held within what the four middle taps
/// show, so that sharpening cannot ring.
Texel filtered(const Taps& taps, const Plane<Texel>& plane);

}  // namespace macula::kernels::ray
