#include "server/scene/built_in/interior.h"

#include <cmath>
#include <utility>

#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

constexpr int kPixels = 1024;

/// Windows and text of a program, in blocks of light: what a lit screen shows.
Image screen_picture(std::uint64_t seed) {
  Field cloud = noise(kPixels / 2, {.cells = 3, .octaves = 4}, seed);
  Image picture = colored("screen", cloud, {{0.05F, 0.10F, 0.22F}, {0.20F, 0.75F, 0.60F}});
  Dice dice(seed + 1);
  const int size = kPixels / 2;
  for (int window = 0; window < 3; ++window) {
    const int left = 20 + 160 * window, top = 40 + 60 * dice.below(3), width = 140, height = 330;
    for (int y = top; y < std::min(size, top + height); ++y) {
      const int line = (y - top) / 9;
      const auto key = math::hash_combine(seed + 2, static_cast<std::uint64_t>(97 * window + line));
      const int text = static_cast<int>(110.0F * math::unit_float(key));
      for (int x = left; x < std::min(size, left + width); ++x) {
        const bool ink =
            (y - top) % 9 < 5 && x - left > 10 && x - left < 10 + text && (x / 5) % 6 != 0;
        picture.pixels(x, y) =
            ink ? image::Rgba8{235, 180, 90, 255} : image::Rgba8{18, 20, 40, 255};
      }
    }
  }
  return picture;
}

Index two_sided(SceneBuilder& b, Material material) {
  material.double_sided = true;
  return b.add(std::move(material));
}

void make_surfaces(SceneBuilder& b, InteriorMaterials& m, std::uint64_t seed) {
  m.wall = b.add(textured(
      "wallpaper",
      b.add(fabric("wallpaper", kPixels, {{0.20F, 0.27F, 0.25F}, {0.42F, 0.50F, 0.44F}}, seed))));
  m.floor = b.add(glossy(
      textured("parquet", b.add(wood("parquet", kPixels,
                                     {{0.24F, 0.13F, 0.06F}, {0.60F, 0.40F, 0.22F}}, seed + 1))),
      0.3F));
  m.plaster = b.add(lambert("ceiling", {0.80F, 0.77F, 0.71F}));
  m.moulding = b.add(lambert("mouldings", {0.74F, 0.70F, 0.62F}));
  m.wood = b.add(glossy(
      textured("walnut", b.add(wood("walnut", kPixels,
                                    {{0.20F, 0.10F, 0.05F}, {0.48F, 0.29F, 0.16F}}, seed + 2))),
      0.35F));
  m.dark_wood = b.add(glossy(lambert("dark wood", {0.10F, 0.05F, 0.03F}), 0.3F));
  m.stone = b.add(
      glossy(textured("fireplace",
                      b.add(marble("fireplace", kPixels,
                                   {{0.30F, 0.28F, 0.27F}, {0.82F, 0.79F, 0.75F}}, seed + 3))),
             0.4F));
  m.art = b.add(textured(
      "painting", b.add(marble("painting", kPixels, {{0.45F, 0.12F, 0.10F}, {0.90F, 0.78F, 0.40F}},
                               seed + 4))));
}

void make_cloth_and_paper(SceneBuilder& b, InteriorMaterials& m, std::uint64_t seed) {
  m.leather = b.add(glossy(lambert("leather", {0.20F, 0.06F, 0.035F}), 0.35F));
  m.upholstery = b.add(textured(
      "upholstery",
      b.add(fabric("upholstery", kPixels, {{0.30F, 0.34F, 0.40F}, {0.62F, 0.64F, 0.66F}}, seed))));
  m.wool = b.add(lambert("wool", {0.62F, 0.50F, 0.34F}));
  m.rug = two_sided(b, lambert("pile", {0.48F, 0.14F, 0.10F}));
  m.straw = b.add(lambert("straw", {0.56F, 0.42F, 0.22F}));
  m.curtain = two_sided(
      b,
      textured("curtain", b.add(fabric("curtain", kPixels,
                                       {{0.30F, 0.08F, 0.08F}, {0.62F, 0.28F, 0.22F}}, seed + 1))));
  m.paper = b.add(lambert("paper", {0.72F, 0.66F, 0.54F}));
  constexpr std::array<Vec3, kBookColors> kCovers{
      Vec3{0.30F, 0.04F, 0.03F}, Vec3{0.04F, 0.12F, 0.07F}, Vec3{0.05F, 0.07F, 0.20F},
      Vec3{0.32F, 0.20F, 0.07F}, Vec3{0.12F, 0.06F, 0.03F}, Vec3{0.42F, 0.38F, 0.30F}};
  for (std::size_t i = 0; i < kBookColors; ++i)
    m.covers[i] = b.add(glossy(lambert("book cover", kCovers[i]), 0.5F));
}

