// The encode stage: rendered buffers become a frame for the wire, colour and depth per eye, with
// everything the frame was made with in its header. What it remembers from frame to frame lies in
// the job's EncodeMemory. Called by the encode thread only; the eyes run side by side where a core
// is idle.
#pragma once

#include <optional>
#include <vector>

#include "server/scheduling/tile_scheduler.h"
#include "server/session/config.h"
#include "server/session/frame_job.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"

namespace macula::session {

class EncodeStage {
 public:
  EncodeStage(const ServerConfig& config, const base::Clock& clock)
      : config_(config), clock_(clock), threads_(config.encode_threads) {}

  /// Sets job.encode_end. The endpoint adds the send stamps of the frame before. Errors: the
  /// codecs'.
  Result<net::EncodedFrame> encode(FrameJob& job);

 private:
  struct Eye {
    image::Plane<Rgb8> tone_mapped;
    Result<codec::Bytes> color = codec::Bytes{};
    bool is_key = true;  ///< its colour leans on no other frame
    Result<codec::EncodedDepth> depth = codec::EncodedDepth{};
    std::optional<HiddenShare::Coded> hidden;  ///< the second layer, where there is one
    Nanoseconds cpu{0};
  };
  /// What the eyes of one frame have in common.
  struct Plan {
    net::SliceCodec codec = net::SliceCodec::Jpeg;
    int jpeg_quality = 85;
    codec::H264Encoder::FrameWish h264;
    bool sees_saccade = false;
  };
  Plan plan(const FrameJob& job) const;
  void encode_eye(const FrameJob& job, const Plan& plan, std::size_t index);
  void encode_color(const FrameJob& job, const Plan& plan, std::size_t index);
  Result<void> encode_hidden(const FrameJob& job, const Plan& plan, std::size_t index);
  void encode_h264(const FrameJob& job, const Plan& plan, std::size_t index);
  net::FrameBegin frame_begin(const FrameJob& job) const;
  void append_hidden(const Plan& plan, std::size_t index, net::EncodedFrame& frame);
  void append_eye(const FrameJob& job, const Plan& plan, std::size_t index,
                  net::EncodedFrame& frame);
  void remember(FrameJob& job, const Plan& plan, net::FrameBegin& begin);

  const ServerConfig& config_;
  const base::Clock& clock_;
  scheduling::TileScheduler threads_;
  std::vector<Eye> eyes_;  ///< of the frame being encoded
};

}  // namespace macula::session
