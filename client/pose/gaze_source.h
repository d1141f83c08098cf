// GazeSource: where the gaze comes from when it does not come with the head. One sample a refresh.
#pragma once

#include <memory>
#include <optional>

#include "client/pose/pose_source.h"

namespace macula::pose {

struct GazeSample {
  Gaze gaze;  ///< in the head frame
  ClientTime at{};
};

class GazeSource {
 public:
  virtual ~GazeSource() = default;
  /// What is known at `at` with the head there.
  virtual GazeSample sample(ClientTime at, const Pose& stage_from_head) = 0;
};

/// Looks where the head of another source looks, as the mouse does beside a trace.
class GazeOfHead final : public GazeSource {
 public:
  explicit GazeOfHead(std::unique_ptr<PoseSource> source) : source_(std::move(source)) {}
  GazeSample sample(ClientTime at, const Pose& stage_from_head) override;

 private:
  std::unique_ptr<PoseSource> source_;
};

/// Looks at a point that wanders through the stage, 2 m in front of where one begins: 40 degrees
/// from side to side in 8 s and 20 up and down in 5 s. Stands for eyes that follow a moving target,
/// as viewers of paper 002 did (there along straight lines across the picture).
class TargetGaze final : public GazeSource {
 public:
  GazeSample sample(ClientTime at, const Pose& stage_from_head) override;
  /// In the stage, meters, `since` the first sample.
  static DVec3 target(Nanoseconds since);

 private:
  std::optional<ClientTime> start_;
};

/// A head from one source and its gaze from another.
class HeadWithGaze final : public PoseSource {
 public:
  HeadWithGaze(std::unique_ptr<PoseSource> head, std::unique_ptr<GazeSource> gaze)
      : head_(std::move(head)), gaze_(std::move(gaze)) {}
  std::optional<HeadSample> sample(ClientTime at) override;
  std::optional<Pose> forecast(ClientTime at) override { return head_->forecast(at); }

 private:
  std::unique_ptr<PoseSource> head_;
  std::unique_ptr<GazeSource> gaze_;
};

}  // namespace macula::pose
