// From the middle level to the cells that were not traced: colours between its samples, everything
// else from the nearest. Pure functions of their inputs.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/levels.h"
#include "server/scheduling/row_bands.h"

namespace macula::kernels::sphere {

/// Gives Average cells of the middle level the means of their own, finished cells. `planes` holds
/// every important cell.
void average_important(const ViewBuffers& planes, unsigned wanted, TileScheduler& scheduler,
                       MidLevel& mid);

/// Draws every cell of these bands that is not important, and of the rows beside them, which
/// softening reads.
void fill_unimportant(const PixelGrid& grid, const PixelGrid& mid_grid,
                      const Plane<std::uint8_t>& important, const MidLevel& mid, unsigned wanted,
                      scheduling::RowBands& bands, ViewBuffers& planes);

/// Transition::Gaussian: 3 x 3 Gaussian (sigma about 0.85 cells) over cells that have a neighbour
/// of the other importance, outside the fovea's interior.
void soften_transitions(const Plane<std::uint8_t>& important, scheduling::RowBands& bands,
                        Plane<Rgb>& radiance);

}  // namespace macula::kernels::sphere
