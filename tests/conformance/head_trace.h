// Head poses for the conformance tests: a recorded trace at any time, and its most vigorous
// stretch.
#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "shared/math/pose.h"

namespace macula::test {

struct TimedPose {
  double t_s = 0.0;
  Pose stage_from_head;
};

/// A CSV of t_s, position, quaternion (x, y, z, w), gaze; poses between rows are interpolated.
class HeadTrace {
 public:
  explicit HeadTrace(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);  // header
    while (std::getline(file, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream in(line);
      TimedPose row;
      DVec3& p = row.stage_from_head.position;
      DQuat& q = row.stage_from_head.rotation;
      if (in >> row.t_s >> p.x >> p.y >> p.z >> q.x >> q.y >> q.z >> q.w) rows_.push_back(row);
    }
  }
  bool empty() const { return rows_.empty(); }

  /// t_s within the trace's span.
  Pose at(double t_s) const {
    const auto later = std::partition_point(rows_.begin() + 1, rows_.end() - 1,
                                            [&](const TimedPose& row) { return row.t_s < t_s; });
    const TimedPose &a = *(later - 1), &b = *later;
    return math::interpolate(a.stage_from_head, b.stage_from_head, (t_s - a.t_s) / (b.t_s - a.t_s));
  }

  /// Start of the stretch of `length_s` with the most turning.
  double most_vigorous(double length_s) const {
    double best_start = rows_.front().t_s, best_turn = -1.0;
    for (double start = rows_.front().t_s; start + length_s < rows_.back().t_s; start += 1.0) {
      double turn = 0.0;
      for (double t = start; t < start + length_s; t += 0.1) {
        turn += math::angle_between(at(t), at(t + 0.1)).value();
      }
      if (turn > best_turn) best_turn = turn, best_start = start;
    }
    return best_start;
  }

 private:
  std::vector<TimedPose> rows_;
};

}  // namespace macula::test
