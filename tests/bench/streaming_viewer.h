// A viewer for `macula-bench streaming`: plays a trace at the display's rate, decodes what comes as
// the client does, and notes what every refresh would show; it draws nothing, so that a busy
// machine measures the stream and not its own warp.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "client/app/eye_rig.h"
#include "client/frames/frame_store.h"
#include "client/frames/stage_book.h"
#include "client/frames/statistics.h"
#include "client/pose/trace_source.h"
#include "shared/net/client_endpoint.h"

namespace macula::bench {

struct Viewed {
  std::uint64_t refreshes = 0, with_picture = 0, shown = 0, received = 0;
  frames::Ages ages;              ///< of every refresh with a picture
  frames::Series transit_ms;      ///< handed to the network -> last byte
  frames::Series credit_wait_ms;  ///< encoded -> handed to the network
  frames::Series render_ms;
  frames::Series frame_bytes, decode_cpu_ms, cells;
  frames::Series clock_error_ms;
  std::uint64_t clock_bound_broken = 0;
  std::vector<ClientTime> news;  ///< when refreshes showed a new frame
  std::vector<double> age_ms_by_refresh;
  std::vector<ClientTime> refresh_at;
  std::vector<frames::FramePtr> samples;  ///< one a second or so, for judging pictures
  std::vector<frames::AccountedFrame> accounts;
  std::uint64_t undecodable = 0;
  double duration_s = 0.0;
};

/// Runs until `seconds` have passed since the first frame (or 30 s without any). `at_refresh` is
/// told the share of the run that has passed.
Viewed view_stream(net::ClientEndpoint& endpoint, const base::Clock& clock,
                   const client_app::EyeRig& rig, pose::TraceSource& poses, double seconds,
                   const std::function<void(double share)>& at_refresh);

}  // namespace macula::bench
