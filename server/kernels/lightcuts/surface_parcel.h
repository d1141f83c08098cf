// What tracing a tile of surfaces leaves behind, on its way to another rank: only what cannot be
// told there from the rest of it.
#pragma once

#include "server/kernels/lightcuts/surfaces.h"

namespace macula::kernels::lightcuts {

/// Where the tile lies, and the planes that were written with it.
struct TilePlanes {
  const FrameRequest& request;
  const PixelGrid& grid;
  ViewBuffers& out;
};

void carry(SurfaceTile& tile, const TilePlanes& planes, Parcel& parcel);

}  // namespace macula::kernels::lightcuts
