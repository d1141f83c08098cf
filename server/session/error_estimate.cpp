#include "server/session/error_estimate.h"

#include <cmath>
#include <numbers>

#include "server/session/view_builder.h"
#include "shared/foveation/eccentricity.h"
#include "shared/image/bilinear.h"
#include "shared/metrics/foveated.h"

namespace macula::session {
namespace {

/// Of the scale at which a grid has half the cells; the two lie apart, so that cells do not
/// coincide outside the disc of full rate, and together they have about a frame's cells.
constexpr double kApart = 0.06;
constexpr std::uint64_t kOtherSeed = 0x9E37'79B9'7F4A'7C15U;

struct HalfPicture {
  PixelGrid grid;
  image::Plane<Rgb> radiance;
};

HalfPicture render_half(const kernels::Kernel& kernel, const kernels::SceneFrame& scene,
                        const FrameToJudge& frame, double share, std::uint64_t seed,
                        kernels::TileScheduler& scheduler) {
  const double scale = std::min(frame.scale * share, 1.0);
  const auto [display, grid] =
      make_scaled_grid(frame.display, scale, frame.view.gaze, frame.model, frame.grid);
  kernels::View view = frame.view;
  view.grid = grid;
  const FoveationMap map({{view.grid, view.gaze, display.pixel_tangent()}}, frame.model);
  kernels::History none;
  kernels::FrameBuffers out;
  kernel.render({{&view, 1}, map, frame.frame, seed}, scene, none, scheduler, out);
  return {view.grid, std::move(out.views.front().radiance)};
}

}  // namespace

double half_picture_difference(const kernels::Kernel& kernel, const kernels::SceneFrame& scene,
                               const FrameToJudge& frame, kernels::TileScheduler& scheduler) {
  const double half = 1.0 / std::numbers::sqrt2;
  const HalfPicture a =
      render_half(kernel, scene, frame, half * (1.0 + kApart), frame.seed, scheduler);
  const HalfPicture b =
      render_half(kernel, scene, frame, half * (1.0 - kApart), frame.seed ^ kOtherSeed, scheduler);
  const PixelGrid& cells = frame.view.grid;
  double sum = 0.0, weights = 0.0;
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const Vec2 at = cells.tangent(x, y), size = cells.footprint(x, y);
      const auto in_a = a.grid.locate(at), in_b = b.grid.locate(at);
      if (!in_a || !in_b) continue;
      const Rgb off = image::display_linear(frame.view.tone, image::bilinear(a.radiance, *in_a)) -
                      image::display_linear(frame.view.tone, image::bilinear(b.radiance, *in_b));
      const Radians e = foveation::eccentricity(frame.view.gaze.direction, cells.ray(x, y));
      const double weight = metrics::acuity_weight(e) * static_cast<double>(size.x * size.y);
      sum += weight * static_cast<double>(glm::dot(off, off)) / 3.0;
      weights += weight;
    }
  }
  return weights > 0.0 ? std::sqrt(0.5 * sum / weights) : 0.0;
}

}  // namespace macula::session
