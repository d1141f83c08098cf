// Threads, fibres and cloth, modelled strand by strand, on y = 0 or about the origin, meters.
#pragma once

#include <cstdint>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

struct Pile {
  float side = 0.5F;  ///< m of a square patch
  int fibres = 3000;
  float length = 0.035F;  ///< m
  float width = 0.004F;   ///< m at the root
};
/// A patch of a pile rug: fibres of three triangles that lean in tufts (a two-sided material);
/// at its edges fibres hang over.
Mesh pile_patch(const Pile& pile, std::uint64_t seed);

/// A knitted blanket of `columns` x `rows` stitches of yarn, hanging over an edge along x at
/// z = 0: its middle lies at the origin, one half on top towards -z, the other down.
Mesh knitted_blanket(float width, float length, int columns, int rows);

/// A round basket of stakes and woven rounds.
Mesh wicker_basket(float radius, float height);

/// A pillow: thick in the middle, pointed at its corners, a piped seam around.
Mesh cushion(const Vec3& half_size, int columns, int rows);

}  // namespace macula::scene::built_in
