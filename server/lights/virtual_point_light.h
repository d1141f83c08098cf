// A virtual point light: light that arrived at a small piece of diffuse surface and leaves it
// again (Keller, "Instant Radiosity", 1997). World space, meters, linear Rec.709. Plain values.
#pragma once

#include <limits>
#include <optional>

#include "server/lights/light_list.h"

namespace macula::lights {

struct VirtualPointLight {
  DVec3 position{0.0};
  /// Unit, geometric: a diffuse surface looks the same from everywhere on this side. Where it has a
  /// shading normal of its own, that acted on the light that arrived, and is in the flux.
  Vec3 normal{0.0F};
  float span_m = 0.0F;  ///< shading::Surface's, for the offset of a shadow ray's end
  Rgb flux{0.0F};  ///< W, what is reflected; intensity flux / pi times the cosine at the normal
  /// Radius of the piece of surface that it stands for; infinite where that is not known.
  float footprint_m = std::numeric_limits<float>::infinity();
};

/// As for other lights; nullopt behind it and in its plane. The irradiance is that at `least_m`, or
/// at the footprint's radius if that is less, where the light is nearer; with 0 it grows without
/// bound towards the light.
std::optional<Arrival> arriving(const VirtualPointLight& light, const DVec3& point,
                                double least_m = 0.0);

}  // namespace macula::lights
