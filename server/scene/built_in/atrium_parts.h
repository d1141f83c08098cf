// The parts of the atrium: each makes meshes in its own frame, floor at y = 0, meters. A bay's
// frame lies in the middle of its arch: x along the arcade, +z towards the court.
#pragma once

#include <cstdint>
#include <vector>

#include "server/scene/scene.h"

namespace macula::scene::built_in::atrium_parts {

inline constexpr float kBay = 3.0F;  ///< distance of columns
inline constexpr float kArchRadius = 1.25F;
inline constexpr float kWallThickness = 0.5F;
inline constexpr float kTextureSize = 2.0F;  ///< meters a texture covers

/// Heights of a storey, above its floor.
struct Storey {
  float floor = 0.0F;      ///< above the ground
  float springing = 0.0F;  ///< where arches and vaults begin, on top of the columns
  float height = 0.0F;
};
inline constexpr Storey kGround{0.0F, 3.0F, 5.0F};
inline constexpr Storey kGallery{5.0F, 2.3F, 4.3F};

// Architecture.
Mesh fluted_shaft(float bottom, float top);
Mesh twisted_shaft(float bottom, float top);
Mesh column_base();
/// Bell and abacus, from y = 0 to kCapitalHeight.
inline constexpr float kCapitalHeight = 0.45F;
Mesh capital();
Mesh spandrel(const Storey& storey);
Mesh intrados(const Storey& storey);
Mesh archivolt(const Storey& storey);
Mesh vault(const Storey& storey);
/// A row of eggs and a string course along one bay.
Mesh moulding();
Mesh balusters();
Mesh rails();

// Furnishing.
Mesh vase();
Mesh pot();
/// Sprigs that arch outwards: bent cards for an alpha-masked texture.
Mesh shrub(int sprigs, std::uint64_t seed);
/// A curtain hanging from y = 0 down, in folds; `width` along x.
Mesh curtain(float width, float length, std::uint64_t seed);
/// A chain hanging down from the origin.
Mesh chain(float length);
/// A lantern's metal cage, its top at the origin; the light inside is lantern_panes().
Mesh lantern_cage();
Mesh lantern_panes();
/// A cable that sags between two points.
Mesh cable(const Vec3& from, const Vec3& to, float sag);
Mesh pennant(std::uint64_t seed);
Mesh fountain_basin();
Mesh fountain_water();
/// A torus knot: thin, curved and often in front of itself.
Mesh sculpture();
Mesh rug(float width, float length, std::uint64_t seed);
Mesh bench();

}  // namespace macula::scene::built_in::atrium_parts
