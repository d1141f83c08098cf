// The parts of the nave: each in its own frame, meters. A bay's frame lies on the floor in the
// middle of its arch: x along the nave, +z towards its middle.
#pragma once

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/scene.h"

namespace macula::scene::built_in::nave_parts {

inline constexpr int kBays = 8;
inline constexpr float kBay = 5.0F;        ///< distance of piers
inline constexpr float kHalfWidth = 4.5F;  ///< of the nave, to the middle of the piers
inline constexpr float kAisle = 5.0F;      ///< as wide as a bay is long: its vaults are square
/// Heights above the floor.
inline constexpr float kSpringing = 5.0F, kArcadeTop = 8.33F, kClerestory = 11.2F,
                       kVaultSpringing = 15.0F;
/// The atrium's arches at half a bay's size stand on the arcade.
inline constexpr atrium_parts::Storey kTriforium{0.0F, 1.6F, 3.1F};

Mesh clustered_pier(float radius, float height);
/// A thin round shaft on the wall, from the capitals up to the vault's ribs.
Mesh wall_shaft(float bottom, float top);
/// A bay of wall from kClerestory to kVaultSpringing with a round-headed opening.
Mesh window_wall();
Mesh tracery();
/// Half a barrel of five rows of coffers; x across, centred on the bay.
Mesh barrel_bay();
Mesh transverse_rib();
/// Flat glass with a round head: half its width, height of the straight part. Faces +z.
Mesh arched_pane(float half_width, float straight);
Mesh arched_surround(float half_width, float straight);
Mesh rose_window(float radius);
Mesh rose_tracery(float radius);
Mesh panelled_door();
Mesh apse_wall();
Mesh half_dome();
Mesh apse_floor();
Mesh altar_cloth();
Mesh crucifix();
Mesh candlestick();
inline constexpr float kCandleHeight = 0.26F;
Mesh candle();
Mesh candle_flame();
inline constexpr int kChandelierCandles = 16;
inline constexpr float kChandelierRadius = 1.1F;
/// A crown of two rings on four rods that meet 0.55 m above.
Mesh chandelier();
Mesh pew();

}  // namespace macula::scene::built_in::nave_parts
