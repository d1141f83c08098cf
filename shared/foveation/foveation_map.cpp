#include "shared/foveation/foveation_map.h"

#include <cmath>
#include <utility>

#include "shared/base/check.h"
#include "shared/foveation/eccentricity.h"

namespace macula::foveation {

FoveationMap::FoveationMap(std::vector<ViewInput> views, const RateModel& model)
    : views_(std::move(views)), model_(model) {}

void FoveationMap::eccentricity_row(std::size_t view, int y, std::span<float> out) const {
  const ViewInput& input = views_.at(view);
  MACULA_CHECK(out.size() == static_cast<std::size_t>(input.grid.width()));
  for (int x = 0; x < input.grid.width(); ++x) {
    out[x] = static_cast<float>(eccentricity(input.gaze.direction, input.grid.ray(x, y)).value());
  }
}

void FoveationMap::rate_row(std::size_t view, int y, std::span<float> out) const {
  eccentricity_row(view, y, out);
  for (float& value : out) value = static_cast<float>(model_.rate(Radians{value}));
}

void FoveationMap::samples_wanted_row(std::size_t view, int y, std::span<float> out) const {
  rate_row(view, y, out);
  const ViewInput& input = views_[view];
  const double nominal_area = input.nominal_pixel_tangent.x * input.nominal_pixel_tangent.y;
  for (int x = 0; x < input.grid.width(); ++x) {
    const Vec2 cell = input.grid.footprint(x, y);
    out[x] *= static_cast<float>(static_cast<double>(cell.x) * cell.y / nominal_area);
  }
}

}  // namespace macula::foveation
