#include "server/kernels/planes.h"

#include "shared/base/check.h"

namespace macula::kernels {
namespace {

template <class T>
void size_plane(image::Plane<T>& plane, bool wanted, int width, int height) {
  if (!wanted) {
    plane.resize(0, 0);
  } else if (plane.width() != width || plane.height() != height) {
    plane.resize(width, height);
  }
}

}  // namespace

void prepare_buffers(std::span<const View> views, FrameBuffers& out) {
  out.views.resize(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const int width = views[v].grid.width(), height = views[v].grid.height();
    ViewBuffers& planes = out.views[v];
    size_plane(planes.radiance, true, width, height);
    size_plane(planes.depth_m, true, width, height);
    size_plane(planes.surface_id, (out.wanted & kSurfaceId) != 0, width, height);
    size_plane(planes.normal, (out.wanted & kNormal) != 0, width, height);
    size_plane(planes.albedo, (out.wanted & kAlbedo) != 0, width, height);
    size_plane(planes.motion, false, width, height);
    size_plane(planes.rate, (out.wanted & kRate) != 0, width, height);
    size_plane(planes.variance, (out.wanted & kVariance) != 0, width, height);
    size_plane(planes.samples, (out.wanted & kSamples) != 0, width, height);
    size_plane(planes.steps, (out.wanted & kSteps) != 0, width, height);
    size_plane(planes.light, (out.wanted & kLight) != 0, width, height);
    size_plane(planes.reflectance, (out.wanted & kLight) != 0, width, height);
  }
}

scheduling::Outcome fill_rate(const FrameRequest& request, TileScheduler& scheduler,
                              FrameBuffers& out) {
  if ((out.wanted & kRate) == 0) return scheduling::Outcome::Completed;
  MACULA_CHECK(request.foveation.view_count() == request.views.size());
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    const auto rows = static_cast<std::size_t>(request.views[v].grid.height());
    const auto outcome = scheduler.run(rows, [&](std::size_t y) {
      request.foveation.rate_row(v, static_cast<int>(y),
                                 out.views[v].rate.row(static_cast<int>(y)));
    });
    if (outcome == scheduling::Outcome::Stopped) return outcome;
  }
  return scheduling::Outcome::Completed;
}

}  // namespace macula::kernels
