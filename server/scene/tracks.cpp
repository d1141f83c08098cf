// Values of keyframe tracks at a time.
#include <algorithm>

#include "server/scene/animation.h"
#include "server/scene/keys.h"
#include "shared/base/check.h"

namespace macula::scene {
namespace {

/// Hermite's cubic between two keys; tangents are per second. Source: glTF 2.0, section C.5.
template <class Value>
Value cubic(const Track<Value>& track, const KeySpan& span) {
  const auto& values = track.values;
  const Value& from = values[3 * span.before + 1];
  const Value& to = values[3 * span.after + 1];
  const Value leaving = values[3 * span.before + 2] * span.length_s;
  const Value arriving = values[3 * span.after] * span.length_s;
  const double u = span.u, u2 = u * u, u3 = u2 * u;
  return (2.0 * u3 - 3.0 * u2 + 1.0) * from + (u3 - 2.0 * u2 + u) * leaving +
         (-2.0 * u3 + 3.0 * u2) * to + (u3 - u2) * arriving;
}

DVec3 between(const DVec3& from, const DVec3& to, double u) {
  return from + u * (to - from);
}
/// q and -q are one rotation: glm turns the shorter way round.
DQuat between(const DQuat& from, const DQuat& to, double u) {
  return glm::slerp(from, to, u);
}

template <class Value>
Value interpolate(const Track<Value>& track, double seconds) {
  MACULA_DCHECK(!track.empty());
  const KeySpan span = locate(track.times_s, seconds);
  switch (track.interpolation) {
    case Interpolation::Step:
      return track.values[span.before];
    case Interpolation::Linear:
      if (span.u == 0.0) return track.values[span.before];
      return between(track.values[span.before], track.values[span.after], span.u);
    case Interpolation::CubicSpline:
      return cubic(track, span);
  }
  return track.values[span.before];
}

}  // namespace

KeySpan locate(const std::vector<double>& times_s, double seconds) {
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), seconds);
  const auto after = static_cast<std::size_t>(next - times_s.begin());
  if (after == 0) return {};
  if (after == times_s.size()) return {after - 1, after - 1};
  const double length = times_s[after] - times_s[after - 1];
  return {after - 1, after, (seconds - times_s[after - 1]) / length, length};
}

double seconds_into(SceneTime time, Nanoseconds period) {
  Nanoseconds::rep ns = time.since_start.count();
  if (period.count() > 0) {
    ns %= period.count();
    if (ns < 0) ns += period.count();
  }
  return static_cast<double>(ns) * 1e-9;
}

DVec3 value_at(const Track<DVec3>& track, double seconds) {
  return interpolate(track, seconds);
}

DQuat value_at(const Track<DQuat>& track, double seconds) {
  return glm::normalize(interpolate(track, seconds));
}

}  // namespace macula::scene
