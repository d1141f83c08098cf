// Town houses of the city: facades of window bays with frames, sills, hoods, shutters, balconies,
// shops and cornices under tiled or flat roofs. A house stands on y = 0, centred on the origin,
// meters. Made piece by piece for each house, so that no two need share a triangle.
#pragma once

#include <array>
#include <cstdint>

#include "server/scene/built_in/random.h"
#include "server/scene/scene.h"

namespace macula::scene::built_in::city {

inline constexpr float kBay = 3.0F, kFloor = 3.2F, kGroundFloor = 3.8F;

/// A house is one mesh for each of what it is made of.
enum Part { Wall, Trim, Frame, Glass, Blinds, Shutter, Roof, Iron, Cloth, kParts };
using House = std::array<Mesh, kParts>;

enum class RoofKind { Tiled, Flat };
enum class Shutters { None, Louvred };
struct Plan {
  int bays_x = 5, bays_z = 4;
  int floors = 5;  ///< above the ground floor
  RoofKind roof = RoofKind::Tiled;
  Shutters shutters = Shutters::None;
  float balcony_share = 0.15F;  ///< of windows
  float shop_share = 0.4F;      ///< of ground-floor bays
  std::uint64_t seed = 0;
};
Plan draw_plan(Dice& dice);

/// The pieces every house takes copies of; made once.
struct Kit {
  Mesh window_wall, shop_wall, door_wall;                   // Wall
  Mesh hood, sill, string_course, cornice, quoin, door;     // Trim
  Mesh window_frame, shop_frame;                            // Frame
  Mesh window_glass, shop_glass;                            // Glass
  Mesh shutter;                                             // Shutter, one leaf hinged at x = 0
  Mesh balcony, drainpipe, air_conditioner, antenna, tank;  // Iron
  Mesh awning;                                              // Cloth
};
Kit make_kit();
House make_house(const Kit& kit, const Plan& plan);

}  // namespace macula::scene::built_in::city
