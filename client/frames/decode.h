// Decoding received frames: colour and inverse depth of every eye, eyes in parallel. The directory
// was checked against limits by shared/net; what the payloads hold is checked here by the codecs.
// H.264 frames lean on the ones before them, so a decoder sees all of them in order and never shows
// one whose reference it did not decode.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "client/frames/frame_order.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/codec/h264.h"
#include "shared/codec/hidden_layer.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/net/client_endpoint.h"

namespace macula::frames {

/// One eye's pictures, cell by cell on the grid of begin.views[eye].
struct DecodedEye {
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth_per_m;  ///< 0 = nothing there
  /// What that hides; meaningful where its mask is 1.
  std::optional<codec::HiddenLayerPlanes> hidden{};
};

struct DecodedFrame {
  net::FrameBegin begin;
  net::FrameEnd end;
  std::vector<DecodedEye> eyes;  ///< as many as begin.views
  ClientTime first_byte, last_byte, decoded;
  std::uint64_t bytes = 0;  ///< payloads
  Nanoseconds cpu{0};       ///< what decoding cost, over all eyes

  FrameId id() const { return {begin.epoch, begin.frame}; }
};

/// Delays for tests that show where time goes; zero in production.
struct DecodeOptions {
  Nanoseconds delay{0};
};

/// The frames of one connection after another. One thread calls.
class FrameDecoder {
 public:
  explicit FrameDecoder(const base::Clock& clock, const DecodeOptions& options = {})
      : clock_(clock), options_(options) {}

  /// Errors name the frame and the slice; what leans on the failed frame fails too, until a key
  /// frame comes. An eye's colour must cover its grid; without a depth slice everything is
  /// infinitely far. Layers beyond the second are passed over.
  Result<DecodedFrame> decode(net::ReceivedFrame received);

 private:
  Result<void> check_reference(const net::FrameBegin& begin) const;

  const base::Clock& clock_;
  const DecodeOptions options_;
  std::optional<FrameId> last_;                            ///< decoded
  std::vector<std::unique_ptr<codec::H264Decoder>> h264_;  ///< by eye, made when needed
};

}  // namespace macula::frames
