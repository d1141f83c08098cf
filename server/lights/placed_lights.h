// PlacedLights: the lights of a scene that have a place, punctual ones, emissive triangles and
// virtual ones as one list, with the tree over them and the light that arrives from any of them.
// World space, meters, linear Rec.709. Safe from any thread but while it is made; holds copies.
// Visibility is the caller's.
#pragma once

#include <span>
#include <vector>

#include "server/lights/light_list.h"
#include "server/lights/light_tree.h"
#include "server/lights/virtual_point_light.h"
#include "server/sampling/batch.h"

namespace macula::lights {

/// A light a receiver.
struct LightDraws {
  sampling::IndexBatch light;  ///< index into the list; any where nothing was drawn
  /// Of this light; 0: none was drawn.
  sampling::FloatBatch inverse_probability;
};

class PlacedLights {
 public:
  /// None.
  PlacedLights() = default;
  /// Black lights are left out.
  explicit PlacedLights(const LightList& list) { make(list); }
  /// The same in place of what was there, and virtual lights after them; keeps memory.
  void make(const LightList& list, std::span<const VirtualPointLight> virtual_lights = {});

  std::size_t size() const { return table_.size(); }
  /// Index of the first virtual light; size() without any.
  std::size_t first_virtual() const { return first_virtual_; }
  const LightTree& tree() const { return tree_; }
  /// Punctual lights that are not in the list: directional ones, which are nowhere, and those whose
  /// intensity or place cannot be ordered (not finite, negative). To be asked one by one.
  std::span<const scene::Light> apart() const { return apart_; }

  /// Light arriving at the first `count` points from their drawn lights, at u on a triangle: as
  /// LightList::arriving_area, the irradiance divided by the draw's probability. `out.light` is an
  /// index into this list, `out.normal` 0 for a lamp. `list` is what this was made from. Only where
  /// size() > 0.
  void arriving(const LightDraws& draws, const sampling::Vec2Batch& u,
                const sampling::Vec3Batch& points, std::size_t count, const LightList& list,
                const shading::SurfaceTable& surfaces, const shading::MaterialTable& materials,
                AreaArrivalBatch& out) const;

 private:
  PlacedLightTable table_;
  std::size_t first_virtual_ = 0;
  std::vector<scene::Light> apart_;
  LightTree tree_;
};

}  // namespace macula::lights
