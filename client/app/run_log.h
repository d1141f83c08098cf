// RunLog: what the display loop notes of every refresh, and the report made of it at the end. One
// thread, except for the StageBook it owns.
#pragma once

#include "client/display/headless/report.h"
#include "client/frames/frame_order.h"
#include "client/frames/frame_store.h"
#include "client/pose/saccades.h"
#include "client/reprojection/error_bound.h"

namespace macula::client_app {

/// One refresh that showed a frame.
struct Showing {
  frames::FramePtr frame;
  std::vector<reprojection::WarpReport> warps;  ///< by eye
  /// Of the eye with the larger one; nullopt where the frame does not state its depth's error.
  std::optional<reprojection::ErrorBound::Summary> bound;
  ClientTime reproject_begin, reproject_end, shown;
};

class RunLog {
 public:
  void note_pose(const pose::HeadSample& head) { saccades_.add(head); }
  void note_no_picture() { ++report_.refreshes_without_picture; }
  /// `clock`: the estimate in force; without one the frame's stages stay unaccounted.
  void note_shown(const Showing& showing, const std::optional<net::ClockEstimate>& clock);

  std::uint64_t shown_frames() const { return report_.shown_frames; }
  std::optional<frames::FrameId> newest() const { return order_.newest(); }
  frames::StageBook& book() { return book_; }
  const frames::StageBook& book() const { return book_; }
  /// What was noted; the rest of the report is the caller's.
  display::ClientReport report() const;

 private:
  void note_first_showing(const Showing& showing, const std::optional<net::ClockEstimate>& clock);

  display::ClientReport report_;
  frames::FrameOrder order_;
  frames::StageBook book_;
  pose::SaccadeCounter saccades_;
};

}  // namespace macula::client_app
