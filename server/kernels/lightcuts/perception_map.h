// The perception map (the paper's FPSM): for every pixel, how many light samples it deserves, in
// [0, 1]. Made of features in [0, 1] that say how much the eye would see of an error there: acuity,
// edges of normals, albedo and velocity (FSFM), and the fine contrast of a low-resolution picture
// (FLFM). Pure; no normalisation over the frame but in mode Printed, so that one bright pixel
// changes its neighbourhood alone.
// Source: Shi et al., "Foveated Stochastic Lightcuts", sections 4 and 5, as corrected: README.md.
#pragma once

#include <cstdint>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::kernels::lightcuts {

using image::Plane;

/// How a feature M becomes a share of samples; alpha is the error that may go unseen.
enum class PerceptionMode {
  /// Eq. 6 to 8 with what keeps them numbers: M - alpha clamped to [1e-3, 1 - 1e-3], the widest
  /// Gaussian where M <= alpha, M itself in a frame where all Gaussians are equally wide. Depends
  /// on the whole frame and gives flat regions more than edges: for comparison only.
  Printed,
  Difference,   ///< (M - alpha) / (1 - alpha)
  Attenuation,  ///< Eq. 4 read as the text means it: the widest Gaussian that takes alpha off M
  Stengel,      ///< M: adaptive sampling without alpha (Stengel et al. 2016)
};

struct PerceptionConfig {
  PerceptionMode mode = PerceptionMode::Attenuation;
  float alpha = 0.05F;    ///< not NaN; <= 0: full rate wherever M > 0; >= 1: none
  float gamma = 1.0F;     ///< > 0; Attenuation: 1 is Eq. 4 alone, more favours what is seen best
  float contrast = 0.2F;  ///< what a full edge counts for against full acuity, [0, 1]
};

/// Planes of one view. What is not a finite number counts as 0. An empty plane is left out; all
/// others but `luminance` have the size of `acuity`.
struct PerceptionInputs {
  const Plane<float>& acuity;     ///< of the eye, [0, 1]
  const Plane<Vec3>& normal;      ///< unit, world; 0 where nothing was hit
  const Plane<Rgb>& albedo;       ///< [0, 1]
  const Plane<float>& speed;      ///< of the surface on the eye's retina, degrees a second
  const Plane<float>& luminance;  ///< linear, of a picture of any size of the same view
};

struct PerceptionMap {
  Plane<float> spatial;          ///< FSFM with acuity in it, [0, 1]
  Plane<float> luminance;        ///< FLFM with acuity in it, [0, 1]
  Plane<float> map;              ///< [0, 1]
  std::uint64_t not_finite = 0;  ///< values of the inputs that were taken as 0
};
PerceptionMap make_perception_map(const PerceptionInputs& inputs, const PerceptionConfig& config);

/// The same in two steps, so that the second can go over parts of a picture: the contrast of the
/// whole, and the map of inputs that have the picture's rows from `first` on. Its first and last
/// rows are right only where they are the picture's. Printed takes the whole. `luminance` is not
/// read.
struct SeenContrast {
  Plane<float> contrast;         ///< [0, 1], of the map's size; empty: none
  std::uint64_t not_finite = 0;  ///< as in PerceptionMap
};
SeenContrast see_contrast(const Plane<float>& luminance, int width, int height);
PerceptionMap make_perception_map(const PerceptionInputs& inputs, const SeenContrast& seen,
                                  int first, const PerceptionConfig& config);

/// Share of samples for one feature value by any mode but Printed; never falls in M, never rises in
/// alpha.
float share_of_samples(float feature, const PerceptionConfig& config);

/// Of cuts: 1 <= least <= most.
struct NodeRange {
  int most, least = 1;
};
/// Nodes of each pixel's cut, round(scale x most x map) in that range. The scale is the one that
/// brings their mean nearest to `mean_wanted` in it, or 1 for 0: modes are comparable at equal
/// means only. A map of zeros stays at `least` a pixel.
struct NodeCounts {
  Plane<std::uint16_t> nodes;
  double scale = 1.0, mean = 0.0;
};
NodeCounts node_counts(const Plane<float>& map, const NodeRange& range, double mean_wanted = 0.0);

}  // namespace macula::kernels::lightcuts
