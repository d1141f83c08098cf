#include "server/kernels/sphere/keep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "server/kernels/sphere/cubic.h"
#include "server/reconstruction/backward_warp.h"

namespace macula::kernels::sphere {
namespace {

using reconstruction::BackwardWarp;

/// Surfaces match when their depths do within this share.
constexpr float kDepthTolerance = 0.02F;

bool same_depth(float inverse_a, float inverse_b) {
  if (!(inverse_a > 0.0F) || !(inverse_b > 0.0F)) return inverse_a == inverse_b;
  return std::abs(inverse_a - inverse_b) <= kDepthTolerance * inverse_a;
}

/// The two neighbours of a continuous coordinate among `count` samples at whole numbers + 0.5.
struct Span {
  int low, high;
  float share;  ///< of `high`

  Span(float at, int count) : low(), high(), share() {
    const float shifted = std::clamp(at - 0.5F, 0.0F, static_cast<float>(count - 1));
    low = static_cast<int>(shifted);
    high = std::min(low + 1, count - 1);
    share = shifted - static_cast<float>(low);
  }
};

template <class T>
T bilinear(const Plane<T>& plane, const Span& x, const Span& y) {
  const T above = (1.0F - x.share) * plane(x.low, y.low) + x.share * plane(x.high, y.low);
  const T below = (1.0F - x.share) * plane(x.low, y.high) + x.share * plane(x.high, y.high);
  return (1.0F - y.share) * above + y.share * below;
}

/// Between samples by the cubic, and no more than the four around: what is kept for some frames is
/// looked up as often, and lines between would blur it each time.
Rgb sharp(const Plane<Rgb>& plane, const Span& x, const Span& y) {
  const auto wx = cubic_weights(x.share, 1.0F, 2.0F, 2.0F);
  const auto wy = cubic_weights(y.share, 1.0F, 2.0F, 2.0F);
  Rgb sum{0.0F};
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y.low + j - 1, 0, plane.height() - 1);
    for (int i = 0; i < 4; ++i)
      sum += wx[i] * wy[j] * plane(std::clamp(x.low + i - 1, 0, plane.width() - 1), row);
  }
  return held_within(sum, plane(x.low, y.low), plane(x.high, y.low), plane(x.low, y.high),
                     plane(x.high, y.high));
}

class Keeper {
 public:
  Keeper(const KeepInput& input, const ViewHistory& last, MidLevel& mid)
      : input_(input),
        last_(last),
        warp_(input.view.world_from_view, last.world_from_view, last.mid_grid),
        mid_(mid) {}

  void keep_row(int y) {
    for (int x = 0; x < mid_.source.width(); ++x) {
      if (mid_.source(x, y) != MidSource::Traced) continue;
      if (is_due(x, y, input_.frame, input_.config.refresh)) continue;
      if (input_.config.kept == Kept::InPlace) {
        copy(x, y, x, y, last_.mid.radiance(x, y), last_.mid.inverse_depth(x, y));
      } else {
        reproject(x, y);
      }
    }
  }

 private:
  /// An edge-free neighbourhood shows one surface: its inverse depth is close to affine.
  void reproject(int x, int y) {
    const int low_x = x * kMidSide / kLowSide, low_y = y * kMidSide / kLowSide;
    if (input_.edges(low_x, low_y) > 0.0F) return;
    constexpr float kStep = static_cast<float>(kMidSide) / static_cast<float>(kLowSide);
    const Plane<float>& low = input_.low.inverse_depth;
    const float here = bilinear(low, Span((static_cast<float>(x) + 0.5F) * kStep, low.width()),
                                Span((static_cast<float>(y) + 0.5F) * kStep, low.height()));
    const float depth = here > 0.0F ? 1.0F / here : std::numeric_limits<float>::infinity();
    const auto place = warp_.then(input_.mid_grid.tangent(x, y), depth);
    if (!place) return;
    const float then = here > 0.0F ? 1.0F / place->depth_m : 0.0F;
    const MidLevel& last = last_.mid;
    const Span sx(place->cell.x, last.radiance.width()), sy(place->cell.y, last.radiance.height());
    if (!matches(sx, sy, then)) return;
    const int nearest_x = sx.share < 0.5F ? sx.low : sx.high;
    const int nearest_y = sy.share < 0.5F ? sy.low : sy.high;
    if (last.age(nearest_x, nearest_y) + 1 >= 2 * period(input_.config.refresh)) return;
    copy(x, y, nearest_x, nearest_y, sharp(last.radiance, sx, sy), here);
  }
  bool matches(const Span& x, const Span& y, float inverse_depth) const {
    const Plane<float>& last = last_.mid.inverse_depth;
    return same_depth(inverse_depth, last(x.low, y.low)) &&
           same_depth(inverse_depth, last(x.high, y.low)) &&
           same_depth(inverse_depth, last(x.low, y.high)) &&
           same_depth(inverse_depth, last(x.high, y.high));
  }
  void copy(int x, int y, int from_x, int from_y, const Rgb& radiance, float inverse_depth) {
    const MidLevel& last = last_.mid;
    mid_.source(x, y) = MidSource::Kept;
    mid_.radiance(x, y) = radiance;
    mid_.inverse_depth(x, y) = inverse_depth;
    mid_.age(x, y) = static_cast<std::uint8_t>(last.age(from_x, from_y) + 1);
    mid_.surface_id(x, y) = last.surface_id(from_x, from_y);
    mid_.normal(x, y) = last.normal(from_x, from_y);
    mid_.albedo(x, y) = last.albedo(from_x, from_y);
    mid_.steps(x, y) = 0.0F;
  }

  const KeepInput& input_;
  const ViewHistory& last_;
  BackwardWarp warp_;
  MidLevel& mid_;
};

}  // namespace

int period(Refresh refresh) {
  switch (refresh) {
    case Refresh::EveryFrame:
      return 1;
    case Refresh::EverySecond:
      return 2;
    case Refresh::EveryFourth:
      return 4;
  }
  return 1;
}

bool is_due(int x, int y, std::uint64_t frame, Refresh refresh) {
  switch (refresh) {
    case Refresh::EveryFrame:
      return true;
    case Refresh::EverySecond:
      return ((x + y) & 1) == static_cast<int>(frame & 1U);
    case Refresh::EveryFourth: {
      // Corners of a square in the order of a figure eight: consecutive frames lie diagonally.
      const int turn = (y & 1) ^ ((x & 1) != 0 ? 3 : 0);  // (0,0) 0, (0,1) 1, (1,0) 3, (1,1) 2
      constexpr int kFrame[] = {0, 2, 1, 3};
      return kFrame[turn] == static_cast<int>(frame & 3U);
    }
  }
  return true;
}

void keep(const KeepInput& input, const ViewHistory& last, TileScheduler& scheduler,
          MidLevel& mid) {
  if (input.config.refresh == Refresh::EveryFrame || last.frame + 1 != input.frame) return;
  const Plane<Rgb>& then = last.mid.radiance;
  if (then.width() != mid.radiance.width() || then.height() != mid.radiance.height()) return;
  Keeper keeper(input, last, mid);
  scheduler.run(static_cast<std::size_t>(mid.source.height()),
                [&](std::size_t row) { keeper.keep_row(static_cast<int>(row)); });
}

}  // namespace macula::kernels::sphere
