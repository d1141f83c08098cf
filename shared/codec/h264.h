// H.264 colour: libx264 encodes, libavcodec decodes, one encoder and one decoder an eye. Frames
// lean on the ones before them, so every frame encoded must be decoded, in order; a key frame
// starts anew. 4:2:0, full-range BT.709, no delay, one slice, no threads: the same pictures give
// the same bytes. A build with MACULA_H264=OFF has neither and says so.
//
// The coded picture (the canvas) is larger than the frame, by what keeps its size at rest while the
// gaze moves: it grows at once and shrinks at most every two seconds, each time with a key frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "shared/codec/color.h"
#include "shared/units/time.h"

namespace macula::codec {

/// Of this build.
bool can_encode_h264();
bool can_decode_h264();

/// A square of luma samples that has one quantiser.
inline constexpr int kMacroblockPx = 16;

struct H264Options {
  /// Superfast takes about twice the time of Ultrafast and gives 1 to 4 dB for it at equal bytes.
  enum class Effort { Ultrafast, Superfast };
  Effort effort = Effort::Ultrafast;
  int refresh_frames = 36;  ///< a wave of intra blocks has passed over the picture after so many
};

class H264Encoder {
 public:
  enum class Kind { Delta, Key };
  struct FrameWish {
    Kind kind = Kind::Delta;     ///< Key where the receiver has lost a frame
    double quantiser = 23.0;     ///< x264's rate factor, 0..51; 6 more halve the bytes, about
    std::size_t most_bytes = 0;  ///< of one frame, on average over two; 0: no bound
    /// What this frame leaves of its bytes is kept for the next ones, and it may take what was kept:
    /// up to twice its own. For a saccade and its landing, and after a step of the grid.
    enum class Burst { No, Yes };
    Burst burst = Burst::No;
    /// Added to the quantiser, row by row of the frame's own macroblocks (rounded up); empty: none.
    std::span<const float> quantiser_offsets{};
    Nanoseconds now{0};  ///< of any clock that does not go back; for resting the canvas
  };
  struct Coded {
    Bytes bytes;
    Kind kind = Kind::Key;
  };

  /// Errors: this build has none.
  static Result<std::unique_ptr<H264Encoder>> create(const H264Options& options);
  virtual ~H264Encoder() = default;
  /// Errors: a picture that is empty or over 8192 a side, a wish out of range, x264's own; the next
  /// frame is then a key frame.
  virtual Result<Coded> encode(const image::Plane<Rgb8>& picture, const FrameWish& wish) = 0;
};

class H264Decoder {
 public:
  /// Errors: this build has none.
  static Result<std::unique_ptr<H264Decoder>> create();
  virtual ~H264Decoder() = default;
  /// Into `rect` of `picture`, which has its size. An Error when the bytes are damaged or lean on a
  /// frame that never came; the next frame must then be a key frame.
  virtual Result<void> decode(std::span<const std::byte> bytes, const image::Rect& rect,
                              image::Plane<Rgb8>& picture) = 0;
};

}  // namespace macula::codec
