#include "server/kernels/ray/cache.h"

#include <algorithm>

#include "server/kernels/frame_buffers.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
namespace {

template <class T>
void size_plane(Plane<T>& plane, bool wanted, int width, int height) {
  if (!wanted) width = height = 0;
  if (plane.width() != width || plane.height() != height) plane.resize(width, height);
}

}  // namespace

void prepare_cache(Cache& cache, int width, int height, bool has_light, unsigned wanted) {
  size_plane(cache.color, true, width, height);
  size_plane(cache.sampled, has_light, width, height);
  size_plane(cache.reflectance, has_light, width, height);
  size_plane(cache.info, true, width, height);
  size_plane(cache.inverse_depth, true, width, height);
  size_plane(cache.surface_id, (wanted & kSurfaceId) != 0, width, height);
  size_plane(cache.normal, (wanted & kNormal) != 0, width, height);
  size_plane(cache.albedo, (wanted & kAlbedo) != 0, width, height);
}

void EyePath::note(std::uint32_t clock, const DVec3& eye) {
  // Clocks may wrap: their difference is right.
  if (eyes_.empty() || clock - newest_ > 1) eyes_.assign(kHeld, eye);
  eyes_[clock % kHeld] = eye;
  newest_ = clock;
}

std::vector<Vec3> EyePath::ways(const Pose& world_from_view) const {
  MACULA_CHECK(!eyes_.empty());
  const DQuat view_from_world = glm::conjugate(world_from_view.rotation);
  std::vector<Vec3> ways;
  for (std::uint32_t age = 0; age < kHeld; ++age) {
    const DVec3& then = eyes_[(newest_ - age) % kHeld];
    ways.emplace_back(view_from_world * (world_from_view.position - then));
  }
  return ways;
}

}  // namespace macula::kernels::ray
