// What `macula-bench tradeoff` looks at, and how it judges: one scene by one kernel, seen from the
// scene's first camera by a square display of 90 degrees with the gaze in the middle, so that F25
// is 17 % of it. Errors are those of display-linear values, by cross-MSE against two independent
// half-references. World meters; one caller.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "server/session/error_estimate.h"
#include "tests/bench/picture_cache.h"
#include "tests/bench/ray_quality.h"
#include "tests/bench/still_job.h"
#include "tests/bench/tradeoff_cases.h"

namespace macula::bench {

struct TradeoffScale {
  int side_px = 512;
  int reference_samples = 256;  ///< a pixel, of each half
  int warm_up = 16;             ///< frames of a moving head before those measured, with a memory
  int frames = 5;               ///< measured, with a head at rest, an own seed each
  double longest_ms = 4000.0;   ///< CPU time of a frame beyond which two of them must do
};

/// Means over the measured frames, but for the times: their median.
struct TradeoffRow {
  double cpu_ms = 0.0;
  double work_per_px = 0.0;  ///< rays, or evaluations of a field, over the display's pixels
  double bytes = 0.0;        ///< of colour and depth
  double cells = 0.0;
  int frames = 0;
  struct Regions {
    CrossError f5, f10, f25, out10, out25, seen;  ///< seen: weighted by what the eye resolves
  } errors;
  double relmse = 0.0, psnr_db = 0.0, ssim = 0.0, flip = 0.0, flip_out10 = 0.0;
  double ew_psnr_db = 0.0, gp_psnr_db = 0.0;
  /// What the references' own noise does to an error over all frames, as a share of it.
  double standard_error(const CrossError& error) const;
  double flicker = 0.0;         ///< T1: RMS over time of encoded luma, the head at rest
  double rmse_estimated = 0.0;  ///< by session::spot_error; NaN on uniform grids
  Plane<Rgb8> shown;            ///< of the last frame
};

class TradeoffSetting {
 public:
  static Result<std::unique_ptr<TradeoffSetting>> create(const TradeoffKernel& kernel,
                                                         const std::string& scene,
                                                         const TradeoffScale& scale,
                                                         const PictureCache& cache,
                                                         scheduling::TileScheduler& scheduler);

  Result<TradeoffRow> measure(const FrameSettings& settings) const;
  const Plane<Rgb8>& reference_shown() const { return reference_codes_; }
  std::uint64_t scene_hash() const { return scene_hash_; }

 private:
  struct Halves {
    Plane<Rgb> first, second;  ///< linear radiance
  };
  TradeoffSetting(const TradeoffKernel& kernel, const TradeoffScale& scale, StillJob job,
                  scheduling::TileScheduler& scheduler);
  Result<Halves> make_halves(const std::string& scene, const PictureCache& cache) const;
  Result<Plane<Rgb>> path_half(const std::string& scene, std::uint64_t seed) const;
  Plane<Rgb> field_half(int finer, int samples) const;
  void take(Halves halves);
  void judge(const Plane<Rgb>& shown, TradeoffRow& row) const;
  session::SpotError estimate(const kernels::View& view, const Plane<Rgb>& shown, int k) const;

  const TradeoffKernel& kernel_;
  const TradeoffScale scale_;
  StillJob job_;
  scheduling::TileScheduler& scheduler_;
  std::uint64_t scene_hash_ = 0;
  Plane<Rgb> first_, second_, reference_;  ///< display-linear
  Plane<Rgb> reference_encoded_;
  Plane<Rgb8> reference_codes_;
  Plane<float> eccentricity_;  ///< radians
  Plane<float> weight_;
};

}  // namespace macula::bench
