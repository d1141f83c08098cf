// What a server tells about itself: counters that only grow, and the stage times of the last
// frames. A value; Server::telemetry() makes a copy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/session/session_table.h"
#include "shared/net/server_endpoint.h"

namespace macula::session {

/// Stages of one frame in ms.
struct StageTimes {
  double view_wait_ms = 0.0, render_ms = 0.0, encode_ms = 0.0;
  double encode_cpu_ms = 0.0;  ///< over all eyes
};

struct SessionState {
  std::uint64_t session = 0;
  std::uint32_t epoch = 0;
  int in_flight = 0, unsent = 0, window = 0;
  double link_bytes_per_s = 0.0;  ///< as acknowledged; 0: not known yet
};

struct Telemetry {
  std::uint64_t frames_rendered = 0, frames_encoded = 0, frames_stopped = 0, frames_failed = 0;
  std::uint64_t rays = 0, cells = 0, non_finite_samples = 0;
  double newest_scale = 1.0;           ///< of the governor, for the last frame rendered
  double newest_quality = 10.0;        ///< 0..10, where it was on the kernel's ladder
  double measured_rmse = 0.0;          ///< of that place, when the ladder was made; 0: never
  double estimated_rmse = 0.0;         ///< of frames now, by those judged lately; 0: none was
  std::vector<StageTimes> recent;      ///< oldest first, at most 64 frames
  std::vector<double> recent_send_ms;  ///< from hand-over to last byte, oldest first, at most 64
  std::vector<SessionState> now;       ///< the sessions alive
  SessionCounters sessions;
  TableCounters table;
  net::ServerCounters net;
};

/// One line for the log: rates, medians of the stages, losses.
std::string summary_line(const Telemetry& telemetry);

}  // namespace macula::session
