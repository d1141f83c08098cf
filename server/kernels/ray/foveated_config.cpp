#include "server/kernels/ray/foveated_config.h"

#include <limits>

namespace macula::kernels::ray {

FoveatedConfig paper_literal() {
  FoveatedConfig config;
  config.method = Method::Foveated;
  config.color_age = {0.1F, 0.9F, 8};
  config.mask = MaskKind::Independent;
  config.warp = WarpKind::Mesh;
  config.filter = HistoryFilter::NormalTaps;
  config.resampling = ResamplingRule::Neighbours;
  config.grazing = GrazingRule::CameraAxis;
  config.weight = WeightRule::AtMostLimit;
  config.fresh = FreshRule::Replace;
  config.age = AgeRule::AllFrames;
  config.clipping = Clipping::Off;
  config.most_resampled = 1.0F;
  config.turn_threshold = std::numeric_limits<float>::infinity();
  return config;
}

}  // namespace macula::kernels::ray
