// PredictionDoubt: how well poses at display time are known, judged by how those foretold before
// turned out. One thread.
#pragma once

#include <deque>

#include "client/pose/pose_source.h"

namespace macula::pose {

class PredictionDoubt {
 public:
  /// What was shown for the head at `display`.
  void foretold(ClientTime display, const Pose& stage_from_head);
  /// A head as it was read, in rising time.
  void add(const HeadSample& sample);

  /// The worst of the last second of foretold poses that have come to pass; 0 before any has.
  double position_m() const;
  Radians turn() const;

 private:
  struct Foretold {
    ClientTime display{};
    Pose pose;
  };
  struct Miss {
    ClientTime at{};
    double position_m = 0.0;
    Radians turn{0.0};
  };
  std::deque<Foretold> pending_;
  std::deque<Miss> misses_;
  std::deque<HeadSample> last_;  ///< at most one
};

}  // namespace macula::pose
