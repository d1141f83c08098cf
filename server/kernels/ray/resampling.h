// Resampling info (section 3.3): how urgently every quad of support samples should be traced anew,
// because what is remembered there contradicts what the samples see, or what a glossy surface shows
// the eye from elsewhere. Pure.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/glossy_turn.h"
#include "server/kernels/ray/support.h"

namespace macula::kernels::ray {

/// Whether this frame's view or scene differs from the last one's.
enum class Motion { Still, Moving };

/// Display luminance of the support cells.
struct SupportLuminance {
  Plane<float> remembered;  ///< negative where nothing was
  Plane<float> fresh;       ///< 0 there
};

struct ResamplingJob {
  const View& view;
  const Support& support;
  const FreshSamples& fresh;  ///< the support cells' samples
  const Cache& remembered;    ///< reprojected; support cells are up to date
  const SupportLuminance& luminance;
  const FoveatedConfig& config;
  Motion motion = Motion::Moving;
  GlossyPast glossy{};
};

/// Of Support::broken's size: 0 where nothing calls for it; 1 where a threshold is just met, higher
/// the more it is exceeded.
Plane<float> resampling_scores(const ResamplingJob& job);

/// Display luminance of a radiance in [0, 1], about as the eye sees differences.
float display_luminance(const image::Tone& tone, const Rgb& radiance);

}  // namespace macula::kernels::ray
