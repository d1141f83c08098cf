// Tone: the one place where scene radiance becomes display values and back. exposure, then a curve,
// then the sRGB transfer function, then 8 bits. A channel that is not finite or negative encodes as 0.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::image {

/// Linear clips at 1; Filmic is the ACES fit of Narkowicz (2015), monotone, 0 -> 0.
enum class ToneCurve { Linear, Filmic };

struct Tone {
  float exposure_ev = 0.0F;  ///< radiance is multiplied by 2^exposure_ev
  ToneCurve curve = ToneCurve::Linear;
  friend bool operator==(const Tone&, const Tone&) = default;
};

/// IEC 61966-2-1, [0, 1] -> [0, 1]; input is clamped.
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);

/// Exposure and curve only: display-linear [0, 1].
Rgb display_linear(const Tone& tone, const Rgb& radiance);
Rgb8 encode(const Tone& tone, const Rgb& radiance);
/// Whole planes; `out` takes the size of `radiance`. Equal to encode() pixel by pixel.
void encode(const Tone& tone, const Plane<Rgb>& radiance, Plane<Rgb8>& out);
/// sRGB 8 bit -> display-linear [0, 1].
Plane<Rgb> decode_display_linear(const Plane<Rgb8>& encoded);

}  // namespace macula::image
