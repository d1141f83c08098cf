#include "shared/foveation/pixel_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "shared/base/check.h"
#include "shared/foveation/eccentricity.h"
#include "shared/math/hash.h"

namespace macula::foveation {
namespace {

constexpr int kMostCells = 16384;
constexpr double kFarthestTangent = 1e3;

/// Continuous index of `value` in strictly increasing edges: i + fraction of cell i.
std::optional<float> locate_on_axis(const std::vector<float>& edges, float value) {
  if (!(value >= edges.front() && value <= edges.back())) return std::nullopt;
  const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, value);
  const auto cell = static_cast<std::size_t>(above - edges.begin()) - 1;
  return static_cast<float>(cell) + (value - edges[cell]) / (edges[cell + 1] - edges[cell]);
}

bool is_valid_axis(const std::vector<float>& edges) {
  if (edges.size() < 2 || edges.size() > kMostCells + 1U) return false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!std::isfinite(edges[i]) || std::abs(edges[i]) > kFarthestTangent) return false;
    if (i > 0 && edges[i] <= edges[i - 1]) return false;
  }
  return true;
}

std::uint64_t pair_bits(float low, float high) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(low)) << 32 |
         std::bit_cast<std::uint32_t>(high);
}

/// Edge k of the display's raster; the one expression that every grid shares, so that equal edges
/// are bit-equal. k may lie outside the display (guard band) or between pixels (oversampling).
float raster_edge(double origin, double step, double k) {
  return static_cast<float>(origin + k * step);
}

std::vector<float> uniform_edges(double origin, double step, int count) {
  std::vector<float> edges(static_cast<std::size_t>(count) + 1);
  for (int k = 0; k <= count; ++k) edges[k] = raster_edge(origin, step, k);
  return edges;
}

/// One axis of a foveal grid. `along` is the axis of the table (0: x, 1: y), `across` the other
/// one. A line is the set of tangents with one value of `along`; its eccentricity is the least one
/// on it inside the view, so that a step chosen for the line is fine enough for every cell on it.
class FovealAxis {
 public:
  FovealAxis(int along, const DVec3& gaze, const DVec2& low, const DVec2& high, double origin,
             double pixel, const RateModel& model, const FovealGridOptions& options)
      : along_(along),
        gaze_(gaze),
        low_(low),
        high_(high),
        origin_(origin),
        pixel_(pixel),
        model_(model),
        oversampling_(options.fovea_oversampling),
        full_rate_rad_(Radians{options.full_rate_radius}.value()) {}

  std::vector<float> edges() const {
    const auto [first, last] = raster_block(nearest_line());
    std::vector<float> left = march(first, low_[along_], -1.0);
    std::vector<float> result(left.rbegin(), left.rend());
    for (double k = first; k <= last + 0.5; ++k) {
      result.push_back(raster_edge(origin_, fine_step(), k));
    }
    const std::vector<float> right = march(last, high_[along_], 1.0);
    result.insert(result.end(), right.begin(), right.end());
    return strictly_increasing(std::move(result));
  }

 private:
  double fine_step() const { return pixel_ / oversampling_; }

  /// Least eccentricity on the line. On it, d = (line, t) and cos e = (A + B t) / sqrt(C + t^2) has
  /// its only stationary point at t = B C / A, a maximum for A > 0; otherwise an end of the line is
  /// nearest.
  double line_eccentricity(double line) const {
    const int across = 1 - along_;
    const DVec2 in_plane{gaze_.x, -gaze_.y};  // tangent y points down
    const double a = in_plane[along_] * line - gaze_.z, b = in_plane[across], c = line * line + 1.0;
    double least =
        std::min(eccentricity_at(line, low_[across]), eccentricity_at(line, high_[across]));
    if (a > 0.0) {
      const double foot = b * c / a;
      if (foot > low_[across] && foot < high_[across]) {
        least = std::min(least, eccentricity_at(line, foot));
      }
    }
    return least;
  }

