// The encoder of a build without libx264.
#include "shared/codec/h264.h"

namespace macula::codec {

bool can_encode_h264() {
  return false;
}

Result<std::unique_ptr<H264Encoder>> H264Encoder::create(const H264Options&) {
  return base::bad_input("this build cannot encode H.264", "codec",
                         "jpeg or lossless; build with -DMACULA_H264=ON for h264");
}

}  // namespace macula::codec
