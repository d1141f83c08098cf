// TimeBudget: a budget of rendering time becomes a place on a quality ladder. Frame times over what
// the ladder says of their place's cost tell how long everything takes here and now; the place is
// the best one whose frames are foretold to fit. Holds the median: what a busy machine adds to
// single frames buys no worse picture for all. Without a target it answers the best quality
// allowed. The governor owns it. Pure.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "server/session/quality_ladder.h"
#include "server/session/step_costs.h"
#include "shared/units/time.h"

namespace macula::session {

class TimeBudget {
 public:
  /// Bounds of quality; what --max-error asks is a least one.
  struct Limits {
    double least = kLeastQuality, most = kBestQuality;
  };

  /// nullopt: off. Without a ladder of its own it has QualityLadder::of_scale().
  explicit TimeBudget(std::optional<Nanoseconds> target = std::nullopt,
                      std::shared_ptr<const QualityLadder> ladder = nullptr);

  /// For the frame that begins now.
  QualityPoint plan(ServerTime now);
  /// The frame of the last plan took `render`.
  void on_frame(Nanoseconds render);
  void set_limits(const Limits& limits);
  const QualityLadder& ladder() const { return *ladder_; }

 private:
  /// Of the frames since the last change, over the target; nullopt: too few to tell.
  std::optional<double> load() const;
  bool has_jumped() const;
  void fall(double load, ServerTime now);
  void rise(double load, ServerTime now);
  void change_to(double quality, double load, ServerTime now);
  /// The best quality, in tenths, foretold to take at most `times` what the present one takes, and
  /// at most `most_rise` times its cost by the ladder.
  double quality_of_time(double times, double most_rise, ServerTime now) const;
  /// `place`, or what of it is allowed soon after a rise that did not hold.
  double held_place(double place, ServerTime now) const;
  void note_unheld(ServerTime now);
  /// Compares the first frames after a change of step with what was foretold of them.
  void learn(double load, ServerTime now);

  std::optional<Nanoseconds> target_;
  std::shared_ptr<const QualityLadder> ladder_;
  StepCosts costs_;
  Limits limits_;
  double quality_;
  std::deque<double> frames_ms_;  ///< since the last change, the newest ones
  struct Foretold {
    std::size_t from = 0;  ///< the step
    double load = 0.0;     ///< by the ladder alone
  };
  std::optional<Foretold> foretold_;  ///< of a step that no frames are known of yet
  bool is_new_ = true;  ///< nothing is known of this scene: the first change may be large
  std::optional<ServerTime> changed_, risen_;
  struct Unheld {
    double quality = 0.0;
    ServerTime at;
  };
  std::optional<Unheld> unheld_;  ///< the last rise that had to be taken back
  Nanoseconds caution_;           ///< for so long it counts; longer after each such rise
};

}  // namespace macula::session
