#include "server/kernels/culling/same_surface.h"

#include <cmath>

namespace macula::kernels::culling {
namespace {

constexpr float kSameNormal = 0.906F;
constexpr float kSamePlane = 0.02F;

Plane<Vec3> places(const View& view, const Plane<float>& depth_m) {
  const Mat3 world_from_view(glm::mat3_cast(view.world_from_view.rotation));
  Plane<Vec3> out(depth_m.width(), depth_m.height());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out(x, y) = depth_m(x, y) * (world_from_view * view.grid.ray(x, y));
  return out;
}

}  // namespace

SameSurface::SameSurface(const View& view, const ViewBuffers& buffers)
    : buffers_(buffers), place_(places(view, buffers.depth_m)) {}

bool SameSurface::operator()(const Pixel& from, const Pixel& to) const {
  const float depth = buffers_.depth_m(from.x, from.y);
  if (!std::isfinite(depth) || !std::isfinite(buffers_.depth_m(to.x, to.y))) return false;
  if (from.x == to.x && from.y == to.y) return true;
  const Vec3& normal = buffers_.normal(from.x, from.y);
  return glm::dot(normal, buffers_.normal(to.x, to.y)) > kSameNormal &&
         std::abs(glm::dot(normal, place_(to.x, to.y) - place_(from.x, from.y))) <=
             kSamePlane * depth;
}

}  // namespace macula::kernels::culling
