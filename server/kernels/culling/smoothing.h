// What stands between a noisy picture of indirect light and a calm one: neighbours on the same
// surface share their light (section 3.5's Gaussian, kept off edges), and what earlier frames saw
// there is remembered within the range of what is seen now (its anti-aliasing over time). Mode Fast
// only.
#pragma once

#include <optional>
#include <vector>

#include "server/kernels/culling/config.h"
#include "server/kernels/kernel.h"
#include "server/reconstruction/picture_memory.h"

namespace macula::kernels::culling {

using image::Plane;

/// One view's last frame.
struct ViewMemory {
  Pose world_from_view;
  PixelGrid grid;
  Plane<float> depth_m;
  Plane<Vec3> normal;
  Plane<Rgb> light;     ///< per unit of reflectance, calmed
  Plane<float> frames;  ///< that each cell's light is the mean of, >= 1
};

/// Mean light of the cells within `reach` that lie on a cell's surface; those at the rim count
/// half, so that each class of 2 reach x 2 reach cells counts once. Reads view.light, .normal and
/// .depth_m.
Plane<Rgb> shared_light(const View& view, const ViewBuffers& buffers, int reach,
                        TileScheduler& scheduler);

/// Light of a frame, and of how many frames it is the mean.
struct LightOverFrames {
  Plane<Rgb> light;
  Plane<float> frames;
};

/// Adds what `then` remembers of every cell where the same surface was seen, held to the range of
/// the cells around, a window of clamp_window(eccentricity): the mean of all frames that it knows,
/// until one of them would count for less than `newest`; each new one counts for that much from
/// then on. What `movers` tells to have moved is found where it was.
LightOverFrames remembered(const View& view, const ViewBuffers& buffers, const ViewMemory& then,
                           const reconstruction::Movers& movers, float newest,
                           TileScheduler& scheduler, const Plane<Rgb>& now);

/// Cells a side, odd, 3 to 9: eta = clamp(3 + 2 floor((q - 0.10) / 0.05), 3, 9) (section 3.5), q
/// the eccentricity over the largest in the view.
int clamp_window(float q);

}  // namespace macula::kernels::culling
