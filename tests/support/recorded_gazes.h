// Recorded eyes from the handed traces: t_s, head (position, rotation), gaze in view space.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "shared/math/vec.h"
#include "tests/support/handed_data.h"

namespace macula::test {

struct RecordedGaze {
  double t_s = 0.0;
  DQuat stage_from_head;
  Vec3 gaze{0.0F};  ///< unit
};

inline std::vector<RecordedGaze> load_gazes(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<RecordedGaze> samples;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream text(line);
    double t = 0.0, x = 0.0, y = 0.0, z = 0.0, position = 0.0;
    DQuat q;
    for (text >> t; position < 3.0; ++position) text >> x;
    text >> q.x >> q.y >> q.z >> q.w;
    if (text >> x >> y >> z)
      samples.push_back({t, glm::normalize(q), glm::normalize(Vec3(DVec3{x, y, z}))});
  }
  return samples;
}

/// Every recording of eyes among the handed traces, in the order of their names.
inline std::vector<std::filesystem::path> recorded_gazes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(handed_data() / "traces"))
    if (entry.path().filename().string().rfind("eyenavgs", 0) == 0) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace macula::test
