// Shading points: the places of a picture whose light decides which virtual lights are kept. Pure.
#pragma once

#include <vector>

#include "server/kernels/culling/config.h"
#include "server/sampling/sample.h"
#include "shared/image/plane.h"

namespace macula::kernels::culling {

/// `count` cells, each with probability proportional to its importance; some may repeat, none is of
/// importance 0. Where all importance is 0, none. One random number spreads them evenly along the
/// Morton curve of cells.
std::vector<image::Pixel> draw_systematically(const image::Plane<float>& importance, int count,
                                              float u);
/// The printed way: each the most important of `chain` cells drawn alike.
std::vector<image::Pixel> draw_by_chains(const image::Plane<float>& importance, int count,
                                         int chain, sampling::SampleKey key);

}  // namespace macula::kernels::culling
