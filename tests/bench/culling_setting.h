// What `macula-bench culling` looks at: a scene under one lamp of its own, square pictures of 90
// degrees from a still eye that looks ahead, and what moves. World meters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/kernels/culling/culling_kernel.h"
#include "server/kernels/culling/keep_lights.h"
#include "server/kernels/scene_timeline.h"
#include "tests/bench/ray_quality.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {

/// The lamp, a red ball, both or neither go round in circles.
enum class SceneMotion { Still, Light, Object, Both };
/// static, light, object, both.
Result<SceneMotion> find_motion(const std::string& name);

class CullingSetting {
 public:
  /// Every surface diffuse, in its base colour.
  static Result<CullingSetting> create(const std::string& scene, SceneMotion motion, int side_px);

  static constexpr double kRate_hz = 30.0;
  /// 150 of 1024 pixels.
  static Degrees fovea();

  /// The scene in frame `frame` of its motion.
  Result<std::shared_ptr<const kernels::SceneFrame>> frame(int frame) const;
  const kernels::View& view() const { return view_; }
  const FoveationMap& map() const { return *map_; }
  const foveation::Display& display() const { return display_; }
  const scene::Scene& scene() const { return timeline_->scene(); }
  void set_exposure(float ev) { view_.tone.exposure_ev = ev; }

 private:
  std::shared_ptr<kernels::SceneTimeline> timeline_;
  foveation::Display display_;
  kernels::View view_;
  std::shared_ptr<const FoveationMap> map_;
};

/// Two independent pictures of paths of one bounce, `samples` of them a pixel each, of frame
/// `frame`.
Result<HalfReferences> path_references(const CullingSetting& setting, const std::string& name,
                                       int frame, int samples, const PictureCache& cache,
                                       scheduling::TileScheduler& scheduler);

/// Errors inside and outside of the fovea, of exposed light that a display clips at 1.
struct FoveaErrors {
  CrossError inside, outside;
  double ratio() const { return outside.rmse() / inside.rmse(); }
};

class CullingJudge {
 public:
  CullingJudge(const CullingSetting& setting, HalfReferences references);

  /// Over the listed pixels; none: over all.
  FoveaErrors errors(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels = {}) const;
  /// How alike another picture is to a third, noise and all.
  FoveaErrors difference(const Plane<Rgb>& a, const Plane<Rgb>& b,
                         std::span<const image::Pixel> pixels) const;
  Plane<Rgb> reference() const;

 private:
  bool inside(const image::Pixel& pixel) const;
  Rgb shown(const Rgb& radiance) const;

  const CullingSetting& setting_;
  HalfReferences references_;
};

/// Blocks of 4 x 4 pixels, every fourth each way: a sixteenth of the picture, in the order of
/// tiles.
std::vector<image::Pixel> sample_of_blocks(const foveation::Display& display);

/// Mean luminance of the listed pixels, of all if none are.
double mean_luminance(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels = {});

}  // namespace macula::bench
