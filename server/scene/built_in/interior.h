// What the furnished rooms share: their materials, and how things of several meshes are placed.
#pragma once

#include <array>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/room_shell.h"
#include "server/scene/built_in/textiles.h"

namespace macula::scene::built_in {

struct InteriorMaterials {
  Index wall, floor, plaster, moulding, wood, dark_wood, leather, upholstery, wool, rug, straw,
      curtain, brass, iron, dark, stone, wax, paper, glaze, porcelain, glass, night_pane, leaf, art;
  std::array<Index, kBookColors> covers;
  /// What shines; radiance per material.
  Index screen, warm_glow, red_glow, green_glow, blue_glow, shade_glow, flame, embers;
};
InteriorMaterials make_interior_materials(SceneBuilder& builder, std::uint64_t seed);

void place_shell(SceneBuilder& builder, const InteriorMaterials& materials, Shell shell);
void place_books(SceneBuilder& builder, const InteriorMaterials& materials, Books books,
                 const DMat4& at);
/// Patches of pile side by side over `size_x` by `size_z` meters, four different ones turned about.
void place_pile_rug(SceneBuilder& builder, Index material, const DVec3& centre, double size_x,
                    double size_z, const Pile& pile, std::uint64_t seed);

}  // namespace macula::scene::built_in
