// The planes of a still as pictures. One EXR holds the beauty as R, G, B and every plane asked for
// as a layer of its own (depth.Z in meters, normal.X .Y .Z, albedo.R .G .B, id.Y, rate.Y,
// samples.Y, variance.Y); a PNG a plane shows it to people, with a bar that says what the colours
// mean.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "tests/bench/still_job.h"

namespace macula::bench {

struct StillLayer {
  StillPlane plane = StillPlane::Depth;
  std::string name;
  /// Full names such as "depth.Z".
  std::vector<std::pair<std::string, image::Plane<float>>> channels;
};

/// Every cell of the grid drawn where the display's pixels see it; a uniform grid is copied.
image::Plane<Rgb> radiance_on_display(const StillJob& job, const RenderedStill& rendered);
std::vector<StillLayer> make_layers(const StillOptions& options, const StillJob& job,
                                    const RenderedStill& rendered);

/// Scalars in false colour over a bar with its values (from the 1st to the 99th percentile, what
/// lies beyond is clamped; variance in decades), surfaces in colours hashed from their ids, normals
/// from [-1, 1].
image::Plane<Rgb8> picture_of(const StillLayer& layer);

/// R, G, B and every layer, one file.
Result<void> write_layered_exr(const std::string& path, const image::Plane<Rgb>& radiance,
                               const std::vector<StillLayer>& layers);

}  // namespace macula::bench
