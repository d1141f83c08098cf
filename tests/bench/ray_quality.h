// Errors of a picture in the regions of `macula-bench ray`, by cross-MSE against two independent
// half-references: mean((x - r1)(x - r2)) is the squared error against the true picture without
// bias. Values are exposed linear radiance held below kBrightest. Pure.
#pragma once

#include "tests/bench/ray_reference.h"

namespace macula::bench {

inline constexpr float kBrightest = 4.0F;

/// Squared errors summed up over the pixels of a region and over key frames.
struct CrossError {
  double sum = 0.0, reference_variance = 0.0, weight = 0.0;

  /// One pixel: x - r1 and x - r2. With n1, n2 the noise of the halves and E the true error, the
  /// variance of (E - n1)(E - n2) is about E^2 (n1 - n2)^2 + (n1 - n2)^4 / 4.
  /// `share`: how much the pixel counts.
  void add(const Rgb& first, const Rgb& second, double share = 1.0);
  double rmse() const;
  /// What the references' own noise does to rmse(), as a share of it.
  double relative_standard_error() const;
};

struct RegionErrors {
  CrossError f10, ring, out25;  ///< e <= 10, 10 < e <= 25, e > 25 degrees
};

/// What judges the pictures of one key frame, all on the display's raster.
class Judge {
 public:
  Judge(const RaySetting& setting, const Gaze& gaze, HalfReferences references);

  void add_errors(const Plane<Rgb>& radiance, RegionErrors& errors) const;
  double gp_psnr_db(const Plane<Rgb>& radiance) const;
  double psnr_db(const Plane<Rgb>& radiance) const;
  Plane<Rgb> reference() const;

 private:
  Plane<Rgb> encoded(const Plane<Rgb>& radiance) const;

  const RaySetting& setting_;
  HalfReferences references_;
  Plane<float> eccentricity_deg_;
  DVec2 gaze_px_;
};

/// A picture on any grid of the same view, bilinear on the display's raster.
Plane<Rgb> on_raster(const Plane<Rgb>& cells, const PixelGrid& grid,
                     const foveation::Display& display);

/// Display values as sRGB in [0, 1].
Plane<Rgb> display_encoded(const image::Tone& tone, const Plane<Rgb>& radiance);

}  // namespace macula::bench
