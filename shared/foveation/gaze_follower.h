// GazeFollower: from gaze samples to where, and how widely, a frame that is seen later keeps full
// quality. One per eye; pure, bounded memory.
//
// The disc grows with what the eye may do until the frame is seen: radius = base + share x mean
// speed of late x age. During a saccade the eye sees next to nothing (Matin 1974), so its bits go
// to the landing point: a saccade is fastest about half way (Van Opstal and Van Gisbergen 1987, for
// amplitudes that people make), so it lands twice as far as it was at its fastest. A lost gaze is
// held through a blink and then glides to the middle.
#pragma once

#include <deque>
#include <optional>

#include "shared/foveation/gaze.h"
#include "shared/units/angle.h"
#include "shared/units/time.h"

namespace macula::foveation {

struct GazeFollowerOptions {
  Degrees base_radius{5.0};        ///< of full quality, the tracker's error included
  Degrees most_radius{12.0};       ///< however fast the eye
  double speed_share = 0.5;        ///< of speed x age; eyes turn back more often than they go on
  Degrees rest{0.0};               ///< the centre stays while the gaze is within this of it
  double saccade_deg_per_s = 100;  ///< above it the eye jumps
  Nanoseconds lag{std::chrono::milliseconds{8}};      ///< of smoothing, between saccades
  Nanoseconds blink{std::chrono::milliseconds{400}};  ///< a lost gaze is held so long
  Nanoseconds glide{std::chrono::milliseconds{300}};  ///< then comes e times nearer the middle
};

enum class GazePhase { Fixation, Saccade, Held, Lost };

struct FollowedGaze {
  Gaze gaze;            ///< smoothed; of a saccade, where it is going to land
  Gaze centre;          ///< where the grid rests
  Degrees radius{0.0};  ///< of full quality around `centre`
  GazePhase phase = GazePhase::Fixation;
};

class GazeFollower {
 public:
  explicit GazeFollower(const GazeFollowerOptions& options = {}) : options_(options) {}

  /// Samples in order; one that is not newer is ignored.
  void add(const Gaze& measured, ClientTime at);
  /// For a frame that is seen `age` after the newest sample. Moves the centre where it must.
  FollowedGaze follow(Nanoseconds age);
  GazePhase phase() const { return phase_; }

 private:
  struct Speed {
    ClientTime at;
    double deg_per_s = 0.0;
  };
  void take_sample(const Vec3& direction, ClientTime at);
  void lose(Nanoseconds since_last);
  Vec3 landing() const;
  double mean_speed() const;

  GazeFollowerOptions options_;
  GazePhase phase_ = GazePhase::Lost;
  std::optional<ClientTime> newest_;  ///< sample, usable or not
  ClientTime usable_at_{};            ///< the newest usable one
  Vec3 raw_{0.0F, 0.0F, -1.0F}, smooth_{0.0F, 0.0F, -1.0F}, centre_{0.0F, 0.0F, -1.0F};
  float confidence_ = 0.0F;
  std::deque<Speed> speeds_;  ///< of the last 80 ms
  Vec3 saccade_from_{0.0F, 0.0F, -1.0F};
  double saccade_peak_deg_per_s_ = 0.0;
  double peak_at_deg_ = 0.0;  ///< how far it had come then
};

}  // namespace macula::foveation

namespace macula {
using foveation::FollowedGaze;
}
