// HiddenShare: the second layer of an eye within a quarter of a frame's bytes, for it is seen for a
// moment and beside what the eye looks at. What gives way: first the quality of its colours, then
// whole tiles, those with the fewest cells first. One eye of one epoch; one thread at a time.
#pragma once

#include <optional>

#include "server/disocclusion/hidden_layer.h"
#include "shared/base/result.h"
#include "shared/codec/hidden_layer.h"
#include "shared/image/tone.h"

namespace macula::session {

/// The quality at which JPEG would have met the bytes, from what it made at `quality`; bytes double
/// in about 20 steps. Up by at most 5 steps, down by 25, never below 10.
double next_jpeg_quality(double quality, double bytes, double wanted);

class HiddenShare {
 public:
  static constexpr double kMost = 0.25;  ///< of an eye's bytes so far

  struct Coded {
    codec::EncodedHiddenLayer coded;
    image::Rect atlas;
    std::size_t cells = 0;
  };

  /// The first layer's bytes; before each frame's encode().
  void note_seen(std::size_t bytes);
  /// nullopt: nothing of it is small enough. `options`: the best that is wanted; what is lossless
  /// is not bounded. Errors: the codecs'.
  Result<std::optional<Coded>> encode(const disocclusion::HiddenLayer& layer,
                                      const image::Tone& tone, const codec::ColorOptions& options);
  std::size_t last_bytes() const { return last_bytes_; }  ///< of the frame before; 0: none

 private:
  void give_way(double room, double least_quality);
  void recover(double room, double most_quality);

  /// Smoothed, for what leans on other frames is uneven; from 0 on, so that its sum over frames is
  /// never more than theirs.
  double seen_bytes_ = 0.0;
  double quality_ = 0.0;  ///< 0: not sought yet
  double kept_ = 1.0;     ///< of the tiles
  std::size_t last_bytes_ = 0;
  image::Plane<Rgb8> tone_mapped_;
};

}  // namespace macula::session
