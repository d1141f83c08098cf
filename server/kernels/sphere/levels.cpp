#include "server/kernels/sphere/levels.h"

namespace macula::kernels::sphere {

PixelGrid coarsen(const PixelGrid& grid, int side) {
  const auto thin = [side](const std::vector<float>& edges) {
    std::vector<float> kept;
    for (std::size_t i = 0; i + 1 < edges.size(); i += static_cast<std::size_t>(side))
      kept.push_back(edges[i]);
    kept.push_back(edges.back());
    return kept;
  };
  return {thin(grid.x_edges), thin(grid.y_edges)};
}

void MidLevel::resize(int width, int height) {
  source.resize(width, height, MidSource::Traced);
  radiance.resize(width, height, Rgb{0.0F});
  inverse_depth.resize(width, height, 0.0F);
  age.resize(width, height, 0);
  surface_id.resize(width, height, 0);
  normal.resize(width, height, Vec3{0.0F});
  albedo.resize(width, height, Rgb{0.0F});
  steps.resize(width, height, 0.0F);
}

}  // namespace macula::kernels::sphere
