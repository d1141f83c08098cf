#include "server/session/time_budget.h"

#include <algorithm>
#include <cmath>

namespace macula::session {
namespace {

// Above target x kTooSlow quality falls, below target x kTooFast it rises. Neighbouring steps
// differ in cost by at most (9/8)^2 = 1.27 (at the least scale), less than kTooSlow / kTooFast
// = 1.31: a step taken for one reason never gives the other reason at once, so a steady load
// settles.
constexpr double kTooSlow = 1.05, kTooFast = 0.80;
constexpr double kSmoothing = 0.3;
constexpr int kFramesBeforeChange = 5;  // the smoothed time has forgotten 83 % of the step before

}  // namespace

double TimeBudget::scale() const {
  return static_cast<double>(step_) / kSteps;
}

void TimeBudget::on_frame(Nanoseconds render) {
  if (!target_) return;
  const double ms = units::to_ms(render);
  smoothed_ms_ = frames_at_step_ == 0 ? ms : smoothed_ms_ + kSmoothing * (ms - smoothed_ms_);
  if (++frames_at_step_ < kFramesBeforeChange) return;
  const double load = smoothed_ms_ / units::to_ms(*target_);
  if (load >= kTooFast && load <= kTooSlow) return;

  // Cost goes with scale^2: aim at the middle of the dead band. Falling takes at least one step,
  // rising at most one, and only where the next step is predicted to fit.
  const double aim = 0.5 * (kTooSlow + kTooFast);
  const int wanted = static_cast<int>(std::floor(step_ * std::sqrt(aim / std::max(load, 1e-3))));
  const int next = load > kTooSlow ? std::min(wanted, step_ - 1) : std::min(wanted, step_ + 1);
  const int least = static_cast<int>(kLeastScale * kSteps);
  const int bounded = std::clamp(next, least, kSteps);
  if (bounded == step_) return;
  step_ = bounded;
  frames_at_step_ = 0;
}

}  // namespace macula::session
