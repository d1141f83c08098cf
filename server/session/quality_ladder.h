// A quality ladder: what one kernel can do for its time, measured. Steps are settings of a frame
// that no other settings beat in both cost and error (macula-bench tradeoff --ladders); between
// them the periphery's resolution is carried on. Quality is a number from 0, the floor, to 10, by
// the logarithm of cost. Immutable.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/kernels/knobs.h"
#include "shared/base/result.h"

namespace macula::session {

inline constexpr double kLeastQuality = 0.0, kBestQuality = 10.0;

/// As measured, means over scenes.
struct QualityStep {
  double quality = kBestQuality;
  double scale = 1.0;         ///< of the periphery's resolution, (0, 1]; view_builder.h
  kernels::KnobValues knobs;  ///< over the kernel's options
  double cost = 1.0;          ///< of a frame, over the dearest step's
  double rmse = 0.0;          ///< display-linear, as the eye weighs it; 0: not measured
};

/// A place on the ladder.
struct QualityPoint {
  double quality = kBestQuality, scale = 1.0;
  std::size_t step = 0;  ///< whose knobs are turned
  double cost = 1.0, rmse = 0.0;
};

class QualityLadder {
 public:
  /// Errors: fewer than two steps; quality, cost not rising from step to step or rmse not falling,
  /// quality not from 0 to 10, a scale outside (0, 1].
  static Result<QualityLadder> create(std::vector<QualityStep> steps);
  /// Of a kernel that nobody measured: its own settings, the periphery's resolution from 0.4 to 1,
  /// cost by the number of cells.
  static QualityLadder of_scale();

  /// `quality` is clamped to the ladder.
  QualityPoint at(double quality) const;
  /// The least quality, in tenths, whose error is at most `rmse`; the best where none is or nothing
  /// was measured.
  double quality_for_error(double rmse) const;
  std::span<const QualityStep> steps() const { return steps_; }

 private:
  explicit QualityLadder(std::vector<QualityStep> steps) : steps_(std::move(steps)) {}
  std::vector<QualityStep> steps_;
};

}  // namespace macula::session
