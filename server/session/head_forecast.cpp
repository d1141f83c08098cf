#include "server/session/head_forecast.h"

#include <algorithm>
#include <cmath>

namespace macula::session {
namespace {

math::PosePredictorOptions predictor_options(const SessionRules& rules) {
  math::PosePredictorOptions options;
  options.longest_horizon = rules.longest_horizon;
  return options;
}

}  // namespace

HeadForecast::HeadForecast(const SessionRules& rules)
    : rules_(rules), head_(predictor_options(rules)) {}

void HeadForecast::add(const net::ViewState& view) {
  head_.add(view.sampled, view.stage_from_head);
}

void HeadForecast::on_started(std::uint64_t frame, ServerTime view_received) {
  constexpr std::size_t kMost = 64;  // more than can be on their way
  started_.push_back({frame, view_received});
  if (started_.size() > kMost) started_.pop_front();
}

void HeadForecast::on_received(std::uint64_t frame, ServerTime now) {
  constexpr double kNewShare = 0.2;  // half of it is forgotten after three frames
  while (!started_.empty() && started_.front().frame <= frame) {
    if (started_.front().frame == frame) {
      const Nanoseconds sample = now - started_.front().view_received;
      const Nanoseconds known = latency_.value_or(sample);
      latency_ =
          known +
          Nanoseconds{std::llround(kNewShare * static_cast<double>((sample - known).count()))};
    }
    started_.pop_front();
  }
}

Nanoseconds HeadForecast::age(const net::ViewState& view) const {
  if (!latency_) return Nanoseconds{0};
  const Nanoseconds clients_own = view.predicted_display - view.sampled;
  return *latency_ + std::clamp(clients_own, Nanoseconds{0}, Nanoseconds{units::from_ms(50.0)});
}

Nanoseconds HeadForecast::horizon(const net::ViewState& view) const {
  return std::min(age(view), rules_.longest_horizon);
}

Pose HeadForecast::stage_from_head(const net::ViewState& view) const {
  const Nanoseconds ahead = horizon(view);
  return ahead > Nanoseconds{0} ? head_.predict(view.sampled + ahead) : view.stage_from_head;
}

Degrees HeadForecast::guard_band(const net::ViewState& view, ServerTime now) {
  if (rules_.most_guard_band.value() <= 0.0) return Degrees{0.0};
  constexpr double kStep_deg = 2.0;
  const double turn_deg = turn_deg_.raise(head_.turn_per_s().value() * units::to_s(age(view)), now);
  const double stepped = kStep_deg * std::ceil(turn_deg / kStep_deg);
  return Degrees{std::min(stepped, rules_.most_guard_band.value())};
}

double HeadForecast::view_cell_m(const net::ViewState& view, ServerTime now) {
  if (!(rules_.most_view_cell_m > 0.0) || horizon(view) <= Nanoseconds{0}) return 0.0;
  constexpr double kLeastShare = 0.2;  // a head at rest sways, and starts
  const double move_m = move_m_.raise(head_.move_per_s().value() * units::to_s(age(view)), now);
  return std::clamp(move_m, kLeastShare * rules_.most_view_cell_m, rules_.most_view_cell_m);
}

double HeadForecast::Peak::raise(double to, ServerTime now) {
  constexpr double kForget_s = 1.0;
  const double passed_s = std::max(units::to_s(now - at), 0.0);
  value = std::max(to, value * std::exp(-passed_s / kForget_s));
  at = now;
  return value;
}

}  // namespace macula::session
