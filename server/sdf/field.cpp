#include "server/sdf/field.h"

#include <algorithm>
#include <cmath>

#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Into [first, last) for tracks that repeat.
double wrapped(double time_s, double first, double last) {
  const double length = last - first;
  if (!(length > 0.0)) return first;
  const double phase = std::fmod(time_s - first, length);
  return first + (phase < 0.0 ? phase + length : phase);
}

}  // namespace

DVec3 Track::at(double time_s) const {
  MACULA_CHECK(!times_s.empty() && times_s.size() == values.size());
  const double t = loops ? wrapped(time_s, times_s.front(), times_s.back()) : time_s;
  if (t <= times_s.front()) return values.front();
  if (t >= times_s.back()) return values.back();
  const auto after = std::upper_bound(times_s.begin(), times_s.end(), t);
  const std::size_t i = static_cast<std::size_t>(after - times_s.begin());
  const double share = (t - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

DVec3 Field::at(const Parameter& parameter, double time_s) const {
  if (parameter.track < 0) return parameter.value;
  return tracks.at(static_cast<std::size_t>(parameter.track)).at(time_s);
}

Pose Field::pose_of(const Camera& camera, double time_s) const {
  return math::look_at(at(camera.eye, time_s), at(camera.target, time_s), camera.up);
}

void translate(Field& field, const DVec3& by) {
  const auto move = [&](Parameter& place) {
    if (place.track < 0) {
      place.value += by;
    } else {
      for (DVec3& value : field.tracks.at(static_cast<std::size_t>(place.track)).values)
        value += by;
    }
  };
  if (!field.nodes.empty()) move(field.nodes.back().at);
  for (PointLight& light : field.lights) move(light.position);
  for (Camera& camera : field.cameras) move(camera.eye), move(camera.target);
}

}  // namespace macula::sdf
