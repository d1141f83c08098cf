#include "tests/bench/ray_quality.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/foveation/eccentricity.h"
#include "shared/image/bilinear.h"
#include "shared/metrics/error.h"
#include "shared/metrics/foveated.h"

namespace macula::bench {
namespace {

Rgb held(const Rgb& radiance, float gain) {
  return glm::clamp(gain * radiance, Rgb{0.0F}, Rgb{kBrightest});
}

}  // namespace

double CrossError::rmse() const {
  return weight > 0.0 ? std::sqrt(std::max(sum / weight, 0.0)) : 0.0;
}

void CrossError::add(const Rgb& first, const Rgb& second, double share) {
  const Rgb between = 0.5F * (first + second), noise = first - second;
  const double error = glm::dot(between, between) / 3.0, spread = glm::dot(noise, noise) / 3.0;
  sum += share * static_cast<double>(glm::dot(first, second)) / 3.0;
  reference_variance += share * share * (error * spread + 0.25 * spread * spread);
  weight += share;
}

double CrossError::relative_standard_error() const {
  return sum > 0.0 ? 0.5 * std::sqrt(reference_variance) / sum : INFINITY;  // half: of the root
}

Judge::Judge(const RaySetting& setting, const Gaze& gaze, HalfReferences references)
    : setting_(setting), references_(std::move(references)), gaze_px_(0.0) {
  const PixelGrid raster = foveation::make_uniform_grid(setting.display);
  eccentricity_deg_ = Plane<float>(raster.width(), raster.height());
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      const Radians e = foveation::eccentricity(gaze.direction, raster.ray(x, y));
      eccentricity_deg_(x, y) = static_cast<float>(Degrees{e}.value());
    }
  }
  const DVec2 tangent(math::tangent_from_direction(gaze.direction));
  gaze_px_ = (tangent - setting.display.fov.tangent_min()) / setting.display.pixel_tangent();
}

void Judge::add_errors(const Plane<Rgb>& radiance, RegionErrors& errors) const {
  const float gain = std::exp2(setting_.tone.exposure_ev);
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    const Rgb value = held(radiance.pixels()[i], gain);
    const Rgb first = value - held(references_.first.pixels()[i], gain);
    const Rgb second = value - held(references_.second.pixels()[i], gain);
    const float e = eccentricity_deg_.pixels()[i];
    CrossError& region = e <= 10.0F ? errors.f10 : (e <= 25.0F ? errors.ring : errors.out25);
    region.add(first, second);
  }
}

Plane<Rgb> Judge::reference() const {
  Plane<Rgb> mean = references_.first;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    mean.pixels()[i] = 0.5F * (mean.pixels()[i] + references_.second.pixels()[i]);
  }
  return mean;
}

Plane<Rgb> Judge::encoded(const Plane<Rgb>& radiance) const {
  return display_encoded(setting_.tone, radiance);
}

double Judge::gp_psnr_db(const Plane<Rgb>& radiance) const {
  const DVec2 pixel = setting_.display.pixel_tangent();
  metrics::GazedView view;
  view.focal_px = 1.0 / pixel.x;
  view.axis_px = -setting_.display.fov.tangent_min() / pixel;
  view.gaze_px = gaze_px_;
  return metrics::gp_psnr_db(encoded(reference()), encoded(radiance), view);
}

double Judge::psnr_db(const Plane<Rgb>& radiance) const {
  return metrics::psnr_db(encoded(reference()), encoded(radiance));
}

Plane<Rgb> on_raster(const Plane<Rgb>& cells, const PixelGrid& grid,
                     const foveation::Display& display) {
  const PixelGrid raster = foveation::make_uniform_grid(display);
  if (raster == grid) return cells;
  Plane<Rgb> pixels(raster.width(), raster.height());
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      if (const auto place = grid.locate(raster.tangent(x, y)))
        pixels(x, y) = image::bilinear(cells, *place);
    }
  }
  return pixels;
}

Plane<Rgb> display_encoded(const image::Tone& tone, const Plane<Rgb>& radiance) {
  Plane<Rgb8> codes;
  image::encode(tone, radiance, codes);
  return metrics::unit_from_8bit(codes);
}

}  // namespace macula::bench
