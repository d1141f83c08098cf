// DisplayLoop: one turn a refresh, in six words. begin: as late as the warp allows; predict:
// sample the head and say where it will be
// when the display lights up; publish: tell the server; fetch: the newest decoded frame; reproject:
// to the predicted pose; submit: at the display's time. Degrades and says so; never waits for the
// network in real time.
#pragma once

#include <atomic>

#include "client/app/client_config.h"
#include "client/app/comparison.h"
#include "client/app/late_start.h"
#include "client/app/run_log.h"
#include "client/app/screen.h"
#include "client/app/warp_stage.h"
#include "client/display/headless/picture_writer.h"
#include "client/frames/frame_store.h"
#include "client/pose/prediction_doubt.h"
#include "client/pose/predictor.h"
#include "client/pose/trace_recorder.h"

namespace macula::client_app {

/// What the loop works with; all of it outlives the loop.
struct LoopParts {
  net::ClientEndpoint& endpoint;
  const base::Clock& clock;
  pose::PoseSource& poses;
  const frames::FrameStore& store;
  RunLog& log;
  Screen& screen;
  display::PictureWriter* pictures = nullptr;  ///< null: none are kept
  pose::TraceRecorder* recorder = nullptr;     ///< null: nothing is recorded
  const std::atomic<bool>& stop;
};

class DisplayLoop {
 public:
  DisplayLoop(const ClientConfig& config, const LoopParts& parts);

  display::RunEnd run();
  /// The last frame shown, null before the first, and the pictures made of it.
  frames::FramePtr last_frame() const { return last_frame_; }
  const display::EyePictures& pictures() const { return warps_.eyes().colors; }

 private:
  struct Predicted {
    pose::HeadSample head;
    Pose stage_from_head;        ///< at the display time
    ClientTime display;          ///< that time, on the line of the poses
    Nanoseconds real_from_pose;  ///< that line is another than the clock's when not in real time
  };
  /// The reason to end, when there is one.
  std::optional<display::RunEnd> end_reason() const;
  /// Waits as long as the warp leaves time to.
  void begin_late(Refresh& refresh);
  std::optional<Predicted> predict(const Refresh& refresh);
  /// `until_display`: from the head's sample to the light of its refresh.
  void publish(const pose::HeadSample& head, Nanoseconds until_display);
  frames::FramePtr fetch(const pose::HeadSample& head, Nanoseconds until_display);
  frames::FramePtr wait_for_news(const pose::HeadSample& head, Nanoseconds until_display);
  /// Holds the head and the frame where the person wants to compare.
  void hold(pose::HeadSample& head, Pose& at_display);
  void compare(const frames::FramePtr& frame);
  Showing reproject(const frames::FramePtr& frame, const Pose& stage_from_head);
  void submit(const Refresh& refresh, const Predicted& predicted, Showing showing);
  void judge(Showing& showing, const Predicted& predicted, ClientTime seen);
  void report_events();
  ClientTime now() const { return ClientTime{parts_.clock.now()}; }

  const ClientConfig config_;
  const LoopParts parts_;
  pose::Predictor predictor_;
  pose::PredictionDoubt doubt_;
  WarpStage warps_;
  Comparison comparison_;
  LateStart late_start_;
  frames::FramePtr last_frame_;
  ClientTime last_news_;  // when a new frame was last shown
  std::uint64_t sequence_ = 0;
};

}  // namespace macula::client_app
