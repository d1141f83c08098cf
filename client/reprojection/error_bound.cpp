#include "client/reprojection/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/reprojection/mesh.h"

namespace macula::reprojection {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kBlock = 8;  // cells a side, as the frame states residuals
/// Cells to every side among whose centres something shows that is thinner than a cell: a wire
/// misses most centres along it, hardly ever seven in a row.
constexpr int kAround = 3;
constexpr int kEvery = 4;  // cells, of a summary
/// A block's columns and rows may lie so far, in cells, from where they are drawn (raster_simd).
constexpr double kUneven_cells = 0.01;

}  // namespace

ErrorBound::ErrorBound(const SourceView& source, const DepthResidual& residual,
                       const Pose& stage_from_display, const foveation::Display& display,
                       const WarpOptions& options, const PoseDoubt& doubt)
    : source_(source),
      residual_(residual),
      display_(display),
      pixels_per_tangent_(1.0 / display.pixel_tangent()),
      tangent_min_(display.fov.tangent_min()),
      drawn_px_(static_cast<double>(options.detail_px)),
      doubt_(doubt) {
  const RelativeView relative =
      relative_view(source.stage_from_view, stage_from_display, options.method);
  rotation_ = relative.rotation;
  offset_m_ = relative.offset_m;
  const int columns = (source.grid.width() + kBlock - 1) / kBlock;
  const int rows = (source.grid.height() + kBlock - 1) / kBlock;
  MACULA_CHECK(residual.blocks.empty() ||
               residual.blocks.size() == static_cast<std::size_t>(columns * rows));
}

DVec2 ErrorBound::place(int x, int y, double fx, double fy, double inverse_depth) const {
  const DVec2 tangent(source_.grid.tangent(x, y, static_cast<float>(fx), static_cast<float>(fy)));
  const DVec3 point = rotation_ * math::direction_from_tangent(tangent) + inverse_depth * offset_m_;
  if (!(point.z < 0.0)) return DVec2{std::numeric_limits<double>::quiet_NaN()};
  return (DVec2{point.x, -point.y} / -point.z - tangent_min_) * pixels_per_tangent_;
}

/// Inverse depth, 1/m: what the frame states, and the largest step to the cells around.
double ErrorBound::depth_doubt(int x, int y) const {
  const auto& plane = source_.inverse_depth_per_m;
  const float here = sound_inverse_depth(plane(x, y));
  float step = 0.0F;
  for (int j = std::max(y - kAround, 0); j <= std::min(y + kAround, plane.height() - 1); ++j) {
    for (int i = std::max(x - kAround, 0); i <= std::min(x + kAround, plane.width() - 1); ++i) {
      step = std::max(step, std::abs(sound_inverse_depth(plane(i, j)) - here));
    }
  }
  if (residual_.blocks.empty()) return static_cast<double>(step);
  const int columns = (plane.width() + kBlock - 1) / kBlock;
  const std::uint8_t stated =
      residual_.blocks[static_cast<std::size_t>(y / kBlock * columns + x / kBlock)];
  if (stated == 255) return kInfinity;
  return static_cast<double>(step) +
         static_cast<double>(stated) * static_cast<double>(residual_.step_per_m);
}

/// How far `point`, in display space per meter of source depth, moves on the display when its
/// inverse depth changes by up to `doubt`: the difference of (X + d o) / (f - d o_z) and X / f.
double ErrorBound::parallax_px(const DVec3& point, double doubt) const {
  const double forward = -point.z, nearest = forward - doubt * std::abs(offset_m_.z);
  if (!(nearest > 0.0) || std::isinf(doubt)) return doubt == 0.0 ? 0.0 : kInfinity;
  const DVec2 moved{offset_m_.x * forward + offset_m_.z * point.x,
                    offset_m_.y * forward + offset_m_.z * point.y};
  return doubt * glm::length(moved * pixels_per_tangent_) / (forward * nearest);
}

double ErrorBound::at(int x, int y) const {
  const auto inverse = static_cast<double>(sound_inverse_depth(source_.inverse_depth_per_m(x, y)));
  const DVec3 point = rotation_ * math::direction_from_tangent(DVec2(source_.grid.tangent(x, y))) +
                      inverse * offset_m_;
  const double doubt = depth_doubt(x, y);
  const DVec2 centre = place(x, y, 0.5, 0.5, inverse);
  if (std::isnan(centre.x)) return kInfinity;
  double corner = 0.0, parallax = parallax_px(point, doubt);
  for (const DVec2 at : {DVec2{0, 0}, DVec2{1, 0}, DVec2{0, 1}, DVec2{1, 1}}) {
    corner = std::max(corner, glm::distance(place(x, y, at.x, at.y, inverse), centre));
    const DVec3 there =
        rotation_ * math::direction_from_tangent(DVec2(source_.grid.tangent(
                        x, y, static_cast<float>(at.x), static_cast<float>(at.y)))) +
        inverse * offset_m_;
    parallax = std::max(parallax, parallax_px(there, doubt));
  }
  const double per_tangent = std::max(pixels_per_tangent_.x, pixels_per_tangent_.y);
  const double beyond_axis = 1.0 + glm::dot(DVec2(point), DVec2(point)) / (point.z * point.z);
  const double pose =
      per_tangent * (doubt_.turn.value() * beyond_axis +
                     doubt_.position_m * inverse * std::sqrt(beyond_axis) / -point.z);
  return corner * (1.0 + 2.0 * kUneven_cells) + parallax + drawn_px_ + pose;
}

ErrorBound::Summary ErrorBound::summarise() const {
  struct Weighed {
    double bound_px, area;
  };
  std::vector<Weighed> cells;
  double all = 0.0;
  for (int y = kEvery / 2; y < source_.grid.height(); y += kEvery) {
    for (int x = kEvery / 2; x < source_.grid.width(); x += kEvery) {
      const auto inverse =
          static_cast<double>(sound_inverse_depth(source_.inverse_depth_per_m(x, y)));
      const DVec2 seen = place(x, y, 0.5, 0.5, inverse);
      if (!(seen.x >= 0.0 && seen.x <= display_.width_px && seen.y >= 0.0 &&
            seen.y <= display_.height_px)) {
        continue;
      }
      const Vec2 size = source_.grid.footprint(x, y);
      cells.push_back({at(x, y), static_cast<double>(size.x) * static_cast<double>(size.y)});
      all += cells.back().area;
    }
  }
  if (cells.empty()) return {};
  std::sort(cells.begin(), cells.end(),
            [](const Weighed& a, const Weighed& b) { return a.bound_px < b.bound_px; });
  const auto quantile = [&](double share) {
    double below = 0.0;
    for (const Weighed& cell : cells) {
      below += cell.area;
      if (below >= share * all) return cell.bound_px;
    }
    return cells.back().bound_px;
  };
  return {quantile(0.5), quantile(0.95), cells.back().bound_px};
}

}  // namespace macula::reprojection
