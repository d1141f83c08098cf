// Settings of the foveated method of kernel `ray`. Paper: Weier, Roth, Kruijff, Hinkenjann,
// Perard-Gayot, Slusallek, Li, "Foveated Real-Time Ray Tracing for Head-Mounted Displays" (2016).
// How densely an eccentricity is sampled is not said here: it is the frame's rate model, of which
// `ray-small`, `ray-medium`, `ray-large` and `ray-full` are the paper's.
#pragma once

namespace macula::kernels::ray {

/// Full: every cell, every frame. Foveated: some cells, the others from what earlier frames saw.
enum class Method { Full, Foveated };

/// Thresholds of section 3.1: blue noise moved by the golden ratio, or independent draws (printed).
enum class MaskKind { BlueNoise, Independent };

/// Between four support samples: what the earlier picture shows where they and its own depth agree;
/// or whatever a mesh through them shows, rubber sheets included (printed, section 3.2).
enum class WarpKind { Verified, Mesh };

/// How the earlier picture is read: bicubic, bilinear, or four normally distributed taps of half a
/// cell (printed, section 3.2).
enum class HistoryFilter { Bicubic, Bilinear, NormalTaps };

/// What deserves resampling, section 3.3: where the support samples contradict what is remembered,
/// or wherever neighbours differ (printed).
enum class ResamplingRule { Contradiction, Neighbours };

/// Cosine that tells grazing surfaces: with the cell's own ray, or with the camera's axis and the
/// printed sign, under which every visible surface is grazing.
enum class GrazingRule { OwnRay, CameraAxis };

/// Weight of a new sample: the larger of running mean and limit, or the smaller (printed).
enum class WeightRule { AtLeastLimit, AtMostLimit };

/// New samples of the fovea and of resampled cells join what is remembered, or replace it
/// (printed).
enum class FreshRule { Blend, Replace };

/// What counts as age: frames in which something moved, or every frame (printed).
enum class AgeRule { FramesInMotion, AllFrames };

/// Whether what is remembered is held within the colours that new neighbours have.
enum class Clipping { On, Off };

/// Whether resampled cells take the light of their nearest others, section 3.5.
enum class PostFilter { Off, On };

/// Limits of a new sample's weight by the age of what it meets, section 3.4.
struct AgeLimits {
  float least = 0.1F;  ///< k_min, in (0, most]
  float most = 0.5F;   ///< k_max, in [least, 1]
  int full_age = 16;   ///< t_max in frames: from this age on the weight is `most`
};

struct FoveatedConfig {
  Method method = Method::Full;
  float support_spacing = 4.61F;  ///< cells between support samples, >= 1; 256 x 318 of 1182 x 1464
  float depth_threshold = 0.02F;  ///< eps_depth: second difference of 1/z times z
  float luminance_threshold = 0.1F;  ///< eps_lum: of display luminance, [0, 1]
  float grazing_threshold = 0.1F;    ///< cosine
  /// Of the eye around a glossy point, in widths of its lobe (alpha, as an angle); above 0. At half
  /// a width the half vector has turned by a quarter: a highlight's middle has lost 11 %.
  float turn_threshold = 0.5F;
  float merge_threshold = 0.02F;  ///< of depth, beyond which memory is not believed
  AgeLimits color_age;
  AgeLimits light_age{0.05F, 0.5F, 16};  ///< of light that is estimated by chance
  float fovea_weight = 0.2F;             ///< least weight where every cell is traced, (0, 1]
  float clip_fovea = 1.0F, clip_outside = 2.0F;  ///< standard deviations
  float most_resampled = 0.27F;                  ///< share of a frame's primary rays, [0, 1)
  /// Share of a view's cells that may be traced, (0, 1]: probabilities below 1 are scaled from
  /// frame to frame until it is met. 1: as many as the rate model asks.
  float ray_budget = 1.0F;
  int post_probes = 8;  ///< n of section 3.5

  MaskKind mask = MaskKind::BlueNoise;
  WarpKind warp = WarpKind::Verified;
  HistoryFilter filter = HistoryFilter::Bicubic;
  ResamplingRule resampling = ResamplingRule::Contradiction;
  GrazingRule grazing = GrazingRule::OwnRay;
  WeightRule weight = WeightRule::AtLeastLimit;
  FreshRule fresh = FreshRule::Blend;
  AgeRule age = AgeRule::FramesInMotion;
  Clipping clipping = Clipping::On;
  PostFilter post_filter = PostFilter::Off;
};

/// Every form as the paper prints it, with its defaults where it gives any.
FoveatedConfig paper_literal();

}  // namespace macula::kernels::ray
