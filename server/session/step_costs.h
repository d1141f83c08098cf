// StepCosts: how much dearer the steps of a quality ladder are here than the ladder says, against
// each other. A ladder is the mean of some scenes; on another one a step's knobs can cost several
// times as much, and whoever climbs there by the ladder alone climbs again and again. Learnt at
// every change of step, forgotten slowly, since scenes change. Pure.
#pragma once

#include <cstddef>
#include <vector>

#include "shared/units/time.h"

namespace macula::session {

class StepCosts {
 public:
  explicit StepCosts(std::size_t steps) : log_dearer_(steps, 0.0) {}

  /// Just after a change from step `from` to step `to`, frames took `ratio` times as long as those
  /// before made the ladder foretell. Above 0.
  void learn(std::size_t from, std::size_t to, double ratio, ServerTime now);
  /// What step `to` takes over what the ladder foretells of it from the frames of step `from`.
  double ratio(std::size_t from, std::size_t to, ServerTime now) const;

 private:
  double kept(ServerTime now) const;

  std::vector<double> log_dearer_;  ///< by step, when it last learnt
  ServerTime learnt_{};
};

}  // namespace macula::session
