// What kernel lightcuts keeps of the last frame.
#pragma once

#include <vector>

#include "server/kernels/history.h"
#include "server/kernels/lightcuts/reservoir.h"
#include "server/kernels/lightcuts/surfaces.h"
#include "server/reconstruction/light_memory.h"
#include "server/reconstruction/picture_memory.h"

namespace macula::kernels::lightcuts {

/// One view; parts are empty where the settings have no use for them.
struct KeptView {
  View view;
  ViewSurfaces surfaces;  ///< that the reservoirs are of
  image::Plane<Reservoir> reservoirs;
  reconstruction::LightMemory memory;  ///< of light
  reconstruction::PictureMemory picture;
};
struct LightHistory : HistoryRecord {
  std::vector<KeptView> views;
  scene::ScenePose pose;  ///< time and instances alone
  /// For the next frame to write to: fresh memory would be made and cleared in every frame.
  std::vector<ViewSurfaces> spare;
  std::vector<image::Plane<Reservoir>> spare_reservoirs;
};

}  // namespace macula::kernels::lightcuts
