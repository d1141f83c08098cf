// Record and replay. Arrival order decides frames: which view was the newest when a frame began,
// what the gaze, the governor and the scene's clock said then. A recording holds exactly that,
// frame by frame; replaying it renders and encodes the same frames to the same bytes, on any number
// of threads, without a network and as fast as they are made. The file: a line "macula-recording
// 3", then blocks of a 32-bit little-endian length each: the server's description, and one a frame.
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/session/config.h"
#include "server/session/frame_job.h"
#include "shared/base/result.h"

namespace macula::kernels {
class SceneTimeline;
}

namespace macula::session {

/// Everything a frame is a function of, besides scene, kernel and configuration.
struct RecordedFrame {
  StartFrame start;  ///< scene_time is set
  bool starts_history = false;
};

struct Recording {
  std::string description;  ///< of the server that made it
  std::vector<RecordedFrame> frames;
};

/// Writes while the server runs. One thread adds.
class Recorder {
 public:
  /// Errors: the file cannot be made.
  static Result<std::unique_ptr<Recorder>> create(const std::string& path,
                                                  const std::string& description);
  /// A frame as it was rendered. What cannot be written is told once.
  void add(const FrameJob& job);

 private:
  std::ofstream file_;
  std::string path_;
  bool failed_ = false;
};

/// Errors name the file and the frame at fault. A last block that was cut off is left out.
Result<Recording> load_recording(const std::string& path);

/// What identifies an encoded frame's bytes: a hash of its directory and payloads.
std::uint64_t digest(std::span<const net::SliceEntry> slices,
                     const std::function<std::span<const std::byte>(std::size_t)>& payload);

struct ReplayedFrame {
  FrameKey key;
  std::size_t bytes = 0;
  std::uint64_t digest = 0;
};
/// Calls `frame_made` for each. Errors: those of rendering and encoding.
Result<void> replay(const Recording& recording, const ServerConfig& config,
                    std::shared_ptr<kernels::SceneTimeline> scene,
                    std::shared_ptr<const kernels::Kernel> kernel, int threads,
                    const std::function<void(const ReplayedFrame&)>& frame_made);

}  // namespace macula::session
