#include "server/kernels/sphere/fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "server/kernels/sphere/cubic.h"

namespace macula::kernels::sphere {
namespace {

/// Between which samples of the middle level each cell of one axis lies.
struct Between {
  int low = 0, high = 0, nearest = 0;
  float share = 0.0F;  ///< of `high`
  /// The same with one more on each side, by the cubic; at the border the last one stands twice.
  std::array<int, 4> taps{};
  std::array<float, 4> weights{};
};

/// `centre(i)`: where sample i lies.
template <class Centre>
void set_cubic(Between& at, int last, Centre centre) {
  at.taps = {std::max(at.low - 1, 0), at.low, at.high, std::min(at.high + 1, last)};
  const float gap = centre(at.high) - centre(at.low);
  if (!(gap > 0.0F)) {
    at.weights = {0.0F, 1.0F, 0.0F, 0.0F};
    return;
  }
  at.weights = cubic_weights(at.share, gap, centre(at.high) - centre(at.taps[0]),
                             centre(at.taps[3]) - centre(at.low));
}

std::vector<Between> places_on_axis(const std::vector<float>& edges,
                                    const std::vector<float>& mid_edges) {
  const auto middle = [](const std::vector<float>& e, int i) { return 0.5F * (e[i] + e[i + 1]); };
  const int last = static_cast<int>(mid_edges.size()) - 2;
  std::vector<Between> places;
  for (int i = 0; i + 1 < static_cast<int>(edges.size()); ++i) {
    const int own = std::min(i / kMidSide, last);
    const float at = middle(edges, i), centre = middle(mid_edges, own);
    const int low = std::clamp(at < centre ? own - 1 : own, 0, last);
    const int high = std::min(low + 1, last);
    const float gap = middle(mid_edges, high) - middle(mid_edges, low);
    const float share = gap > 0.0F ? (at - middle(mid_edges, low)) / gap : 0.0F;
    Between place{low, high, own, std::clamp(share, 0.0F, 1.0F)};
    set_cubic(place, last, [&](int sample) { return middle(mid_edges, sample); });
    places.push_back(place);
  }
  return places;
}

float depth_from(float inverse) {
  return inverse > 0.0F ? 1.0F / inverse : std::numeric_limits<float>::infinity();
}

class Filler {
 public:
  Filler(const PixelGrid& grid, const PixelGrid& mid_grid, const Plane<std::uint8_t>& important,
         const MidLevel& mid, unsigned wanted, ViewBuffers& planes)
      : columns_(places_on_axis(grid.x_edges, mid_grid.x_edges)),
        rows_(places_on_axis(grid.y_edges, mid_grid.y_edges)),
        important_(important),
        mid_(mid),
        wanted_(wanted),
        planes_(planes) {}

  void fill_row(int y) {
    const std::vector<Rgb> across = blended_rows(rows_[y]);
    for (int x = 0; x < important_.width(); ++x) {
      if (important_(x, y) != 0) continue;
      planes_.radiance(x, y) = color(across, columns_[x], rows_[y]);
      planes_.depth_m(x, y) = depth_from(inverse_depth(columns_[x], rows_[y]));
      if (wanted_ != 0) copy_nearest(x, y, columns_[x].nearest, rows_[y].nearest);
    }
  }

 private:
  /// The four rows of the middle level about a row of cells, blended into one.
  std::vector<Rgb> blended_rows(const Between& y) const {
    std::vector<Rgb> row(static_cast<std::size_t>(mid_.radiance.width()));
    for (int x = 0; x < mid_.radiance.width(); ++x) {
      Rgb sum{0.0F};
      for (std::size_t i = 0; i < y.taps.size(); ++i)
        sum += y.weights[i] * mid_.radiance(x, y.taps[i]);
      row[x] = sum;
    }
    return row;
  }
  /// Sharper than between two samples, and no brighter or darker than the four around the cell.
  Rgb color(const std::vector<Rgb>& across, const Between& x, const Between& y) const {
    Rgb sum{0.0F};
    for (std::size_t i = 0; i < x.taps.size(); ++i) sum += x.weights[i] * across[x.taps[i]];
    const Plane<Rgb>& plane = mid_.radiance;
    return held_within(sum, plane(x.low, y.low), plane(x.high, y.low), plane(x.low, y.high),
                       plane(x.high, y.high));
  }
  template <class T>
  static T between(const Plane<T>& plane, const Between& x, const Between& y) {
    const T above = (1.0F - x.share) * plane(x.low, y.low) + x.share * plane(x.high, y.low);
    const T below = (1.0F - x.share) * plane(x.low, y.high) + x.share * plane(x.high, y.high);
    return (1.0F - y.share) * above + y.share * below;
  }
  /// 1/z is affine over a plane; across a silhouette a depth between the two surfaces would be
  /// nobody's, so the nearest sample speaks.
  float inverse_depth(const Between& x, const Between& y) const {
    constexpr float kOneSurface = 1.1F;  // ratio of depths
    const Plane<float>& q = mid_.inverse_depth;
    const auto [low, high] =
        std::minmax({q(x.low, y.low), q(x.high, y.low), q(x.low, y.high), q(x.high, y.high)});
    return high <= kOneSurface * low ? between(q, x, y) : q(x.nearest, y.nearest);
  }
  void copy_nearest(int x, int y, int mx, int my) {
    if (wanted_ & kSurfaceId) planes_.surface_id(x, y) = mid_.surface_id(mx, my);
    if (wanted_ & kNormal) planes_.normal(x, y) = mid_.normal(mx, my);
    if (wanted_ & kAlbedo) planes_.albedo(x, y) = mid_.albedo(mx, my);
    if (wanted_ & kSteps) planes_.steps(x, y) = mid_.steps(mx, my);
    if (wanted_ & kVariance) {
      planes_.variance(x, y) = std::numeric_limits<float>::infinity();
    }
    if (wanted_ & kSamples) {
      const bool traced = mid_.source(mx, my) == MidSource::Traced;
      planes_.samples(x, y) = traced ? 1.0F / (kMidSide * kMidSide) : 0.0F;
    }
  }

