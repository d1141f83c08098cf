// What encoding remembers of one epoch of a session: the encoders, and what the last frame was.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/session/hidden_share.h"
#include "shared/codec/h264.h"
#include "shared/foveation/pixel_grid.h"

namespace macula::session {

struct EncodeMemory {
  struct Eye {
    std::unique_ptr<codec::H264Encoder> h264;  ///< made when first needed
    PixelGrid grid;                            ///< of the frame before
    HiddenShare hidden;
  };
  std::vector<Eye> eyes;
  std::uint64_t last_frame = 0;  ///< encoded as H.264 and whole: what the next may lean on; 0: none
  bool was_saccade = false;      ///< the frame before fell into one
  double jpeg_quality = 0.0;     ///< that met the bytes last; 0: not sought yet
};

}  // namespace macula::session
