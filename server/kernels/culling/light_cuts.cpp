#include "server/kernels/culling/light_cuts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/image/color.h"

namespace macula::kernels::culling {

lights::LightTree tree_over(std::span<const lights::VirtualPointLight> lights) {
  std::vector<lights::LightBounds> bounds(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    bounds[i].centre = Vec3(lights[i].position);
    bounds[i].axis = lights[i].normal;
    bounds[i].half_sine = 0.0F;  // full intensity along the normal alone
    bounds[i].intensity = image::luminance(lights[i].flux) / std::numbers::pi;
  }
  return lights::LightTree(bounds);
}

image::Plane<std::uint16_t> cut_sizes(const PixelGrid& grid, const image::Plane<float>& importance,
                                      int step, double mean, int most) {
  image::Plane<std::uint16_t> sizes(grid.width(), grid.height());
  double sum = 0.0;
  for (const float value : importance.pixels()) sum += static_cast<double>(value);
  const double scale = sum > 0.0 ? mean * static_cast<double>(importance.size()) / sum : 0.0;
  for (int y = 0; y < sizes.height(); ++y) {
    for (int x = 0; x < sizes.width(); ++x) {
      const double wanted = scale * static_cast<double>(importance(x / step, y / step));
      sizes(x, y) =
          static_cast<std::uint16_t>(std::clamp<long>(std::lround(wanted), 1, std::max(most, 1)));
    }
  }
  return sizes;
}

}  // namespace macula::kernels::culling
