// The governor: the one place that turns a time and a byte budget into quality. One per epoch of a
// session, pure, not thread-safe.
#pragma once

#include "server/session/byte_budget.h"
#include "server/session/time_budget.h"

namespace macula::session {

struct Goals {
  std::optional<Nanoseconds> frame_time;  ///< of rendering
  std::optional<Nanoseconds> age;         ///< of what the client shows
};

/// How a frame is to be made.
struct Quality {
  double scale = 1.0;  ///< of the periphery's resolution and the disc of full rate, by both budgets
  BytePlan bytes;
  /// Colour leans on no other frame: for a link that loses too many.
  enum class Color { AsAgreed, Stateless };
  Color color = Color::AsAgreed;
};

class Governor {
 public:
  explicit Governor(const Goals& goals = {}) : time_(goals.frame_time), bytes_(goals.age) {}

  Quality plan(const LinkState& link, ServerTime now);
  void on_rendered(Nanoseconds render) { time_.on_frame(render); }
  void on_encoded(const EncodedSize& size) { bytes_.on_encoded(size); }
  /// The client lost a frame that others lean on.
  void on_key_wanted(ServerTime now);

 private:
  TimeBudget time_;
  ByteBudget bytes_;
  int keys_lately_ = 0;
  ServerTime keys_since_{}, stateless_until_{};
};

}  // namespace macula::session
