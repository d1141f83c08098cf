// What `macula-bench lightcuts` looks at, and how it judges: the paper's raster on a scene's first
// camera at time 0, regions around a gaze, half-references. World meters.
#pragma once

#include <memory>

#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/scene_timeline.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/tone.h"
#include "tests/bench/lightcuts.h"
#include "tests/bench/picture_cache.h"

namespace macula::bench {

using image::Plane;

/// Nodes of each pixel's cut, as numbers to draw and to take means of.
Plane<float> as_floats(const Plane<std::uint16_t>& nodes);
double mean_of(const Plane<float>& plane);

struct LightcutsSetting {
  std::shared_ptr<kernels::SceneTimeline> timeline;
  std::shared_ptr<const kernels::SceneFrame> scene;  ///< at time 0
  foveation::Display display;
  kernels::View view;
  std::size_t lights = 0;                                           ///< in the tree
  kernels::lightcuts::Gloss gloss = kernels::lightcuts::Gloss::No;  ///< of every method

  /// 720 x 850 pixels (or half of that) of equal sides, tangents of +- 1.1 across; exposure brings
  /// the mean to middle grey. NAME@CAMERA: by that
  /// camera, not the first. A name that ends in -vpl: the scene with 120,000 virtual lights, or
  /// fewer where rays meet nothing; `scheduler` must then outlive the setting.
  static Result<LightcutsSetting> make(const std::string& scene, bool half,
                                       kernels::lightcuts::Gloss gloss,
                                       scheduling::TileScheduler& scheduler);
  FoveationMap map() const;
  /// A head that sways, and what moves in the scene, to and fro: every kSwing-th frame is the one
  /// that references were made of. frame >= 0.
  Result<LightcutsSetting> moved(int frame) const;
  static constexpr int kSwing = 4;
  void look(Degrees right);
};

/// Where a pixel's surface is glossy enough for rays of its own: what errors of diffuse and of
/// glossy parts are told apart by.
Plane<std::uint8_t> glossy_pixels(const LightcutsSetting& setting,
                                  scheduling::TileScheduler& scheduler);

/// One primary ray through each pixel's centre: light alone is left to chance.
kernels::lightcuts::Config uniform_cuts(int nodes);
/// The same, smoothed along surfaces.
kernels::lightcuts::Config denoised_cuts(int nodes);
/// Cuts of perceived sizes, a walk for every node.
kernels::lightcuts::Config perceived_cuts(kernels::lightcuts::PerceptionMode mode);
/// The paper's: the same, and lights that the low-resolution picture drew.
kernels::lightcuts::Config paper_cuts();
/// Beyond it: reservoirs over both, seen by rays everywhere (exact) or smoothed.
kernels::lightcuts::Config reservoir_cuts(kernels::lightcuts::Denoise denoise);

struct Picture {
  Plane<Rgb> radiance;
  kernels::FrameReport report;
  double cpu_ms = 0.0, wall_ms = 0.0;
};
Picture picture_of(const LightcutsSetting& setting, const kernels::lightcuts::Config& config,
                   std::uint64_t seed, scheduling::TileScheduler& scheduler);
/// The next frame of a session that remembers.
Picture picture_of(const LightcutsSetting& setting, const kernels::lightcuts::Config& config,
                   std::uint64_t seed, kernels::History& history,
                   scheduling::TileScheduler& scheduler);
kernels::lightcuts::LightPlan plan_of(const LightcutsSetting& setting,
                                      const kernels::lightcuts::Config& config,
                                      scheduling::TileScheduler& scheduler);

/// Means over the pixels within 25 degrees of the gaze, outside, and within 10.
struct Regional {
  double f25 = 0.0, out25 = 0.0, f10 = 0.0;
};
struct LightcutsErrors {
  Regional mse, relmse;  ///< display-linear; over squared reference + 0.01, in radiance
  /// mse of the pixels that show matt and glossy surfaces; not a number where there are none.
  Regional diffuse, glossy;
};

class LightcutsJudge {
 public:
  /// Half-references of cuts of so many nodes, the mean of so many passes each.
  struct References {
    int nodes, passes;
    PictureCache cache;
  };
  LightcutsJudge(const LightcutsSetting& setting, const References& references,
                 scheduling::TileScheduler& scheduler);

  /// Regions lie around the setting's gaze now.
  void look(const LightcutsSetting& setting);
  LightcutsErrors errors(const Plane<Rgb>& radiance) const;
  /// Squared, display-linear, mean over the channels; with the references' noise.
  Plane<float> error_map(const Plane<Rgb>& radiance) const;
  /// What of that is the references' own.
  Plane<float> noise_map() const;
  Plane<std::uint8_t> within_f25() const;
  Regional mean(const Plane<float>& plane) const;
  double share_of_f25() const;
  Plane<Rgb> reference() const;

 private:
  /// Of the pixels that `counts(i)` lets count.
  template <class Value, class Counts>
  Regional regional(const Value& value_at, const Counts& counts) const;
  template <class Value>
  Regional regional(const Value& value_at) const {
    return regional(value_at, [](std::size_t) { return true; });
  }

  image::Tone tone_;
  Plane<Rgb> first_, second_;
  Plane<std::uint8_t> glossy_;
  Plane<float> eccentricity_;  ///< radians
};

LightcutsJudge::References references_of(const LightcutsOptions& options);

}  // namespace macula::bench
