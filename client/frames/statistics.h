// Series: numbers of a run and their quantiles. Ages: how old what is on the display was when it
// lit up. One thread.
#pragma once

#include <cstddef>
#include <vector>

#include "shared/net/messages.h"
#include "shared/units/time.h"

namespace macula::frames {

class Series {
 public:
  void add(double value) { values_.push_back(value); }
  std::size_t count() const { return values_.size(); }
  /// Linear between neighbours: quantile(0) the least, quantile(1) the largest; 0 when empty.
  double quantile(double q) const;
  double mean() const;     ///< 0 when empty
  double largest() const;  ///< 0 when empty

 private:
  std::vector<double> values_;
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
