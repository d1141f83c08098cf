// Light of the placed lights at the points of a tile by one light of every node of their cuts, each
// found by a walk of its own or taken from the low-resolution picture's. World, meters. A point's
// light depends on itself alone: any threads and tiles give the same bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/lightcuts/light_stream.h"
#include "server/kernels/lightcuts/low_samples.h"
#include "server/kernels/lightcuts/surfaces.h"

namespace macula::kernels::lightcuts {

using image::Plane;

/// The low-resolution picture of one view: the lights that each of its pixels drew.
struct LowPicture {
  int factor = 8;  ///< cells of the grid along a side of one of its pixels
  int width = 0, height = 0;
  std::vector<LowSamples> pixels;  ///< by rows; no samples where nothing was hit
  std::vector<bool> hit;
};

/// How many nodes, and how often a light may come from the low-resolution picture.
struct CutPlan {
  const Plane<std::uint16_t>& nodes;  ///< of each cell's cut, >= 1
  int most_nodes = 1;
  const Plane<float>* map = nullptr;  ///< taken with probability 1 - map; with `low`
  const LowPicture* low = nullptr;    ///< none: walks only
  /// Yes: glossy points have rays of their own (gloss.h); lights that these meet do without the
  /// points' lobes, or without a part of them.
  Gloss gloss = Gloss::No;
  float lamp_area_m2 = 0.0F;  ///< of a lamp's triangle, as lamp_area() has it; with gloss
  /// Whether all light is joined with its neighbours' and the last frames' by the denoiser, which
  /// cannot average away what these err alike: then large cuts take nothing from low pixels, and
  /// small ones nothing from the last frame's reservoirs.
  bool smoothed = false;
};

struct CutWork {
  ray::LightingWork lighting;
  std::uint64_t walked = 0, taken = 0;  ///< nodes
};

/// Adds the light that arrives to slots[i] for the tile's point i; slots.size() == points.count.
void add_cut_light(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
                   CutWork& work, std::span<Rgb> slots);

/// Draws the samples of every pixel of a low-resolution picture, `nodes` nodes a cut and those that
/// are dark there, and sees what they bring. `view`: the surfaces' number.
FrameReport draw_low_picture(const SceneFrame& scene, const ViewSurfaces& surfaces,
                             std::size_t view, int nodes, TileScheduler& scheduler,
                             LowPicture& picture);

}  // namespace macula::kernels::lightcuts
