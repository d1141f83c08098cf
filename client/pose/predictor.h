// Predictor: where the head will be when the display lights up. One thread.
#pragma once

#include "client/pose/pose_source.h"
#include "shared/math/pose_predictor.h"

namespace macula::pose {

using PredictorOptions = math::PosePredictorOptions;

class Predictor {
 public:
  explicit Predictor(const PredictorOptions& options = {}) : predictor_(options) {}

  void add(const HeadSample& sample) { predictor_.add(sample.at, sample.stage_from_head); }
  /// As math::PosePredictor.
  Pose predict(ClientTime at) const { return predictor_.predict(at); }

 private:
  math::PosePredictor predictor_;
};

}  // namespace macula::pose
