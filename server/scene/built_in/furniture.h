// Furniture of the study and the room: each stands on y = 0, its front towards +z, centred in x,
// meters. A piece of several materials is a struct of meshes.
#pragma once

#include <array>
#include <cstdint>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

inline constexpr std::size_t kBookColors = 6;
struct Books {
  std::array<Mesh, kBookColors> covers;
  Mesh pages;
};
/// A row of upright books along x from 0 to about `width`, backs at z = 0 towards +z; some lean.
Books row_of_books(float width, float height, std::uint64_t seed);
/// A lying pile of `count` books.
Books pile_of_books(int count, std::uint64_t seed);
void append(Books& books, const Books& more, const DMat4& at);

/// Open shelves with pilasters and a cornice; the boards' tops are where shelf_height() says.
inline constexpr int kShelves = 6;
float shelf_height(int shelf);
Mesh bookcase(float width);

struct Armchair {
  Mesh leather, legs;
};
/// Deep-buttoned back and rolled arms.
Armchair armchair(float seat_width);
Mesh desk();
/// A slab on four turned legs.
Mesh table(float width, float depth, float height);
struct Chair {
  Mesh wood, seat;
};
/// Bentwood with a woven seat.
Chair chair();
Mesh keyboard();
Mesh globe_ball();
Mesh globe_stand();
Mesh picture_frame(float width, float height);
/// A surround of stone with a mantel; the fire lies at the origin.
Mesh fireplace();
Mesh fire_irons();
/// Broad modelled leaves on stalks around a pot's middle.
Mesh leafy_plant(int leaves, float size, std::uint64_t seed);
Mesh plant_pot(float radius);
Mesh plate();
Mesh wine_glass();
Mesh bowl();
/// The case of an upright, and its keys on it.
Mesh piano();
Mesh white_keys();
Mesh black_keys();

}  // namespace macula::scene::built_in