  double eccentricity_at(double line, double other) const {
    const DVec2 tangent = along_ == 0 ? DVec2{line, other} : DVec2{other, line};
    return eccentricity(gaze_, math::direction_from_tangent(tangent)).value();
  }

  /// The line of least eccentricity: those within an angle form an interval (a cone cut by the
  /// plane is convex), so the function has one valley and a golden-section search finds it.
  double nearest_line() const {
    constexpr double kGolden = 0.6180339887498949;
    double a = low_[along_], b = high_[along_];
    for (int step = 0; step < 64; ++step) {
      const double c = b - kGolden * (b - a), d = a + kGolden * (b - a);
      if (line_eccentricity(c) <= line_eccentricity(d)) {
        b = d;
      } else {
        a = c;
      }
    }
    return 0.5 * (a + b);
  }

  /// Raster indices (in fine steps) of the block that keeps full rate; at least one cell.
  std::pair<double, double> raster_block(double nearest) const {
    const auto index = [this](double line) { return (line - origin_) / fine_step(); };
    double first = nearest, last = nearest;
    if (line_eccentricity(nearest) <= full_rate_rad_) {
      first = boundary(nearest, low_[along_]);
      last = boundary(nearest, high_[along_]);
    }
    // A guard band need not end on the raster: the block never reaches past the view.
    const double lowest = std::ceil(index(low_[along_]) - kRasterSlack);
    const double highest = std::floor(index(high_[along_]) + kRasterSlack);
    const double begin = std::clamp(std::floor(index(first)), lowest, highest - 1.0);
    const double end = std::clamp(std::ceil(index(last)), begin + 1.0, highest);
    return {begin, end};
  }

  /// Where the full-rate radius is crossed between `inside` and `end` (or `end` itself).
  double boundary(double inside, double end) const {
    if (line_eccentricity(end) <= full_rate_rad_) return end;
    double outside = end;
    for (int step = 0; step < 64; ++step) {
      const double middle = 0.5 * (inside + outside);
      (line_eccentricity(middle) <= full_rate_rad_ ? inside : outside) = middle;
    }
    return outside;
  }

  /// Largest step allowed for a cell whose nearest edge is `line`.
  double step_at(double line) const {
    const double e = line_eccentricity(line);
    // Oversampling fades out over one more fovea radius instead of ending in a seam.
    const double fade = full_rate_rad_ > 0.0 ? std::clamp(2.0 - e / full_rate_rad_, 0.0, 1.0) : 0.0;
    const double density =
        std::sqrt(model_.rate(Radians{e})) * (1.0 + (oversampling_ - 1.0) * fade);
    return pixel_ / density;
  }

  /// Edges from raster index `from` (not included) outwards to `end` (included): on the raster for
  /// as long as the rate asks for its full density, free of it from then on.
  std::vector<float> march(double from, double end, double sign) const {
    std::vector<double> edges{static_cast<double>(raster_edge(origin_, fine_step(), from))};
    const auto left_over = [&] { return sign * (end - edges.back()); };
    double k = from;
    while (step_at(edges.back()) <= fine_step() &&
           left_over() > (1.0 - kRasterSlack) * fine_step()) {
      k += sign;
      edges.push_back(static_cast<double>(raster_edge(origin_, fine_step(), k)));
    }
    while (left_over() > kRasterSlack * fine_step() && edges.size() < kMostCells) {
      edges.push_back(next_edge(edges.back(), end, sign));
    }
    return {edges.begin() + 1, edges.end()};
  }

  /// One allowed step outwards; near the end two equal cells instead of a sliver.
  double next_edge(double edge, double end, double sign) const {
    const double step = step_at(edge), left_over = sign * (end - edge);
    if (left_over > 1.5 * step) return edge + sign * step;
    return left_over > step ? 0.5 * (edge + end) : end;
  }