void make_hard_things(SceneBuilder& b, InteriorMaterials& m) {
  m.brass = b.add(metal("brass", {0.80F, 0.58F, 0.26F}, 0.25F));
  m.iron = b.add(metal("iron", {0.15F, 0.15F, 0.15F}, 0.5F));
  m.dark = b.add(glossy(lambert("dark plastic", {0.035F, 0.035F, 0.04F}), 0.35F));
  m.wax = b.add(lambert("wax", {0.84F, 0.78F, 0.64F}));
  m.glaze = b.add(glossy(lambert("glaze", {0.08F, 0.20F, 0.34F}), 0.15F));
  m.porcelain = b.add(glossy(lambert("porcelain", {0.80F, 0.79F, 0.76F}), 0.12F));
  m.glass = b.add(glossy(lambert("green glass", {0.06F, 0.14F, 0.10F}), 0.06F));
  m.night_pane = b.add(glossy(lambert("night pane", {0.010F, 0.012F, 0.020F}), 0.04F));
  m.leaf = two_sided(b, glossy(lambert("leaf", {0.06F, 0.20F, 0.05F}), 0.45F));
}

void make_glows(SceneBuilder& b, InteriorMaterials& m, std::uint64_t seed) {
  Material lit = lamp("lit screen", Rgb{2.6F});
  lit.emission_texture = TextureRef{.image = b.add(screen_picture(seed))};
  m.screen = b.add(std::move(lit));
  m.warm_glow = b.add(lamp("warm bulb", {26.0F, 17.0F, 8.0F}));
  m.red_glow = b.add(lamp("red bulb", {18.0F, 3.0F, 2.2F}));
  m.green_glow = b.add(lamp("green bulb", {4.0F, 14.0F, 4.0F}));
  m.blue_glow = b.add(lamp("blue bulb", {3.0F, 6.0F, 20.0F}));
  m.shade_glow = b.add(lamp("lamp shade", {2.6F, 1.75F, 0.85F}));
  m.flame = b.add(lamp("flame", {60.0F, 34.0F, 11.0F}));
  m.embers = b.add(lamp("embers", {9.0F, 2.4F, 0.45F}));
}

}  // namespace

InteriorMaterials make_interior_materials(SceneBuilder& b, std::uint64_t seed) {
  InteriorMaterials m{};
  make_surfaces(b, m, seed);
  make_cloth_and_paper(b, m, seed + 20);
  make_hard_things(b, m);
  make_glows(b, m, seed + 40);
  return m;
}

void place_shell(SceneBuilder& b, const InteriorMaterials& m, Shell shell) {
  b.place(std::move(shell.walls), m.wall);
  b.place(std::move(shell.floor), m.floor);
  b.place(std::move(shell.ceiling), m.plaster);
  b.place(std::move(shell.mouldings), m.moulding);
  b.place(std::move(shell.window_frames), m.moulding);
  b.place(std::move(shell.panes), m.night_pane);
}

void place_books(SceneBuilder& b, const InteriorMaterials& m, Books books, const DMat4& at) {
  for (std::size_t i = 0; i < kBookColors; ++i) {
    if (books.covers[i].triangles.empty()) continue;
    books.covers[i].name = "book covers";
    b.place(std::move(books.covers[i]), m.covers[i], at);
  }
  books.pages.name = "book pages";
  b.place(std::move(books.pages), m.paper, at);
}

void place_pile_rug(SceneBuilder& b, Index material, const DVec3& centre, double size_x,
                    double size_z, const Pile& pile, std::uint64_t seed) {
  std::array<Index, 4> patches{};
  for (std::size_t i = 0; i < patches.size(); ++i)
    patches[i] = b.add(pile_patch(pile, seed + i), material);
  const auto side = static_cast<double>(pile.side);
  const int columns = static_cast<int>(std::lround(size_x / side)),
            rows = static_cast<int>(std::lround(size_z / side));
  Dice dice(seed + 9);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const DVec3 at{side * (i + 0.5 - columns / 2.0), 0.0, side * (j + 0.5 - rows / 2.0)};
      b.place(patches[static_cast<std::size_t>(dice.below(4))],
              translation(centre + at) * rotation_y(Degrees{90.0 * dice.below(4)}));
    }
  }
  // The ground weave that the fibres stand in.
  const auto half_x = static_cast<float>(side * columns / 2.0),
             half_z = static_cast<float>(side * rows / 2.0);
  b.place(
      parallelogram("weave", {-half_x, 0.002F, half_z}, {2 * half_x, 0, 0}, {0, 0, -2 * half_z}),
      material, translation(centre));
}

}  // namespace macula::scene::built_in
