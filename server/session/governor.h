// The governor: the one place that turns a time and a byte budget into quality. One per epoch of a
// session, pure, not thread-safe.
#pragma once

#include <cstdint>
#include <memory>

#include "server/session/byte_budget.h"
#include "server/session/error_estimate.h"
#include "server/session/quality_ladder.h"
#include "server/session/time_budget.h"

namespace macula::session {

struct Goals {
  std::optional<Nanoseconds> frame_time;  ///< of rendering
  std::optional<Nanoseconds> age;         ///< of what the client shows
  /// Of the kernel; null: the periphery's resolution alone gives way.
  std::shared_ptr<const QualityLadder> ladder{};
  std::optional<double> quality{};    ///< where on it, with a time to hold at most; none: the best
  std::optional<double> most_rmse{};  ///< as QualityStep::rmse; never below its quality
};

/// How a frame is to be made.
struct Quality {
  double scale = 1.0;  ///< of the periphery's resolution and the disc of full rate, by both budgets
  double quality = kBestQuality;  ///< on the kernel's ladder
  std::uint32_t step = 0;         ///< of the ladder, whose knobs are turned
  double rmse = 0.0;              ///< that was measured of this place; 0: none was
  std::uint64_t judgement = 0;    ///< above 0: this frame is to be judged, for the nth time
  BytePlan bytes;
  /// Colour leans on no other frame: for a link that loses too many.
  enum class Color { AsAgreed, Stateless };
  Color color = Color::AsAgreed;
};

class Governor {
 public:
  explicit Governor(const Goals& goals = {});

  Quality plan(const LinkState& link, ServerTime now);
  void on_rendered(Nanoseconds render) { time_.on_frame(render); }
  /// What the frame of the last plan's error was found to be, at a few places.
  void on_error_estimated(const SpotError& error);
  /// Display-linear, as the eye weighs it, of frames like the last one; nullopt: none was judged.
  std::optional<double> estimated_rmse() const;
  void on_encoded(const EncodedSize& size) { bytes_.on_encoded(size); }
  /// The client lost a frame that others lean on.
  void on_key_wanted(ServerTime now);

 private:
  void set_limits();

  std::optional<double> quality_, most_rmse_;
  bool has_time_goal_;
  /// Of this scene: squared errors over those that the ladder has, a mean of estimates so far.
  double square_over_measured_ = 1.0;
  std::uint64_t judgements_ = 0;  ///< asked for
  int estimates_ = 0;             ///< had, at most those that are remembered
  double limited_by_ = 1.0;       ///< RMSE over that of the ladder when limits were set
  QualityPoint point_;            ///< of the last plan
  std::optional<ServerTime> judged_;
  TimeBudget time_;
  ByteBudget bytes_;
  int keys_lately_ = 0;
  ServerTime keys_since_{}, stateless_until_{};
};

}  // namespace macula::session
