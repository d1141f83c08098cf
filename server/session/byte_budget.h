// ByteBudget: a goal for the age of frames becomes bytes a frame, and those a ladder of what gives
// way: first the quantiser (which the encoder turns by itself within its bytes, periphery first),
// depth's resolution, the interval between frames, at last the periphery's resolution, which
// changes at most every two seconds. The governor owns it. Pure.
#pragma once

#include <cstddef>
#include <optional>

#include "shared/units/time.h"

namespace macula::session {

/// What the network and the client ask of a frame.
struct LinkState {
  std::optional<double> bytes_per_s;  ///< nullopt: nothing is known, nothing is bounded
  Nanoseconds least_rtt{0};
  Nanoseconds clients_own{0};  ///< from reading a pose to showing it, without the network
};

/// One encoded frame as it turned out.
struct EncodedSize {
  std::size_t color_bytes = 0, depth_bytes = 0, cells = 0;  ///< over all eyes
  int depth_divisor = 1;
  Nanoseconds work{0};           ///< from the view's arrival to the last byte encoded
  std::size_t hidden_bytes = 0;  ///< of the second layer, over all eyes
  std::size_t bytes() const { return color_bytes + depth_bytes + hidden_bytes; }
};

struct BytePlan {
  std::size_t color_bytes = 0;    ///< over all eyes; 0: no bound
  int depth_divisor = 1;          ///< 1, 2, 4 or 8: one depth sample for so many cells each way
  Nanoseconds least_interval{0};  ///< between the starts of frames
  double scale = 1.0;             ///< of the periphery's resolution, in [kLeastScale, 1]
};

class ByteBudget {
 public:
  static constexpr double kLeastScale = 0.4;
  static constexpr std::size_t kLeastBytes = 4000;  ///< of a frame; below it frames come less often

  /// nullopt: off.
  explicit ByteBudget(std::optional<Nanoseconds> goal = std::nullopt) : goal_(goal) {}

  BytePlan plan(const LinkState& link, ServerTime now);
  void on_encoded(const EncodedSize& size);

 private:
  double bytes_a_frame(const LinkState& link) const;
  void choose_divisor(double bytes);
  void choose_scale(double color_bytes, ServerTime now);

  std::optional<Nanoseconds> goal_;
  double work_ms_ = 0.0;           ///< smoothed, without waiting for the link
  double full_depth_bytes_ = 0.0;  ///< of a frame at divisor 1, by the last one
  double last_bytes_ = 0.0;        ///< of a frame as it turned out
  double cells_ = 0.0;             ///< of a frame at scale 1, by the last one
  double allowed_bytes_ = 0.0;     ///< rises slowly, falls at once
  int divisor_ = 1;
  double scale_ = 1.0;
  std::optional<ServerTime> scale_changed_;
};

}  // namespace macula::session
