// TraceRecorder: writes the head and gaze of a run as a trace that --trace plays again, line by
// line while it goes, so that a run that ends badly keeps what it had. One thread.
#pragma once

#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "client/pose/pose_source.h"
#include "shared/base/result.h"

namespace macula::pose {

class TraceRecorder {
 public:
  /// Makes the file, or empties it. Errors name it.
  static Result<std::unique_ptr<TraceRecorder>> create(const std::string& path);

  /// Times count from the first sample. One that is not 0.1 ms or more after the last is left out:
  /// a trace's times rise.
  void add(const HeadSample& head);
  /// Whether everything reached the file. Once, after the last add().
  Result<void> finish();

 private:
  TraceRecorder(std::ofstream file, std::string path);

  std::ofstream file_;
  const std::string path_;
  std::optional<ClientTime> first_, last_;
};

}  // namespace macula::pose
