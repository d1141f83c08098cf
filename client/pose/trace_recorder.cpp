#include "client/pose/trace_recorder.h"

#include <utility>

#include "client/pose/trace.h"

namespace macula::pose {
namespace {

constexpr Nanoseconds kResolution = std::chrono::microseconds{100};  // as to_csv_line writes time

Error unwritable(const std::string& path) {
  return {"the trace cannot be written", path, "choose a file in a folder that can be written to"};
}

}  // namespace

Result<std::unique_ptr<TraceRecorder>> TraceRecorder::create(const std::string& path) {
  std::ofstream file(path, std::ios::trunc);
  if (!file) return tl::unexpected(unwritable(path));
  return std::unique_ptr<TraceRecorder>(new TraceRecorder(std::move(file), path));
}

TraceRecorder::TraceRecorder(std::ofstream file, std::string path)
    : file_(std::move(file)), path_(std::move(path)) {
  file_ << kTraceColumns << '\n';
}

void TraceRecorder::add(const HeadSample& head) {
  if (last_ && head.at - *last_ < kResolution) return;
  if (!first_) first_ = head.at;
  last_ = head.at;
  TraceSample sample{head.at - *first_, head.stage_from_head, std::nullopt};
  if (head.gaze.valid) sample.gaze = head.gaze.direction;
  file_ << to_csv_line(sample);
}

Result<void> TraceRecorder::finish() {
  file_.close();
  if (file_) return {};
  Error error = unwritable(path_);
  error.kind = base::ErrorKind::Runtime;
  return tl::unexpected(std::move(error));
}

}  // namespace macula::pose
