#include "server/session/telemetry.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/text.h"

namespace macula::session {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_of(const std::vector<StageTimes>& frames, double StageTimes::*stage) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const StageTimes& frame : frames) values.push_back(frame.*stage);
  return median(std::move(values));
}

std::string ms(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f ms", value);
  return text;
}

/// "quality 6.3 of 10, periphery 0.61, error 0.021 measured, 0.024 estimated".
std::string quality_text(const Telemetry& t) {
  const auto number = [](const char* form, double value) {
    char text[48];
    std::snprintf(text, sizeof(text), form, value);
    return std::string(text);
  };
  std::string text =
      number("quality %.1f of 10", t.newest_quality) + number(", periphery %.2f", t.newest_scale);
  if (t.measured_rmse > 0.0) text += number(", error %.2g measured", t.measured_rmse);
  if (t.estimated_rmse > 0.0) text += number(", %.2g estimated", t.estimated_rmse);
  return text;
}

}  // namespace

std::string summary_line(const Telemetry& t) {
  return base::concat(t.now.size(), " client(s), ", t.frames_encoded, " frames, ",
                      t.sessions.frames_lost, " lost, ", t.frames_stopped,
                      " stopped; median view wait ",
                      ms(median_of(t.recent, &StageTimes::view_wait_ms)), ", render ",
                      ms(median_of(t.recent, &StageTimes::render_ms)), ", encode ",
                      ms(median_of(t.recent, &StageTimes::encode_ms)), ", send ",
                      ms(median(t.recent_send_ms)), "; ", quality_text(t));
}

}  // namespace macula::session