  std::vector<Between> columns_, rows_;
  const Plane<std::uint8_t>& important_;
  const MidLevel& mid_;
  unsigned wanted_;
  ViewBuffers& planes_;
};

void average_one(const ViewBuffers& planes, unsigned wanted, int x, int y, MidLevel& mid) {
  const int x1 = std::min(kMidSide * (x + 1), planes.radiance.width());
  const int y1 = std::min(kMidSide * (y + 1), planes.radiance.height());
  Rgb sum{0.0F};
  float count = 0.0F;
  for (int cy = kMidSide * y; cy < y1; ++cy)
    for (int cx = kMidSide * x; cx < x1; ++cx) sum += planes.radiance(cx, cy), count += 1.0F;
  const int cx = kMidSide * x, cy = kMidSide * y;
  mid.radiance(x, y) = sum / count;
  mid.inverse_depth(x, y) = inverse_of_depth(planes.depth_m(cx, cy));
  mid.age(x, y) = 0;
  if (wanted & kSurfaceId) mid.surface_id(x, y) = planes.surface_id(cx, cy);
  if (wanted & kNormal) mid.normal(x, y) = planes.normal(cx, cy);
  if (wanted & kAlbedo) mid.albedo(x, y) = planes.albedo(cx, cy);
  if (wanted & kSteps) mid.steps(x, y) = planes.steps(cx, cy);
}

bool is_transition(const Plane<std::uint8_t>& important, int x, int y) {
  const std::uint8_t own = important(x, y);
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, important.height() - 1); ++ny)
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, important.width() - 1); ++nx)
      if (important(nx, ny) != own) return true;
  return false;
}

Rgb blurred(const Plane<Rgb>& plane, int x, int y) {
  constexpr float kWeights[] = {0.25F, 0.5F, 0.25F};
  Rgb sum{0.0F};
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      sum += kWeights[dx + 1] * kWeights[dy + 1] *
             plane(std::clamp(x + dx, 0, plane.width() - 1),
                   std::clamp(y + dy, 0, plane.height() - 1));
    }
  }
  return sum;
}

}  // namespace

void average_important(const ViewBuffers& planes, unsigned wanted, TileScheduler& scheduler,
                       MidLevel& mid) {
  scheduler.run(static_cast<std::size_t>(mid.source.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < mid.source.width(); ++x)
      if (mid.source(x, y) == MidSource::Average) average_one(planes, wanted, x, y, mid);
  });
}

void fill_unimportant(const PixelGrid& grid, const PixelGrid& mid_grid,
                      const Plane<std::uint8_t>& important, const MidLevel& mid, unsigned wanted,
                      scheduling::RowBands& bands, ViewBuffers& planes) {
  Filler filler(grid, mid_grid, important, mid, wanted, planes);
  bands.run(bands.around(1), [&](int y) { filler.fill_row(y); });
}

void soften_transitions(const Plane<std::uint8_t>& important, scheduling::RowBands& bands,
                        Plane<Rgb>& radiance) {
  const Plane<Rgb> sharp = radiance;
  bands.run(bands.own(), [&](int y) {
    for (int x = 0; x < radiance.width(); ++x)
      if (is_transition(important, x, y)) radiance(x, y) = blurred(sharp, x, y);
  });
}

}  // namespace macula::kernels::sphere
