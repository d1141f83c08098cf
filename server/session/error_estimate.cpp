#include "server/session/error_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "shared/foveation/eccentricity.h"
#include "shared/image/bilinear.h"
#include "shared/math/hash.h"
#include "shared/metrics/foveated.h"

namespace macula::session {
namespace {

/// Pixels are looked at in squares, so that neighbours' rays go together: so many pixels and so
/// many squares along each axis.
constexpr std::size_t kSquare = 2, kSquares = 9;
/// Cells a pixel along an axis of the two pictures. Unlike, since a kernel's samples may lie at
/// fixed places of a cell.
constexpr int kFirstFiner = 2, kSecondFiner = 3;
/// Where the weights of a column are looked at to tell how much it matters.
constexpr int kProbes = 16;
/// Steps from judgement to judgement that fill the unit square evenly (Roberts 2018, R2).
constexpr std::array kSteps{0.7548776662466927, 0.5698402909980532};
constexpr std::uint64_t kOtherSeed = 0x9E37'79B9'7F4A'7C15U;

/// A solid angle on the tangent plane, and what the eye resolves of it.
double weight_of(const Gaze& gaze, const Vec3& ray, const Vec2& footprint) {
  const double cosine = 1.0 / glm::length(DVec3(ray));
  return metrics::acuity_weight(foveation::eccentricity(gaze.direction, ray)) * cosine * cosine *
         cosine * static_cast<double>(footprint.x) * static_cast<double>(footprint.y);
}

// ---- which pixels ----

/// Along one axis of the display.
struct ChosenPixel {
  int at = 0;
  double chance = 0.0;  ///< of being looked at, (0, 1]
};

/// Chances proportional to `wishes` but at most 1, which add up to `count`.
std::vector<double> chances_of(std::span<const double> wishes, double count) {
  std::vector<double> chances(wishes.size(), 0.0);
  double left = count, rest = 0.0;
  for (const double wish : wishes) rest += wish;
  for (bool changed = true; changed;) {
    changed = false;
    const double scale = left / rest;
    for (std::size_t i = 0; i < wishes.size(); ++i) {
      if (chances[i] == 1.0 || wishes[i] * scale < 1.0) continue;
      chances[i] = 1.0, left -= 1.0, rest -= wishes[i], changed = true;
    }
  }
  for (std::size_t i = 0; i < wishes.size(); ++i)
    if (chances[i] < 1.0) chances[i] = wishes[i] * left / rest;
  return chances;
}

/// Systematic sampling from `start` in [0, 1): every square by exactly its chance.
std::vector<ChosenPixel> choose(std::span<const double> weights, double start) {
  std::vector<double> wishes((weights.size() + kSquare - 1) / kSquare, 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) wishes[i / kSquare] += weights[i];
  const std::vector<double> chances =
      chances_of(wishes, static_cast<double>(std::min(kSquares, wishes.size())));
  std::vector<ChosenPixel> chosen;
  double passed = start;
  for (std::size_t square = 0; square < chances.size(); ++square) {
    const double before = passed;
    passed += chances[square];
    if (std::floor(passed) == std::floor(before)) continue;
    const std::size_t end = std::min((square + 1) * kSquare, weights.size());
    for (std::size_t i = square * kSquare; i < end; ++i)
      chosen.push_back({static_cast<int>(i), chances[square]});
  }
  return chosen;
}

struct Spots {
  std::vector<ChosenPixel> columns, rows;
};

Spots choose_spots(const FrameToJudge& frame, const PixelGrid& raster) {
  const auto weight = [&](int x, int y) {
    return weight_of(frame.view.gaze, raster.ray(x, y), raster.footprint(x, y));
  };
  std::vector<double> columns(static_cast<std::size_t>(raster.width()), 0.0);
  std::vector<double> rows(static_cast<std::size_t>(raster.height()), 0.0);
  for (int k = 0; k < kProbes; ++k) {
    const int x = (2 * k + 1) * raster.width() / (2 * kProbes);
    const int y = (2 * k + 1) * raster.height() / (2 * kProbes);
    for (int i = 0; i < raster.width(); ++i) columns[static_cast<std::size_t>(i)] += weight(i, y);
    for (int i = 0; i < raster.height(); ++i) rows[static_cast<std::size_t>(i)] += weight(x, i);
  }
  const auto start = [&](std::uint64_t axis, double step) {
    const double first = static_cast<double>(math::unit_float(math::hash_mix(frame.seed + axis)));
    return std::fmod(first + step * static_cast<double>(frame.judgement), 1.0);
  };
  return {choose(columns, start(0, kSteps[0])), choose(rows, start(1, kSteps[1]))};
}

// ---- a picture of them ----

/// The chosen pixels along one axis, each as `finer` cells, and one wide cell over what lies
/// between.
struct Axis {
  std::vector<float> edges;
  std::vector<int> first_cell;  ///< of each chosen pixel, in order
};

Axis cells_of(std::span<const ChosenPixel> pixels, const std::vector<float>& pixel_edges,
              int finer) {
  Axis axis;
  int end = -1;  // of the pixels so far
  for (const ChosenPixel& pixel : pixels) {
    const auto at = static_cast<std::size_t>(pixel.at);
    const float low = pixel_edges[at], high = pixel_edges[at + 1];
    if (pixel.at != end) axis.edges.push_back(low);
    axis.first_cell.push_back(static_cast<int>(axis.edges.size()) - 1);
    for (int k = 1; k < finer; ++k)
      axis.edges.push_back(low + (high - low) * static_cast<float>(k) / static_cast<float>(finer));
    axis.edges.push_back(high);
    end = pixel.at + 1;
  }
  return axis;
}

/// What a display shows of a pixel's mean. A curve that bends, as every display's does at white,
/// takes the mean of few samples for darker than it is; what it does to the means of their halves
/// tells by how much (the jackknife; Quenouille 1956).
Rgb shown_of(const image::Tone& tone, const image::Plane<Rgb>& cells, int first_x, int first_y,
             int finer) {
  std::array<Rgb, 2> sums{};
  std::array<float, 2> counts{};
  for (int k = 0; k < finer * finer; ++k) {
    const auto half = static_cast<std::size_t>((k % finer + k / finer) % 2);
    sums[half] += cells(first_x + k % finer, first_y + k / finer);
    counts[half] += 1.0F;
  }
  const Rgb whole = image::display_linear(tone, (sums[0] + sums[1]) / (counts[0] + counts[1]));
  const Rgb halves = 0.5F * (image::display_linear(tone, sums[0] / counts[0]) +
                             image::display_linear(tone, sums[1] / counts[1]));
  return 2.0F * whole - halves;
}

/// Display-linear colours of the chosen pixels.
std::optional<image::Plane<Rgb>> render_spots(const kernels::Kernel& reference,
                                              const kernels::SceneFrame& scene,
                                              const FrameToJudge& frame, const PixelGrid& raster,
                                              const Spots& spots, int finer, std::uint64_t seed,
                                              kernels::TileScheduler& scheduler) {
  const Axis x = cells_of(spots.columns, raster.x_edges, finer);
  const Axis y = cells_of(spots.rows, raster.y_edges, finer);
  kernels::View view = frame.view;
  view.grid = {x.edges, y.edges};
  const FoveationMap map({{view.grid, view.gaze, frame.display.pixel_tangent()}},
                         {.curve = foveation::RateCurve::Uniform});
  kernels::History none;
  kernels::FrameBuffers out;
  const auto report =
      reference.render({{&view, 1}, map, frame.judgement, seed}, scene, none, scheduler, out);
  if (report.stopped) return std::nullopt;
  const image::Plane<Rgb>& cells = out.views.front().radiance;
  image::Plane<Rgb> pixels(static_cast<int>(x.first_cell.size()),
                           static_cast<int>(y.first_cell.size()));
  for (int j = 0; j < pixels.height(); ++j)
    for (int i = 0; i < pixels.width(); ++i)
      pixels(i, j) = shown_of(view.tone, cells, x.first_cell[static_cast<std::size_t>(i)],
                              y.first_cell[static_cast<std::size_t>(j)], finer);
  return pixels;
}

}  // namespace

std::optional<SpotError> spot_error(const kernels::Kernel& reference,
                                    const kernels::SceneFrame& scene, const FrameToJudge& frame,
                                    const image::Plane<Rgb>& shown,
                                    kernels::TileScheduler& scheduler) {
  const PixelGrid raster = foveation::make_uniform_grid(frame.display);
  const Spots spots = choose_spots(frame, raster);
  const auto render = [&](int finer, std::uint64_t seed) {
    return render_spots(reference, scene, frame, raster, spots, finer, seed, scheduler);
  };
  const auto first = render(kFirstFiner, frame.seed);
  const auto second = render(kSecondFiner, frame.seed ^ kOtherSeed);
  if (!first || !second) return std::nullopt;
  SpotError error;
  for (int j = 0; j < first->height(); ++j) {
    const ChosenPixel& row = spots.rows[static_cast<std::size_t>(j)];
    for (int i = 0; i < first->width(); ++i) {
      const ChosenPixel& column = spots.columns[static_cast<std::size_t>(i)];
      const auto place = frame.view.grid.locate(raster.tangent(column.at, row.at));
      if (!place) continue;
      const Rgb own = image::display_linear(frame.view.tone, image::bilinear(shown, *place));
      const double weight = weight_of(frame.view.gaze, raster.ray(column.at, row.at),
                                      raster.footprint(column.at, row.at)) /
                            (column.chance * row.chance);
      error.squares +=
          weight * static_cast<double>(glm::dot(own - (*first)(i, j), own - (*second)(i, j))) / 3.0;
      error.weight += weight;
    }
  }
  return error;
}

}  // namespace macula::session
