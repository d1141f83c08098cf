// The decoder of a build without libavcodec.
#include "shared/codec/h264.h"

namespace macula::codec {

bool can_decode_h264() {
  return false;
}

Result<std::unique_ptr<H264Decoder>> H264Decoder::create() {
  return base::bad_input("this build cannot decode H.264", "codec",
                         "jpeg or lossless; build with -DMACULA_H264=ON for h264");
}

}  // namespace macula::codec
