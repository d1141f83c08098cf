#include "server/kernels/culling/texel_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/check.h"
#include "shared/math/frames.h"

namespace macula::kernels::culling {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

/// Cell coordinates of the gaze; that of the nearest place in the grid where it looks beyond.
Vec2 gaze_in_cells(const PixelGrid& grid, const Gaze& gaze) {
  Vec2 tangent{0.0F};
  if (gaze.direction.z < 0.0F) tangent = math::tangent_from_direction(gaze.direction);
  const auto nearest = [](const std::vector<float>& edges, float at) {
    return std::clamp(at, edges.front(), std::nextafter(edges.back(), edges.front()));
  };
  const auto place =
      grid.locate({nearest(grid.x_edges, tangent.x), nearest(grid.y_edges, tangent.y)});
  const Vec2 size{static_cast<float>(grid.width()), static_cast<float>(grid.height())};
  return place ? Vec2(*place) : 0.5F * size;
}

}  // namespace

TexelMap TexelMap::thinned(const PixelGrid& grid, int n) {
  MACULA_CHECK(n >= 1);
  TexelMap map;
  map.step_ = static_cast<float>(n);
  map.cell_ = Plane<Pixel>((grid.width() + n - 1) / n, (grid.height() + n - 1) / n);
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      map.cell_(u, v) = {std::min(u * n + n / 2, grid.width() - 1),
                         std::min(v * n + n / 2, grid.height() - 1)};
    }
  }
  return map;
}

TexelMap TexelMap::log_polar(const PixelGrid& grid, const Gaze& gaze, double shrink, double power) {
  MACULA_CHECK(shrink >= 1.0 && power > 0.0);
  TexelMap map;
  map.log_polar_ = true;
  map.power_ = static_cast<float>(power);
  map.gaze_ = gaze_in_cells(grid, gaze);
  const float right = static_cast<float>(grid.width()), bottom = static_cast<float>(grid.height());
  const float wide = std::max(map.gaze_.x, right - map.gaze_.x);
  const float high = std::max(map.gaze_.y, bottom - map.gaze_.y);
  map.log_largest_ = std::log(std::max(std::hypot(wide, high), 2.0F));
  const auto shrunk = [&](int cells) {
    return std::max(static_cast<int>(std::lround(cells / shrink)), 1);
  };
  map.cell_ = Plane<Pixel>(shrunk(grid.width()), shrunk(grid.height()));
  for (int v = 0; v < map.height(); ++v) {
    const float angle = kTurn * (static_cast<float>(v) + 0.5F) / static_cast<float>(map.height());
    for (int u = 0; u < map.width(); ++u) {
      const float x = (static_cast<float>(u) + 0.5F) / static_cast<float>(map.width());
      const float r = std::exp(map.log_largest_ * std::pow(x, map.power_));
      const Vec2 at = map.gaze_ + r * Vec2{std::cos(angle), std::sin(angle)};
      map.cell_(u, v) = {std::clamp(static_cast<int>(std::floor(at.x)), 0, grid.width() - 1),
                         std::clamp(static_cast<int>(std::floor(at.y)), 0, grid.height() - 1)};
    }
  }
  return map;
}

Vec2 TexelMap::place(int x, int y) const {
  const Vec2 middle{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
  if (!log_polar_) {
    const float asked = std::floor(0.5F * step_) + 0.5F;  // of each texel's cells
    return (middle - asked) / step_ + 0.5F;
  }
  const Vec2 off = middle - gaze_;
  const float r = std::max(std::hypot(off.x, off.y), 1.0F);
  float angle = std::atan2(off.y, off.x);
  if (angle < 0.0F) angle += kTurn;
  return {static_cast<float>(width()) * std::pow(std::log(r) / log_largest_, 1.0F / power_),
          static_cast<float>(height()) * angle / kTurn};
}

}  // namespace macula::kernels::culling
