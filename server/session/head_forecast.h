// HeadForecast: at which pose to render, and how far beyond the display. A frame is seen later than
// its view was read: by what the last frames took from the view's arrival to their acknowledgement
// (the way back stands for the way here) and by what the client itself needs from reading a pose to
// showing it. The head is carried on over that horizon; the guard band covers what a head as fast
// as of late turns meanwhile. One epoch of one session; pure, not thread-safe, bounded memory.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "server/session/rules.h"
#include "shared/math/pose_predictor.h"
#include "shared/net/messages.h"

namespace macula::session {

class HeadForecast {
 public:
  explicit HeadForecast(const SessionRules& rules);

  /// Every view that counts, in order.
  void add(const net::ViewState& view);
  void on_started(std::uint64_t frame, ServerTime view_received);
  /// The client has everything up to `frame`.
  void on_received(std::uint64_t frame, ServerTime now);

  /// Of a frame made from `view`, the newest one added; zero until a frame has been acknowledged
  /// and where rules.longest_horizon is.
  Nanoseconds horizon(const net::ViewState& view) const;
  Pose stage_from_head(const net::ViewState& view) const;
  /// Whole steps of 2 degrees, at most rules.most_guard_band; falls slowly, so that the grid rests.
  Degrees guard_band(const net::ViewState& view, ServerTime now);

  /// How far the eyes may move from where a frame of `view` is rendered until it is seen, meters:
  /// the head's pace of late over the frame's age, between rules.most_view_cell_m and a fifth of
  /// it; 0 where nothing is predicted.
  double view_cell_m(const net::ViewState& view, ServerTime now);

  /// From reading the head of `view` to showing its frame, by the last frames; 0: not known yet.
  Nanoseconds age(const net::ViewState& view) const;
  /// From a view's arrival to its frame's acknowledgement, smoothed.
  std::optional<Nanoseconds> latency() const { return latency_; }

 private:
  struct Started {
    std::uint64_t frame = 0;
    ServerTime view_received{};
  };
  SessionRules rules_;
  math::PosePredictor head_;
  std::deque<Started> started_;
  std::optional<Nanoseconds> latency_;
  /// The most of late: falls by e every second.
  struct Peak {
    double value = 0.0;
    ServerTime at{};
    double raise(double to, ServerTime now);
  };
  Peak turn_deg_, move_m_;  ///< over the age of a frame
};

}  // namespace macula::session
