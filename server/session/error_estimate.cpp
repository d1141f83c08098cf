#include "server/session/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "server/session/view_builder.h"
#include "shared/foveation/eccentricity.h"
#include "shared/image/bilinear.h"
#include "shared/metrics/foveated.h"

namespace macula::session {
namespace {

/// Scales of the two, whose squares add up to 1: together they have about a frame's cells. They lie
/// apart, so that they are blurred unlike: what is blurred out of both, none could tell.
constexpr double kFiner = 0.85, kCoarser = 0.527;
constexpr std::uint64_t kOtherSeed = 0x9E37'79B9'7F4A'7C15U;

struct HalfPicture {
  PixelGrid grid;
  image::Plane<Rgb> radiance;
  bool stopped = false;
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
  const auto report =
      kernel.render({{&view, 1}, map, frame.frame, seed}, scene, none, scheduler, out);
  return {view.grid, std::move(out.views.front().radiance), report.stopped};
}

}  // namespace

std::optional<double> half_picture_difference(const kernels::Kernel& kernel,
                                              const kernels::SceneFrame& scene,
                                              const FrameToJudge& frame,
                                              const image::Plane<Rgb>& shown,
                                              kernels::TileScheduler& scheduler) {
  const HalfPicture a = render_half(kernel, scene, frame, kFiner, frame.seed, scheduler);
  const HalfPicture b =
      render_half(kernel, scene, frame, kCoarser, frame.seed ^ kOtherSeed, scheduler);
  if (a.stopped || b.stopped) return std::nullopt;
  const PixelGrid& cells = frame.view.grid;
  double sum = 0.0, weights = 0.0;
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const Vec2 at = cells.tangent(x, y), size = cells.footprint(x, y);
      const auto in_a = a.grid.locate(at), in_b = b.grid.locate(at);
      if (!in_a || !in_b) continue;
      const auto display = [&](const Rgb& radiance) {
        return image::display_linear(frame.view.tone, radiance);
      };
      const Rgb own = display(shown(x, y));
      const Rgb from_a = own - display(image::bilinear(a.radiance, *in_a));
      const Rgb from_b = own - display(image::bilinear(b.radiance, *in_b));
      const Radians e = foveation::eccentricity(frame.view.gaze.direction, cells.ray(x, y));
      const double weight = metrics::acuity_weight(e) * static_cast<double>(size.x * size.y);
      // |s - a|^2 + |s - b|^2 - |a - b|^2 = 2 (s - a) (s - b)
      sum += weight * static_cast<double>(glm::dot(from_a, from_b)) / 3.0;
      weights += weight;
    }
  }
  return weights > 0.0 ? std::sqrt(std::max(sum, 0.0) / weights) : 0.0;
}

}  // namespace macula::session
