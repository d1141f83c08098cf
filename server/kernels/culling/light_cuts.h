// Virtual lights by cuts of a light tree in the place of culling: every cell asks a light of every
// node of a cut of its own, larger where the importance map says so. Unbiased for any cut.
#pragma once

#include "server/kernels/culling/config.h"
#include "server/kernels/kernel.h"
#include "server/lights/light_tree.h"

namespace macula::kernels::culling {

/// Over virtual lights, each a point that shines to its normal's side by the cosine.
lights::LightTree tree_over(std::span<const lights::VirtualPointLight> lights);

/// Nodes of each cell's cut, in proportion to the importance told for every `step`-th cell each
/// way: about `mean` on average, at least 1 and at most `most`.
image::Plane<std::uint16_t> cut_sizes(const PixelGrid& grid, const image::Plane<float>& importance,
                                      int step, double mean, int most);

}  // namespace macula::kernels::culling
