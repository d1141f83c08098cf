#include "tests/bench/recorded_head.h"

#include <algorithm>
#include <cmath>

#include "client/pose/predictor.h"

namespace macula::bench {

std::vector<double> RecordedHead::moments(int count) const {
  const double length_s = std::min(10.0, units::to_s(trace_.duration()) - 1.0);
  const double begin_s = most_vigorous(length_s);
  std::vector<double> moments;
  for (int i = 0; i < count; ++i) {
    moments.push_back(begin_s + 0.5 + (length_s - 0.5) * i / count);
  }
  return moments;
}

Pose RecordedHead::predicted(double known_s, double asked_s) const {
  pose::Predictor predictor;
  constexpr int kSamples = 8;  // more than its window
  for (int i = kSamples; i >= 0; --i) {
    pose::HeadSample sample = raw(known_s - i / kHeadSamplesPerSecond);
    sample.at = ClientTime{units::from_s(known_s - i / kHeadSamplesPerSecond)};
    predictor.add(sample);
  }
  return predictor.predict(ClientTime{units::from_s(asked_s)});
}

Pose RecordedHead::stage_from_trace(double now_s) const {
  const Pose now = at(now_s);
  const auto heading = [](const DQuat& rotation) {
    const DVec3 ahead = rotation * DVec3{0, 0, -1};
    return std::atan2(ahead.x, -ahead.z);
  };
  const double turn = heading(now.rotation) - heading(camera_.rotation);
  const DQuat level = glm::angleAxis(turn, DVec3{0, 1, 0});
  return {camera_.position - level * now.position, level};
}

double RecordedHead::most_vigorous(double length_s) const {
  double best_s = 0.5, most = -1.0;
  for (double begin = 0.5; begin + length_s <= units::to_s(trace_.duration()); begin += 1.0) {
    double turned = 0.0;
    for (double t = begin; t < begin + length_s; t += 0.1) {
      turned += math::angle_between(at(t), at(t + 0.1)).value();
    }
    if (turned > most) most = turned, best_s = begin;
  }
  return best_s;
}

}  // namespace macula::bench
