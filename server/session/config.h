// Settings of one server, filled in by server/app; the defaults are what an unconfigured server
// does.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/session/hello.h"
#include "server/session/quality_ladder.h"
#include "server/session/rules.h"
#include "shared/codec/h264.h"
#include "shared/codec/quantiser_offsets.h"
#include "shared/foveation/rate.h"
#include "shared/image/tone.h"
#include "shared/math/pose.h"
#include "shared/units/angle.h"
#include "shared/units/time.h"

namespace macula::session {

/// How a frame is sampled where the client has no wish of its own.
struct ViewPolicy {
  Pose scene_from_stage;  ///< where the viewer's stage stands, meters
  image::Tone tone;
  foveation::RateModel rate_model;
  double fovea_oversampling = 1.0;  ///< cells per nominal pixel along an axis at the gaze
  Degrees full_rate_radius{5.0};
  Degrees guard_band{4.0};             ///< rendered beyond the display on every side
  std::size_t most_cells = 32U << 20;  ///< over all eyes; larger frames are refused
  int most_cells_a_side = 8192;
};

/// Delays for tests that show where time goes; zero in production.
struct StageDelays {
  Nanoseconds view_wait{0};  ///< between taking a view and render_begin
  Nanoseconds render{0};
  Nanoseconds encode{0};
};

struct ServerConfig {
  SessionRules rules;
  ServerOffer offer;
  ViewPolicy views;
  int jpeg_quality = 85;  ///< 1..100; for H.264 the quantiser is h264_quantiser(this)
  codec::H264Options h264;
  codec::FovealQuantiser quantiser_range;        ///< of H.264 over the picture
  std::optional<Nanoseconds> target_frame_time;  ///< of rendering; nullopt: full quality always
  /// What quality is: steps of settings, their cost and error. Null: the periphery's resolution.
  std::shared_ptr<const QualityLadder> ladder;
  /// The kernel with each step's knobs turned; empty: the kernel as it is, always.
  std::vector<std::shared_ptr<const kernels::Kernel>> ladder_kernels;
  /// What frames are judged by, kernels::make_reference; null: they are not.
  std::shared_ptr<const kernels::Kernel> reference;
  std::optional<double> quality;    ///< 0..10 on the ladder, with a target time at most; none: 10
  std::optional<double> most_rmse;  ///< never below the quality that has it
  std::optional<Nanoseconds> age_goal;  ///< of shown frames; nullopt: full quality on any link
  std::uint64_t seed = 1;               ///< of every frame's samples
  int encode_threads = 2;               ///< eyes are encoded side by side where a core is idle
  std::string description;              ///< travels in every frame: what it was made with
  StageDelays delays;
};

/// x264's rate factor of a quality on JPEG's scale: 22 at 85, 16 at 100, 36 at 50.
inline double h264_quantiser(int quality) {
  return 56.0 - 0.4 * quality;
}

}  // namespace macula::session
