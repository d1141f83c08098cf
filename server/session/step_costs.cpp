#include "server/session/step_costs.h"

#include <cmath>

namespace macula::session {
namespace {

/// In which what was learnt fades to a third; then a step is tried again.
constexpr double kFades_s = 120.0;
/// Ladders err by so much between any two places; only more is a step's own.
constexpr double kErrs = 1.6;

}  // namespace

double StepCosts::kept(ServerTime now) const {
  return std::exp(-units::to_s(now - learnt_) / kFades_s);
}

void StepCosts::learn(std::size_t from, std::size_t to, double ratio, ServerTime now) {
  const double share = kept(now);
  for (double& log : log_dearer_) log *= share;
  const bool is_own = ratio > kErrs || ratio * kErrs < 1.0;
  log_dearer_[to] = log_dearer_[from] + (is_own ? std::log(ratio) : 0.0);
  learnt_ = now;
}

double StepCosts::ratio(std::size_t from, std::size_t to, ServerTime now) const {
  return std::exp((log_dearer_[to] - log_dearer_[from]) * kept(now));
}

}  // namespace macula::session
