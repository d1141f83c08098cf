// Series: numbers of a run and their quantiles, in bounded memory. Ages: how old what is on the
// display was when it lit up. One thread.
#pragma once

#include <cstddef>
#include <vector>

#include "shared/net/messages.h"
#include "shared/units/time.h"

namespace macula::frames {

/// Count, mean, least and largest are of all values. Quantiles are exact up to kMost values and
/// then of as many drawn uniformly from all (Vitter, "Random sampling with a reservoir", 1985,
/// Algorithm R): one of n = kMost lies within sqrt(q (1 - q) / n) of its rank, 0.2 % at the median.
class Series {
 public:
  static constexpr std::size_t kMost = 65536;

  void add(double value);
  std::size_t count() const { return count_; }
  /// Linear between neighbours: quantile(0) the least, quantile(1) the largest; 0 when empty.
  double quantile(double q) const;
  double mean() const;                         ///< 0 when empty
  double largest() const { return largest_; }  ///< 0 when empty

 private:
  std::size_t count_ = 0;
  double sum_ = 0.0, least_ = 0.0, largest_ = 0.0;
  std::vector<double> values_;  ///< all, or a uniform sample of them
};

struct Ages {
  Series pose_ms;  ///< shown - when the head pose behind the frame was sampled
  Series gaze_ms;  ///< shown - when the gaze behind the frame was sampled

  void add(ClientTime shown, const net::FrameBegin& begin) {
    pose_ms.add(units::to_ms(shown - begin.view_sampled));
    gaze_ms.add(units::to_ms(shown - begin.gaze_sampled));
  }
};

}  // namespace macula::frames
