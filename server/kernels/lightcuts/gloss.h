// Light that glossy and specular surfaces reflect once more: rays drawn as their lobes reflect, as
// many as their cells have nodes, each lit where it arrives by a cut of one node. Nothing is
// counted twice (CutPlan::gloss): what lamps and the surroundings send to the first surface, its
// lobe included, is the cuts', and a ray brings nothing that lies beyond everything. But virtual
// lights stand for what rays of glossy points meet: their cuts do without the lobe; and what
// emissive triangles shine into a lobe is shared between rays and cuts (share_of_rays). World,
// meters. A point's light depends on itself alone. Source: Shi et al., "Foveated Stochastic
// Lightcuts" (foveated path tracing of one bounce).
#pragma once

#include <span>

#include "server/kernels/lightcuts/config.h"
#include "server/kernels/lightcuts/cut_light.h"

namespace macula::kernels::lightcuts {

/// Whether any material of the scene is glossy enough, by its mean where it has a texture.
bool has_gloss(const SceneFrame& scene, const ray::Config& config);

/// Mean area of the triangles of lamps, m2; 0 without any.
float lamp_area(const SceneFrame& scene);

/// Rays of a glossy cell whose cut may have so many nodes, >= 1.
int gloss_rays(const Config& config, int nodes);

/// Rays of the tile's glossy cells.
float gloss_work(const Config& config, const SurfaceTile& tile, const CutPlan& plan);

/// Adds what comes back to slots[i] for the tile's point i; slots.size() == points.count.
void add_gloss(const SceneFrame& scene, const Config& config, const SurfaceTile& tile,
               const CutPlan& plan, ray::LightingWork& work, std::span<Rgb> slots);

}  // namespace macula::kernels::lightcuts
