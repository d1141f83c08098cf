// FrameLog: where time and bytes of every frame went, as the server saw it. FOLDER/frames.csv gets
// a row when a frame has left (or is lost), FOLDER/report.json the quantiles of the last 16384 at
// the end. Stages in ms, each from the end of the one before: view_wait (from the view's arrival),
// render, encode, credit_wait, send_queue; what kernel, encoder and link say of their own stage
// comes after them. One thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "server/session/frame_job.h"
#include "server/session/telemetry.h"
#include "shared/net/server_endpoint.h"

namespace macula::session {

/// One frame; a column of the file each.
struct FrameRow {
  double view_wait_ms = 0.0, render_ms = 0.0, encode_ms = 0.0, credit_wait_ms = 0.0,
         send_queue_ms = 0.0;
  double encode_cpu_ms = 0.0;  ///< over all eyes
  /// The kernel's own, summed over threads; 0 where a kernel does not tell.
  double trace_ms = 0.0, shade_ms = 0.0, sample_ms = 0.0, reproject_ms = 0.0, merge_ms = 0.0,
         post_ms = 0.0;
  double color_bytes = 0.0, depth_bytes = 0.0, hidden_bytes = 0.0, cells = 0.0, rays = 0.0;
  double scale = 1.0;  ///< of the governor
};

class FrameLog {
 public:
  /// Makes the folder where it is missing. Errors: it, or a file in it, cannot be made.
  static Result<std::unique_ptr<FrameLog>> create(const std::string& folder);

  /// A frame as it was encoded.
  void add(const FrameJob& job);
  /// It left, or never will.
  void on_sent(const net::FrameSent& sent);
  /// Writes report.json. Errors: a file could not be written.
  Result<void> finish(const Telemetry& telemetry);

 private:
  struct Waiting {
    FrameRow row;
    ServerTime encoded{};
  };
  explicit FrameLog(std::string folder) : folder_(std::move(folder)) {}
  std::string report(const Telemetry& telemetry) const;

  std::string folder_;
  std::ofstream csv_;
  std::map<std::pair<std::uint32_t, std::uint64_t>, Waiting> waiting_;  ///< by epoch and frame
  std::deque<FrameRow> rows_;                                           ///< of frames that left
};

}  // namespace macula::session