  /// Rounding to float may merge an edge with the view's border when they differ by less than an
  /// ulp.
  static std::vector<float> strictly_increasing(std::vector<float> edges) {
    edges.erase(std::unique(edges.begin(), edges.end(), [](float a, float b) { return b <= a; }),
                edges.end());
    return edges;
  }

  /// In fine steps: how far double rounding may push a border that lies on the raster off it.
  static constexpr double kRasterSlack = 1e-6;

  int along_;
  DVec3 gaze_;
  DVec2 low_, high_;
  double origin_, pixel_;
  const RateModel& model_;
  double oversampling_, full_rate_rad_;
};

/// The view's border moved outwards by the guard band, as far as a tangent plane can show (85
/// degrees).
std::pair<DVec2, DVec2> guarded_view(const Fov& fov, Degrees guard_band) {
  constexpr Degrees kWidest{85.0};
  const auto grow = [&](Radians angle, double sign) {
    const Radians limit = kWidest;
    const double grown = angle.value() + sign * Radians{guard_band}.value();
    const double widest = std::max(limit.value(), sign * angle.value());
    return Radians{sign * std::min(sign * grown, widest)};
  };
  const Fov wide{grow(fov.left, -1.0), grow(fov.right, 1.0), grow(fov.up, 1.0),
                 grow(fov.down, -1.0)};
  return {wide.tangent_min(), wide.tangent_max()};
}

}  // namespace

DVec2 Display::pixel_tangent() const {
  return (fov.tangent_max() - fov.tangent_min()) / DVec2(width_px, height_px);
}

double Display::pixels_per_degree() const {
  return Radians{Degrees{1.0}}.value() / pixel_tangent().x;
}

std::optional<Vec2> PixelGrid::locate(const Vec2& tangent) const {
  const auto x = locate_on_axis(x_edges, tangent.x);
  const auto y = locate_on_axis(y_edges, tangent.y);
  if (!x || !y) return std::nullopt;
  return Vec2{*x, *y};
}

std::optional<Vec2> PixelGrid::project(const Vec3& view_point) const {
  if (!(view_point.z < 0.0F)) return std::nullopt;
  return locate(math::tangent_from_direction(view_point));
}

std::uint64_t PixelGrid::cell_key(int x, int y) const {
  return math::hash_combine(pair_bits(x_edges[x], x_edges[x + 1]),
                            pair_bits(y_edges[y], y_edges[y + 1]));
}

bool is_valid(const PixelGrid& grid) {
  return is_valid_axis(grid.x_edges) && is_valid_axis(grid.y_edges);
}

PixelGrid make_uniform_grid(const Display& display) {
  MACULA_CHECK(math::is_valid(display.fov) && display.width_px > 0 && display.height_px > 0);
  const DVec2 origin = display.fov.tangent_min(), pixel = display.pixel_tangent();
  return {uniform_edges(origin.x, pixel.x, display.width_px),
          uniform_edges(origin.y, pixel.y, display.height_px)};
}

PixelGrid make_foveal_grid(const Display& display, const Gaze& gaze, const RateModel& model,
                           const FovealGridOptions& options) {
  MACULA_CHECK(math::is_valid(display.fov) && display.width_px > 0 && display.height_px > 0);
  MACULA_CHECK(options.fovea_oversampling >= 1.0);
  const DVec3 direction{gaze.direction};
  MACULA_CHECK(math::is_finite(direction) && glm::length(direction) > 0.0, "filter the gaze first");
  const DVec2 origin = display.fov.tangent_min(), pixel = display.pixel_tangent();
  const auto [low, high] = guarded_view(display.fov, options.guard_band);
  const auto axis = [&](int along) {
    return FovealAxis(along, direction, low, high, origin[along], pixel[along], model, options)
        .edges();
  };
  return {axis(0), axis(1)};
}

}  // namespace macula::foveation
