// Settings of kernel `culling`. Paper: "Foveated Light Culling" (Computers & Graphics, 2021): the
// virtual point lights of a scene, culled by what the picture's important places receive of them.
#pragma once

#include "server/kernels/ray/config.h"
#include "server/kernels/vpl/virtual_lights.h"
#include "shared/foveation/rate.h"

namespace macula::kernels::culling {

/// How shading points are drawn from the importance map. Systematic: in proportion to it, along the
/// Morton curve. PrintedChain: the best of `chain_length` uniform draws each (section 3.3's loop as
/// it runs), which tends to the single most important places.
enum class PointDraw { Systematic, PrintedChain };

/// Whether a kept light counts for those that were culled. None: the paper's way, which loses
/// light.
enum class CullWeights { Unbiased, None };

/// What makes a light likely to be kept. Contribution: what it brings to the shading points, and
/// its flux a little. Flux: that alone; nothing is asked of the picture.
enum class KeptBy { Contribution, Flux };

/// How contributions learn what is hidden: by rays, by what lamps see around both ends (the paper's
/// BLSO), or not at all.
enum class Hiding { Rays, LampMaps, Nothing };

/// What a light's contribution is of what it brings to shading points. OfSquares: the root of the
/// mean square, which draws with the least variance: sum of f^2 / p over lights and points is least
/// for p in proportion to it. Plain: the mean, the paper's; where a light shines on few of the
/// points it is drawn too seldom for what it does there.
enum class PointMean { OfSquares, Plain };

/// Lamps: traced from them, as reflective shadow maps. Camera: where rays that bounce off the
/// places the eye looks at end; `kept` of them, none is culled (camera_lights.h; a rival, not
/// unbiased).
enum class LightSource { Lamps, Camera };

/// Culling: cells share classes of the kept lights. Cuts: every cell asks a light of every node of
/// a cut of a tree over all lights, as many as its importance says, kept / classes on average.
enum class Route { Culling, Cuts };

/// Where indirect light is asked, mode Fast: in every cell, in every `texel_step`-th each way, or
/// in a log-polar picture about the gaze, `shrink` times smaller a side.
enum class Space { Cells, Thinned, LogPolar };

struct ImportanceConfig {
  foveation::RateModel acuity{foveation::RateCurve::Culling, Degrees{8.3}, Degrees{25.0}, 0.2};
  float silhouette = 0.6F;         ///< p_g: importance of a cell at an edge, [0, 1]
  float depth_edge = 0.02F;        ///< how far off its neighbours' plane, share of the depth
  Degrees normal_edge{25.0};       ///< angle between neighbours' normals
  float color_edge = 30.0F;        ///< weighted distance of neighbours' albedo, [0, 765]
  float brightness_gain = 20.0F;   ///< delta: importance per tone-mapped indirect brightness
  float brightness_floor = 0.05F;  ///< least of it, or a black picture would stay black
};

struct Config {
  ray::Config ray;  ///< surfaces and direct light
  /// False: direct light alone, which is kernel `ray`'s picture.
  bool indirect = true;
  int map_side = 64;        ///< side^2 rays a lamp make its virtual lights; >= 1
  int most_made = 1 << 16;  ///< of all lamps that are points, spots and suns; at least one each
  /// Mode Fast, where some are culled: how far lamps' rays move from frame to frame, of the
  /// distance between them, so that what is averaged over frames has more lights than one; >= 0.
  float wander = 1.0F;
  int kept = 1024;  ///< K >= 1; no fewer lights than that: all are kept, nothing is chance
  LightSource source = LightSource::Lamps;
  Route route = Route::Culling;
  KeptBy kept_by = KeptBy::Contribution;
  CullWeights weights = CullWeights::Unbiased;
  int shading_points = 128;  ///< N_s >= 1, over all views
  PointDraw points = PointDraw::Systematic;
  int chain_length = 16;  ///< PointDraw::PrintedChain
  /// Share of the points that lie where acuity is full, [0, 1], if importance alone brings fewer
  /// there: a fovea is a small part of a wide view, and often not its brightest.
  float points_in_fovea = 0.5F;
  PointMean mean = PointMean::OfSquares;
  Hiding hiding = Hiding::Rays;
  int visibility_rays = 4;         ///< from every virtual light to shading points, each frame; >= 0
  float openness_of_point = 0.5F;  ///< lambda: share of the point's end in BLSO
  /// Share of lights kept by flux alone: one whose contribution came out as nothing may still
  /// shine, and then it counts for at most 1 / by_flux times what it would without regard.
  float by_flux = 0.3F;
  ImportanceConfig importance;
  int guide_step = 4;  ///< importance is told for every n x n-th cell; >= 1
  Space space = Space::Thinned;
  int texel_step = 2;   ///< >= 1
  double shrink = 1.8;  ///< sigma, >= 1
  /// Rings of the log-polar picture at K(x) = x^rings, > 0. 1: texels as wide as they are long
  /// everywhere; 4, printed, has them within 20 cells of the gaze, closer than cells are.
  double rings = 1.0;
  ray::VirtualShadows shadows = ray::VirtualShadows::Traced;
  /// Cells ask a class of the kept lights each; a square number >= 1.
  int classes = 4;
  /// Shadow rays of a cell, to so many lights of its class, drawn by what they would bring; 0: to
  /// all.
  int asked = 8;
  /// Distances to virtual lights count as at least this share of half the extent of them all;
  /// nearer they would leave bright blots.
  float nearest = 0.02F;
  /// Mode Exact: what that takes is brought back by a short ray. In scenes with glossy materials
  /// nothing is taken: what they add of a bounce is not what their virtual lights send.
  ray::NearLight near_light = ray::NearLight::Bounced;
  /// Mode Fast: cells on each side that share their indirect light where the surface goes on; 0:
  /// none.
  int blur_reach = 2;
  /// Mode Fast: weight of a new frame in what is remembered of indirect light, (0, 1]; 1: nothing
  /// is.
  float newest = 0.25F;
  /// Mode Fast: frames, with samples at other places of every cell, that a picture is the mean of
  /// at most; 1: of its own alone.
  int picture_frames = 8;
};

Config make_config(const KernelOptions& options);

}  // namespace macula::kernels::culling
