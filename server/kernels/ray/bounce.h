// Light of one more bounce: what lamps send to the places that rays meet, and these send back along
// the rays. What they emit themselves is not of it, nor what an environment or the ambient light
// does there.
#pragma once

#include <span>

#include "server/kernels/ray/lighting.h"

namespace macula::kernels::ray {

/// Traces the rays into `hits` and tells the radiance that comes back along each; black where it
/// meets nothing. Directions are unit. keys[i] is the identity of ray i's random numbers;
/// radiance.size() == keys.size() == rays.count.
void bounce(const visibility::RayStream& rays, std::span<const sampling::SampleKey> keys,
            const SceneFrame& scene, const Config& config, visibility::HitStream& hits,
            std::span<Rgb> radiance, LightingWork& work);

/// The settings that bounce() lights with.
Config lamps_alone(const Config& config);

}  // namespace macula::kernels::ray
