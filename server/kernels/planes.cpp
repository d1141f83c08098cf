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

void prepare_planes(ViewBuffers& planes, unsigned wanted, int width, int height) {
  size_plane(planes.radiance, true, width, height);
  size_plane(planes.depth_m, true, width, height);
  size_plane(planes.surface_id, (wanted & kSurfaceId) != 0, width, height);
  size_plane(planes.normal, (wanted & kNormal) != 0, width, height);
  size_plane(planes.albedo, (wanted & kAlbedo) != 0, width, height);
  size_plane(planes.motion, false, width, height);
  size_plane(planes.rate, (wanted & kRate) != 0, width, height);
  size_plane(planes.variance, (wanted & kVariance) != 0, width, height);
  size_plane(planes.samples, (wanted & kSamples) != 0, width, height);
  size_plane(planes.steps, (wanted & kSteps) != 0, width, height);
  size_plane(planes.light, (wanted & kLight) != 0, width, height);
  size_plane(planes.reflectance, (wanted & kLight) != 0, width, height);
}

void prepare_buffers(std::span<const View> views, FrameBuffers& out) {
  out.views.resize(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    prepare_planes(out.views[v], out.wanted, views[v].grid.width(), views[v].grid.height());
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
