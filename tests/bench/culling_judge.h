// Where and by what `macula-bench culling` judges pictures: a few pixels, each lit by very many
// paths, so that what is measured is the method's error and not the reference's. Pure.
#pragma once

#include <span>
#include <vector>

#include "tests/bench/culling_setting.h"
#include "tests/bench/ray_quality.h"

namespace macula::bench {

/// Drawn by chance without regard to any picture, as many inside the fovea as outside; all of them
/// middles of a thinned eye's cells.
struct JudgedPixels {
  std::vector<image::Pixel> pixels;  ///< those inside first
  std::size_t inside = 0;
  double inside_share = 0.0;  ///< of the whole picture that lies inside

  bool is_inside(std::size_t i) const { return i < inside; }
  /// How much of a picture's mean a pixel stands for; they sum up to 1.
  double share(std::size_t i) const;
};
/// `each` of them in either region, or as many as there are.
JudgedPixels judged_pixels(const CullingSetting& setting, int each);

/// One row: the listed pixels of a picture of the eye, or of a thinned one.
Plane<Rgb> listed(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels);
Plane<Rgb> listed_of_thinned(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels);

/// Two independent rows of what paths of one bounce bring to the pixels, `samples` of them each, in
/// frame `frame`.
Result<HalfReferences> path_references(const CullingSetting& setting, const JudgedPixels& judged,
                                       int frame, int samples, const PictureCache& cache,
                                       scheduling::TileScheduler& scheduler);

/// Errors inside and outside of the fovea, of exposed light that a display clips at 1.
struct FoveaErrors {
  CrossError inside, outside;
  double inside_spread = 0.0;  ///< standard error of inside.sum / inside.weight, for all reasons

  double ratio() const { return outside.rmse() / inside.rmse(); }
  /// Of inside.rmse(), as a share of it: pixels that were not judged, and the references' noise.
  double relative_standard_error() const;
};

/// Rows are listed() ones.
class CullingJudge {
 public:
  CullingJudge(JudgedPixels judged, HalfReferences references);

  FoveaErrors errors(const Plane<Rgb>& row) const;
  /// How alike two rows are, noise and all.
  FoveaErrors difference(const Plane<Rgb>& a, const Plane<Rgb>& b) const;
  /// Of the whole picture, as far as the judged pixels tell.
  double mean_luminance(const Plane<Rgb>& row) const;
  double reference_luminance() const;
  /// The eye is still. Nothing moves: what changes over time. Else: how much more pictures change
  /// from frame to frame than those under every light do. RMS of display-encoded luma.
  double flicker(std::span<const Plane<Rgb>> rows, std::span<const Plane<Rgb>> steady,
                 SceneMotion motion) const;
  /// Exposed so that the reference's mean luminance is middle grey, 0.18.
  const image::Tone& tone() const { return tone_; }

 private:
  Rgb shown(const Rgb& radiance) const;
  double region_flicker(std::span<const Plane<Rgb>> rows, std::span<const Plane<Rgb>> steady,
                        SceneMotion motion, std::size_t begin, std::size_t end) const;

  JudgedPixels judged_;
  HalfReferences references_;
  image::Tone tone_;
};

}  // namespace macula::bench
