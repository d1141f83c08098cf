// Trace: a recording of head and gaze, from CSV with the columns
// `t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz`: seconds from the start, head position in meters, head
// orientation (head to stage), gaze as a unit vector in the head frame, empty where there is none.
// Frames as in shared/math/frames.h. A value; reading it is thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/pose/pose_source.h"
#include "shared/base/result.h"

namespace macula::pose {

inline constexpr std::string_view kTraceColumns = "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz";

struct TraceSample {
  Nanoseconds at{0};  ///< since the start of the trace's own time line
  Pose stage_from_head;
  std::optional<Vec3> gaze;  ///< unit vector in the head frame
};

struct Trace {
  std::vector<TraceSample> samples;  ///< at least two, strictly increasing in time

  /// From the first sample to the last.
  Nanoseconds duration() const { return samples.back().at - samples.front().at; }
  /// The head `since_start` after the first sample, held at either end. Between samples the
  /// position is linear, the rotation spherical, the gaze linear and normalised; a gap in the gaze
  /// takes its nearer neighbour. `at` and `gaze_at` of the result are left for the caller.
  HeadSample at(Nanoseconds since_start) const;
};

/// Errors name `name`, the line and the column, and what is allowed: missing columns, anything that
/// is not a finite number, time that does not increase, a quaternion or gaze not of length 1 within
/// 1 %, a gaze given in part, fewer than two samples.
Result<Trace> parse_trace(std::string_view text, const std::string& name);
Result<Trace> load_trace(const std::string& path);
/// The CSV of a trace, and one line of it with its end: 0.1 ms, 0.01 mm, 1e-6.
std::string to_csv(const Trace& trace);
std::string to_csv_line(const TraceSample& sample);

}  // namespace macula::pose
