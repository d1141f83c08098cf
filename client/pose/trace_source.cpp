#include "client/pose/trace_source.h"

#include <utility>

#include "shared/base/check.h"

namespace macula::pose {

TraceSource::TraceSource(Trace trace, AtEnd at_end) : trace_(std::move(trace)), at_end_(at_end) {
  MACULA_CHECK(trace_.samples.size() >= 2, "a trace has two samples or more");
}

std::optional<HeadSample> TraceSource::sample(ClientTime at) {
  if (!start_) start_ = at;
  Nanoseconds since_start = at - *start_;
  if (since_start > trace_.duration()) {
    if (at_end_ == AtEnd::Stop) return std::nullopt;
    since_start %= trace_.duration();
  }
  HeadSample head = trace_.at(since_start);
  head.at = at;
  head.gaze_at = at;
  return head;
}

}  // namespace macula::pose
