#include "client/pose/prediction_doubt.h"

#include <algorithm>

namespace macula::pose {
namespace {

constexpr Nanoseconds kSpan = std::chrono::seconds{1};
constexpr std::size_t kMostPending = 64;

/// The head at a time between two readings.
Pose between(const HeadSample& before, const HeadSample& after, ClientTime at) {
  const double whole = units::to_s(after.at - before.at);
  const double share = whole > 0.0 ? units::to_s(at - before.at) / whole : 1.0;
  return {glm::mix(before.stage_from_head.position, after.stage_from_head.position, share),
          glm::slerp(before.stage_from_head.rotation, after.stage_from_head.rotation, share)};
}

}  // namespace

void PredictionDoubt::foretold(ClientTime display, const Pose& stage_from_head) {
  if (!pending_.empty() && display <= pending_.back().display) pending_.clear();
  pending_.push_back({display, stage_from_head});
  if (pending_.size() > kMostPending) pending_.pop_front();
}

void PredictionDoubt::add(const HeadSample& sample) {
  if (!last_.empty() && sample.at <= last_.back().at) {  // time began anew
    pending_.clear();
    misses_.clear();
    last_.clear();
  }
  for (; !pending_.empty() && pending_.front().display <= sample.at; pending_.pop_front()) {
    const Foretold& foretold = pending_.front();
    if (last_.empty() || foretold.display < last_.back().at) continue;
    const Pose there = between(last_.back(), sample, foretold.display);
    misses_.push_back({foretold.display, glm::distance(there.position, foretold.pose.position),
                       math::angle_between(there, foretold.pose)});
  }
  while (!misses_.empty() && sample.at - misses_.front().at > kSpan) misses_.pop_front();
  last_.assign(1, sample);
}

double PredictionDoubt::position_m() const {
  double most = 0.0;
  for (const Miss& miss : misses_) most = std::max(most, miss.position_m);
  return most;
}

Radians PredictionDoubt::turn() const {
  double most = 0.0;
  for (const Miss& miss : misses_) most = std::max(most, miss.turn.value());
  return Radians{most};
}

}  // namespace macula::pose
