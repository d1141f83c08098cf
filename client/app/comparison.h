// Comparison: the stream held still, seen in two ways at once. From the moment it begins the head
// stands where it was predicted, so the server's frames soon are frames of that very view: "newest
// frame" beside a way of warping the frame held then shows what latency costs. One thread; the
// metrics are found on another.
#pragma once

#include <array>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/app/client_config.h"
#include "client/app/warp_stage.h"
#include "client/frames/frame_store.h"

namespace macula::client_app {

class Comparison {
 public:
  /// A way to bring a frame to the display.
  struct Way {
    const char* name;
    reprojection::WarpOptions options;
    enum class Frame { Held, Newest };
    Frame frame = Frame::Held;  ///< Newest: as of when the way was chosen
  };
  /// The ways there are. They are chosen by any number, counted round.
  static std::span<const Way> ways();
  /// What the second side begins with: rotation, the warp of most streaming systems.
  static int first_of_second_side();

  /// Where the head stands while this lasts: the first call since end() says where.
  const Pose& hold(const Pose& stage_from_head);
  bool holds() const { return stage_from_head_.has_value(); }
  void end();

  /// Warps to the held view what a changed choice asks for; `newest` is held, too, when it is the
  /// first. Only after hold().
  void update(const frames::FramePtr& newest, const EyeRig& rig, const std::array<int, 2>& ways);

  const display::EyePictures& pictures(int side) const {
    return sides_[static_cast<std::size_t>(side)].stage->eyes().colors;
  }
  /// A line a side: its name, CPU time of its warp over the eyes; then how they differ, as far as
  /// that is known.
  std::vector<std::string> lines();

 private:
  struct Side {
    std::optional<int> way;
    std::unique_ptr<WarpStage> stage;
    Nanoseconds cpu{0};
  };
  struct Metrics {
    double psnr_db = 0.0, flip = 0.0;  ///< over the eyes
  };
  void warp(Side& side, const frames::DecodedFrame& frame, const EyeRig& rig);
  void begin_metrics(const EyeRig& rig);

  std::optional<Pose> stage_from_head_;
  frames::FramePtr held_;
  std::array<Side, 2> sides_;
  std::future<Metrics> measuring_;
  std::optional<Metrics> metrics_;
};

}  // namespace macula::client_app
