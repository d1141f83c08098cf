// Scenes with a closed form, drawn exactly at any pose: what a warp should have shown.
#pragma once

#include <cmath>
#include <functional>
#include <limits>

#include "client/reprojection/warp.h"
#include "shared/math/frames.h"

namespace macula::reprojection::test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a ray meets: ray parameter (infinity: nothing, the sky's colour) and colour in [0, 1].
struct Sight {
  double t = kInfinity;
  DVec3 color{0.0};
};
using AnalyticScene = std::function<Sight(const DVec3& origin, const DVec3& direction)>;

/// Slow waves along two coordinates: no detail above `cycles_per_unit`.
inline DVec3 waves(double a, double b, double cycles_per_unit) {
  const double k = 2.0 * 3.141592653589793 * cycles_per_unit;
  return {0.5 + 0.3 * std::sin(k * a), 0.5 + 0.3 * std::cos(k * b),
          0.5 + 0.3 * std::sin(k * (a + b))};
}

/// The plane dot(normal, p) = offset, coloured by x and y of the hit.
inline AnalyticScene textured_plane(DVec3 normal, double offset, double cycles_per_m) {
  return [=](const DVec3& origin, const DVec3& direction) -> Sight {
    const double t = (offset - glm::dot(normal, origin)) / glm::dot(normal, direction);
    if (!(t > 0.0)) return {};
    const DVec3 p = origin + t * direction;
    return {t, waves(p.x, p.y, cycles_per_m)};
  };
}

/// A green board x < 0 at z = -near before a red wall at z = -far.
inline AnalyticScene board_before_wall(double near, double far) {
  return [=](const DVec3& origin, const DVec3& direction) -> Sight {
    const double t_near = (-near - origin.z) / direction.z;
    if (t_near > 0.0 && origin.x + t_near * direction.x < 0.0) return {t_near, {0.0, 1.0, 0.0}};
    const double t_far = (-far - origin.z) / direction.z;
    if (t_far > 0.0) return {t_far, {1.0, 0.0, 0.0}};
    return {};
  };
}

inline foveation::Display square_display(int side_px, Degrees fov = Degrees{60.0}) {
  return {math::symmetric_fov(fov, 1.0), side_px, side_px};
}

/// A frame of one eye; owns what SourceView refers to.
struct Frame {
  Pose stage_from_view;
  PixelGrid grid;
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth;
  SourceView view() const { return {stage_from_view, grid, color, inverse_depth}; }
};

inline Rgb8 encoded(const DVec3& c) {
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(255.0 * v)); };
  return {byte(c.x), byte(c.y), byte(c.z)};
}

/// Draws `scene` on `grid` from `pose`: the mean of n x n rays a cell, depth of the centre.
inline Frame draw(const AnalyticScene& scene, const PixelGrid& grid, const Pose& pose, int n = 1) {
  Frame frame{pose, grid, image::Plane<Rgb8>(grid.width(), grid.height()),
              image::Plane<float>(grid.width(), grid.height())};
  const auto look = [&](int x, int y, double fx, double fy) {
    const DVec2 at(grid.tangent(x, y, static_cast<float>(fx), static_cast<float>(fy)));
    return scene(pose.position, pose.rotation * math::direction_from_tangent(at));
  };
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      DVec3 sum{0.0};
      for (int i = 0; i < n * n; ++i) sum += look(x, y, (i % n + 0.5) / n, (i / n + 0.5) / n).color;
      frame.color(x, y) = encoded(sum / static_cast<double>(n * n));
      frame.inverse_depth(x, y) = static_cast<float>(1.0 / look(x, y, 0.5, 0.5).t);
    }
  }
  return frame;
}

/// PSNR in dB over the pixels that `counts(x, y)` admits; infinite when equal.
template <class Counts>
double psnr_db(const image::Plane<Rgb8>& a, const image::Plane<Rgb8>& b, Counts&& counts) {
  double squares = 0.0, values = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!counts(x, y)) continue;
      const Rgb8 p = a(x, y), q = b(x, y);
      squares += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
      values += 3.0;
    }
  }
  return squares == 0.0 ? kInfinity : 10.0 * std::log10(255.0 * 255.0 * values / squares);
}

inline DQuat turn(const DVec3& axis, Degrees angle) {
  return glm::angleAxis(Radians(angle).value(), glm::normalize(axis));
}

/// A uniform grid like the display's pixels, `margin` cells wider on every side.
inline PixelGrid grid_with_margin(const foveation::Display& display, int margin) {
  const auto edges = [&](double low, double step, int count) {
    std::vector<float> made;
    for (int i = -margin; i <= count + margin; ++i)
      made.push_back(static_cast<float>(low + i * step));
    return made;
  };
  const DVec2 low = display.fov.tangent_min(), step = display.pixel_tangent();
  return {edges(low.x, step.x, display.width_px), edges(low.y, step.y, display.height_px)};
}

}  // namespace macula::reprojection::test
