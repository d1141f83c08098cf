#include "client/app/run_log.h"

namespace macula::client_app {
namespace {

double hidden_bytes(const net::FrameBegin& begin) {
  double bytes = 0.0;
  for (const net::SliceEntry& slice : begin.slices) {
    if (slice.layer > 0) bytes += static_cast<double>(slice.size_bytes);
  }
  return bytes;
}

double share(std::uint64_t part, const reprojection::WarpReport& warp) {
  const auto all = warp.covered_px + warp.filled_px + warp.outside_px;
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

void RunLog::note_shown(const Showing& showing, const std::optional<net::ClockEstimate>& clock) {
  const frames::FrameId id = showing.frame->id();
  ++report_.shown_frames;
  report_.ages.add(showing.shown, showing.frame->begin);
  for (const auto& warp : showing.warps) {
    report_.filled_share.add(warp.filled_share());
    report_.outside_share.add(share(warp.outside_px, warp));
  }
  if (order_.newest() == id) return;
  if (order_.advance(id)) {
    note_first_showing(showing, clock);
  } else {
    ++report_.frames_out_of_order;
  }
}

void RunLog::note_first_showing(const Showing& showing,
                                const std::optional<net::ClockEstimate>& clock) {
  const frames::DecodedFrame& frame = *showing.frame;
  ++report_.distinct_server_frames;
  report_.frame_bytes.add(static_cast<double>(frame.bytes));
  report_.frame_cells.add(static_cast<double>(frame.end.cells));
  if (showing.bound) {
    report_.bound_p95_px.add(showing.bound->p95_px);
    report_.bound_most_px.add(showing.bound->most_px);
  }
  report_.hidden_cells.add(static_cast<double>(frame.end.hidden_cells));
  report_.hidden_bytes.add(hidden_bytes(frame.begin));
  report_.frame_rays.add(static_cast<double>(frame.end.rays));
  if (!clock) return;
  book_.note_shown(frame.id(), frame.end,
                   {frame.begin.view_sampled, frame.last_byte, frame.decoded,
                    showing.reproject_begin, showing.reproject_end, showing.shown},
                   *clock);
}

display::ClientReport RunLog::report() const {
  display::ClientReport report = report_;
  report.gaze_changes_over_10_deg = saccades_.count();
  report.accounts = book_.accounts();
  report.accounts_left_out = book_.accounted() - report.accounts.size();
  report.accounts_incomplete = report.distinct_server_frames - book_.accounted();
  return report;
}

}  // namespace macula::client_app
