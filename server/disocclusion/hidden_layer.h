// The second layer of a picture: what near surfaces hide, where the eye may come to see it before
// the next frame is there. Found by rays through the cells of the silhouette band, shaded by the
// kernel that made the picture, one sample a cell. README.md says why. World space, meters.
#pragma once

#include <cstdint>

#include "server/disocclusion/band.h"
#include "server/kernels/kernel.h"

namespace macula::disocclusion {

struct HiddenLayer {
  Band band;                    ///< 1 where the layer has something; the other planes say what
  image::Plane<Rgb> radiance;   ///< linear Rec.709; unspecified elsewhere
  image::Plane<float> depth_m;  ///< view depth, +infinity = nothing there; unspecified elsewhere
  std::size_t cells = 0;        ///< of the band
};

/// One view's rendered depth, and how far from its eye it may be shown.
struct HiddenRequest {
  const kernels::View& view;
  const image::Plane<float>& depth_m;
  double view_cell_m;  ///< > 0
  std::uint64_t frame = 0, seed = 0;
};

/// The layer of one view, into `out`, whose memory is kept. Stopped by the scheduler's token: `out`
/// is incomplete.
scheduling::Outcome trace_hidden_layer(const HiddenRequest& request, const kernels::Kernel& kernel,
                                       const kernels::SceneFrame& scene,
                                       scheduling::TileScheduler& scheduler, HiddenLayer& out);

}  // namespace macula::disocclusion
