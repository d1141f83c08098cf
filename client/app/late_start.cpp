#include "client/app/late_start.h"

#include <algorithm>
#include <cmath>

namespace macula::client_app {
namespace {

constexpr double kSpare = 1.25,
                 kForget = 0.98;   // half of a long warp is forgotten after 34 refreshes
constexpr double kTooLate = 0.25;  // of a period: the light was missed
constexpr double kWiden_ms = 2.0, kNarrow = 1e-3;  // of the margin: a miss, a refresh in time

Nanoseconds scaled(Nanoseconds time, double factor) {
  return Nanoseconds{std::llround(factor * static_cast<double>(time.count()))};
}

}  // namespace

Nanoseconds LateStart::lead() const {
  if (work_ < Nanoseconds{0}) return period_;
  return std::min(scaled(work_, kSpare) + units::from_ms(margin_ms_), period_);
}

void LateStart::note(Nanoseconds work, Nanoseconds late) {
  work_ = std::max(work, scaled(work_, kForget));
  const bool missed = late > scaled(period_, kTooLate);
  margin_ms_ += missed ? kWiden_ms : kNarrow * (kLeastMargin_ms - margin_ms_);
  margin_ms_ = std::min(margin_ms_, units::to_ms(period_));
}

}  // namespace macula::client_app
