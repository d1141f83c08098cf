// OpenEXR in and out: linear radiance and named float planes, 32 bits a channel, never clamped. NaN
// and infinity pass through as they are. Reading checks the size before allocating. The only
// includer of OpenEXR; its exceptions end here. Safe to call from several threads on different
// files.
#pragma once

#include <span>
#include <string>

#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::exr {

using image::Plane;

/// The data window of the first part, channels R, G, B (or Y alone as grey), half, float or uint;
/// other channels are ignored. Refuses deep and sub-sampled pictures and sides above `max_side_px`.
Result<Plane<Rgb>> read(const std::string& path, int max_side_px = 16384);

/// Channels R, G, B as float, zip compression, chromaticities Rec.709. Overwrites.
Result<void> write(const std::string& path, const Plane<Rgb>& radiance);

/// One channel of a picture, e.g. {"depth.Z", &depth_m}; a dot separates layer and channel.
struct NamedPlane {
  std::string name;
  const Plane<float>* values = nullptr;
};
/// At least one plane, all of one size, names unique and not empty. Overwrites.
Result<void> write_layers(const std::string& path, std::span<const NamedPlane> planes);

}  // namespace macula::exr
