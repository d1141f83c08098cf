// Decoding a received frame: colour and inverse depth of every eye, eyes in parallel. The directory
// was checked against limits by shared/net; what the payloads hold is checked here by the codecs.
#pragma once

#include <cstdint>
#include <vector>

#include "client/frames/frame_order.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/net/client_endpoint.h"

namespace macula::frames {

/// One eye's pictures, cell by cell on the grid of begin.views[eye].
struct DecodedEye {
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth_per_m;  ///< 0 = nothing there
};

struct DecodedFrame {
  net::FrameBegin begin;
  net::FrameEnd end;
  std::vector<DecodedEye> eyes;  ///< as many as begin.views
  ClientTime first_byte, last_byte, decoded;
  std::uint64_t bytes = 0;  ///< payloads

  FrameId id() const { return {begin.epoch, begin.frame}; }
};

/// Delays for tests that show where time goes; zero in production.
struct DecodeOptions {
  Nanoseconds delay{0};
};

/// Errors name the frame and the slice. An eye's colour must cover its grid; without a depth slice
/// everything is infinitely far. Layers beyond the first are passed over.
Result<DecodedFrame> decode(net::ReceivedFrame received, const base::Clock& clock,
                            const DecodeOptions& options = {});

}  // namespace macula::frames
