// Settings of kernel `sphere`. Paper: Polychronakis, Koulieris, Mania, "An Inverted Pyramid
// Acceleration Structure Guiding Foveated Sphere Tracing for Implicit Surfaces in VR" (2023).
#pragma once

#include "server/kernels/options.h"
#include "server/shading/material_table.h"
#include "shared/units/angle.h"

namespace macula::kernels::sphere {

/// How eye rays find their surface. PaperPyramid is for pictures without foveation.
enum class Tracing {
  Full,          ///< plain sphere tracing from the eye, the whole expression
  FullBest,      ///< from the eye, relaxed steps and pruned expression
  PaperPyramid,  ///< the paper's three levels and minimum filter; may miss thin things
  Pyramid,       ///< cones with a proven free distance, then as FullBest: the hits of Full
};

/// Whether every cell is traced, or important ones only and the others from the middle level.
enum class Foveation { Off, On };

/// Which discontinuities of the low level count as edges; depth always does.
enum class EdgeSource { Depth, Albedo, Shaded };

/// Literal: section 3.2.3 as printed but for the sign in its Eq. 1: Sobel filter on marched
/// distances, acuity times edge also inside the fovea, independent random thresholds.
enum class MaskRule { Corrected, Literal };

/// Where the acuity's exponential starts: at the gaze as printed, or at the rim of the fovea, which
/// leaves no jump there.
enum class AcuityOrigin { Gaze, FoveaRim };

/// How often an unimportant block of the middle level is traced anew.
enum class Refresh { EveryFrame, EverySecond, EveryFourth };

/// What stands in the frames between: the last one warped to where it is now and traced where that
/// fails, or the same place of the last picture (the paper's way).
enum class Kept { Reprojected, InPlace };

/// What is done where important and unimportant cells meet.
enum class Transition { Hard, Gaussian };

/// Whether lights are hidden by what stands between, as the field says. Soft: a light of an angular
/// radius hides gradually, by how close its ray passes what it misses (an approximation).
enum class Shadows { None, Hard, Soft };

/// How much of the sky a point sees. None: the sky lights nothing. All: no ambient occlusion. Near:
/// from the distances found at a few steps along the normal (an approximation). Traced: by
/// `sky_samples` rays.
enum class SkyLight { None, All, Near, Traced };

struct LightingConfig {
  Shadows shadows = Shadows::None;
  Degrees light_radius{1.0};  ///< Shadows::Soft
  SkyLight sky = SkyLight::All;
  int sky_samples = 4;      ///< SkyLight::Traced, >= 1
  double near_sky_m = 0.5;  ///< SkyLight::Near: what lies farther away does not count, > 0
};

struct EdgeThresholds {
  float inverse_depth = 0.05F;  ///< second difference of 1/z times z
  float luminance = 0.15F;      ///< step of albedo or of tone-mapped luminance, [0, 1]
  float sobel_m = 0.5F;         ///< MaskRule::Literal: Sobel magnitude of marched distance
};

struct MaskConfig {
  MaskRule rule = MaskRule::Corrected;
  AcuityOrigin origin = AcuityOrigin::FoveaRim;
  Degrees fovea{7.5};       ///< everything within is important; the paper's accepted value
  Degrees outer{15.0};      ///< nothing beyond is important
  float flat_share = 0.1F;  ///< of an edge's probability that a cell without an edge has
  EdgeSource edges = EdgeSource::Depth;
  EdgeThresholds thresholds;
};

/// Samples a cell may have.
inline constexpr int kMostSamples = 16;

/// Samples of a block of the middle level beside `samples` of a cell: a sixteenth of the block's
/// own at full level, at least one. With 16 a cell, every cell of a block is looked at once.
constexpr int block_samples_for(int samples) {
  return samples < 8 ? 1 : samples < 16 ? 2 : 4;
}

struct Config {
  Mode mode = Mode::Fast;
  Tracing tracing = Tracing::Pyramid;
  Foveation foveation = Foveation::On;
  int samples_per_cell = 1;  ///< of an important cell, 1..kMostSamples
  MaskConfig mask;
  int block_samples = 1;  ///< of a 2 x 2 block of the middle level, 1..kMostSamples
  /// Step of lightness from a block to one beside it, [0, 1], beyond which all their cells are
  /// traced, with `block_samples` each; +infinity: none are.
  float detail = 0.1F;
  Refresh refresh = Refresh::EveryFrame;
  Kept kept = Kept::Reprojected;
  Transition transition = Transition::Hard;
  LightingConfig lighting;
  shading::MaterialModel materials = shading::MaterialModel::AsInScene;
};

}  // namespace macula::kernels::sphere
