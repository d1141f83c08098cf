// Flicker: error that changes with time, which a static comparison cannot see and the periphery
// sees best. For a still view: RMS over time of test - reference after its temporal mean is
// removed. For a moving one: how much more a frame differs from its warped predecessor than the
// reference does. Values are display-encoded luma in [0, 1]; results are in the same unit, 0 =
// steady. A FlickerMeter belongs to one thread.
#pragma once

#include <vector>

#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// Running mean and squared deviation per pixel (Welford 1962), so no frame need be kept.
class TemporalDeviation {
 public:
  /// Every plane has the size of the first.
  void add(const Plane<float>& values);
  int count() const { return count_; }
  /// Mean over pixels of the population variance over time; 0 before the first frame.
  double mean_variance() const;

 private:
  int count_ = 0;
  Plane<double> mean_, squares_;
};

/// Pose, gaze and scene are still; whatever changes is the renderer's noise.
class FlickerMeter {
 public:
  /// `bands` octaves of spatial frequency are reported besides the whole, finest first, then the
  /// rest. No fall-off with eccentricity is applied: slow patterns flicker most visibly outside the
  /// fovea.
  explicit FlickerMeter(int bands = 5);

  void add(const Plane<float>& reference, const Plane<float>& test);
  /// RMS over pixels and frames.
  double rms() const;
  /// The same for each band of the difference; bands() + 1 values.
  std::vector<double> rms_per_band() const;

 private:
  int bands_;
  TemporalDeviation whole_;
  std::vector<TemporalDeviation> per_band_;
};

/// One step of a moving view: this frame and the last one warped to this view, of test and
/// reference.
struct WarpedStep {
  const Plane<float>& test;
  const Plane<float>& warped_last_test;
  const Plane<float>& reference;
  const Plane<float>& warped_last_reference;
};
/// RMS of (T - W T') - (R - W R') over the pixels where `visible_before` is not 0; 0 if there is
/// none.
double warped_flicker_rms(const WarpedStep& step, const Plane<unsigned char>& visible_before);

}  // namespace macula::metrics
