// A court open to the sky, 24 x 9 m, with vaulted arcades of two storeys around it: fluted and
// twisted columns, arches, balustrades, curtains, planters, lanterns on chains. Curved and thin
// nearly everywhere, so that depth edges, texture detail and light vary as they do in scanned
// buildings.
#include <array>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/plants.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

using namespace atrium_parts;

constexpr int kTexturePixels = 1024;
constexpr double kHalfLength = 12.0, kHalfWidth = 4.5, kAisle = 3.0;
constexpr double kRoof = kGallery.floor + kGallery.height;

struct Materials {
  Index column, base, capital, twisted, ashlar, brick, plaster, vault, trim, court_floor,
      aisle_floor, wood, red_fabric, green_fabric, blue_fabric, carpet, leaves, grass, terracotta,
      glaze, bronze, iron, gold, water, glow, dim_glow, roof;
};

Index cloth_material(SceneBuilder& builder, const std::string& name, const Palette& palette,
                     std::uint64_t seed) {
  Material material = textured(name, builder.add(fabric(name, kTexturePixels, palette, seed)));
  material.double_sided = true;
  return builder.add(std::move(material));
}

void make_stone(SceneBuilder& b, Materials& m, std::uint64_t seed) {
  const Index white = b.add(
      marble("white marble", kTexturePixels, {{0.55F, 0.53F, 0.52F}, {0.93F, 0.91F, 0.88F}}, seed));
  const Index green = b.add(marble("green marble", kTexturePixels,
                                   {{0.10F, 0.20F, 0.17F}, {0.45F, 0.58F, 0.50F}}, seed + 1));
  m.column = b.add(glossy(textured("column", white), 0.45F));
  m.capital = b.add(glossy(textured("capital", white), 0.6F));
  m.base = b.add(glossy(textured("column base", green), 0.3F));
  m.twisted = b.add(glossy(textured("twisted column", green), 0.35F));
  const Masonry blocks{.columns = 2,
                       .courses = 4,
                       .joint = 0.02F,
                       .stone = {{0.52F, 0.46F, 0.38F}, {0.86F, 0.79F, 0.68F}},
                       .mortar = Vec3{0.62F, 0.58F, 0.50F}};
  m.ashlar = b.add(textured("ashlar", b.add(masonry("ashlar", kTexturePixels, blocks, seed + 2))));
  const Masonry bricks{.columns = 8,
                       .courses = 16,
                       .joint = 0.07F,
                       .stone = {{0.42F, 0.22F, 0.16F}, {0.75F, 0.47F, 0.36F}},
                       .mortar = Vec3{0.70F, 0.66F, 0.60F}};
  m.brick = b.add(textured("brick", b.add(masonry("brick", kTexturePixels, bricks, seed + 3))));
  m.plaster = b.add(textured(
      "ochre plaster", b.add(plaster("ochre plaster", kTexturePixels,
                                     {{0.66F, 0.50F, 0.32F}, {0.92F, 0.79F, 0.58F}}, seed + 4))));
  m.vault = b.add(
      textured("vault", b.add(plaster("pale plaster", kTexturePixels,
                                      {{0.72F, 0.70F, 0.66F}, {0.94F, 0.92F, 0.88F}}, seed + 5))));
  m.trim = b.add(glossy(lambert("trim", {0.68F, 0.63F, 0.55F}), 0.7F));
  m.roof = b.add(lambert("roof", {0.35F, 0.18F, 0.12F}));
}

void make_floors(SceneBuilder& b, Materials& m, std::uint64_t seed) {
  const Tiling court{.tiles = 4,
                     .grout = 0.02F,
                     .first = {{0.60F, 0.53F, 0.45F}, {0.90F, 0.84F, 0.75F}},
                     .second = {{0.42F, 0.28F, 0.22F}, {0.70F, 0.52F, 0.42F}}};
  m.court_floor = b.add(glossy(
      textured("court floor", b.add(tiles("court tiles", kTexturePixels, court, seed))), 0.4F));
  const Tiling aisle{.tiles = 8,
                     .grout = 0.03F,
                     .first = {{0.20F, 0.22F, 0.26F}, {0.42F, 0.45F, 0.50F}},
                     .second = {{0.70F, 0.68F, 0.64F}, {0.90F, 0.88F, 0.84F}}};
  m.aisle_floor = b.add(
      glossy(textured("aisle floor", b.add(tiles("aisle tiles", kTexturePixels, aisle, seed + 1))),
             0.35F));
  m.carpet = b.add(
      textured("carpet", b.add(carpet("carpet", kTexturePixels,
                                      {{0.30F, 0.05F, 0.08F}, {0.85F, 0.62F, 0.35F}}, seed + 2))));
  m.wood = b.add(glossy(
      textured("wood", b.add(wood("wood", kTexturePixels,
                                  {{0.22F, 0.11F, 0.05F}, {0.62F, 0.40F, 0.22F}}, seed + 3))),
      0.5F));
}

void make_soft_and_metal(SceneBuilder& b, Materials& m, std::uint64_t seed) {
  m.red_fabric =
      cloth_material(b, "red fabric", {{0.42F, 0.04F, 0.05F}, {0.85F, 0.25F, 0.18F}}, seed);
  m.green_fabric =
      cloth_material(b, "green fabric", {{0.05F, 0.22F, 0.12F}, {0.42F, 0.62F, 0.30F}}, seed + 1);
  m.blue_fabric =
      cloth_material(b, "blue fabric", {{0.06F, 0.12F, 0.36F}, {0.45F, 0.58F, 0.85F}}, seed + 2);
  m.leaves = b.add(foliage_material(
      "leaves", b.add(foliage("leaves", kTexturePixels,
                              {{0.06F, 0.18F, 0.04F}, {0.50F, 0.70F, 0.25F}}, seed + 3))));
  m.grass = b.add(foliage_material(
      "herbs", b.add(foliage("herbs", kTexturePixels,
                             {{0.12F, 0.22F, 0.10F}, {0.68F, 0.74F, 0.42F}}, seed + 4))));
  m.terracotta = b.add(lambert("terracotta", {0.58F, 0.26F, 0.15F}));
  m.glaze = b.add(glossy(lambert("blue glaze", {0.05F, 0.14F, 0.42F}), 0.12F));
  m.bronze = b.add(metal("bronze", {0.55F, 0.38F, 0.20F}, 0.35F));
  m.iron = b.add(metal("iron", {0.20F, 0.19F, 0.19F}, 0.5F));
  m.gold = b.add(metal("gold", {0.95F, 0.70F, 0.32F}, 0.22F));
  m.water = b.add(glossy(lambert("water", {0.04F, 0.16F, 0.17F}), 0.05F));
  m.glow = b.add(lamp("lantern glow", {38.0F, 24.0F, 11.0F}));
  m.dim_glow = b.add(lamp("window glow", {3.0F, 2.4F, 1.5F}));
}

/// The frames of all bays, +z towards the court: eight on each long side, three on each short one.
std::vector<DMat4> bay_frames() {
  std::vector<DMat4> frames;
  for (int i = 0; i < 8; ++i) {
    const double x = -kHalfLength + kBay * (i + 0.5);
    frames.push_back(translation({x, 0.0, -kHalfWidth}));
    frames.push_back(translation({x, 0.0, kHalfWidth}) * rotation_y(Degrees{180.0}));
  }
  for (int i = 0; i < 3; ++i) {
    const double z = -kHalfWidth + kBay * (i + 0.5);
    frames.push_back(translation({-kHalfLength, 0.0, z}) * rotation_y(Degrees{90.0}));
    frames.push_back(translation({kHalfLength, 0.0, z}) * rotation_y(Degrees{-90.0}));
  }
  return frames;
}

std::vector<DVec3> column_places() {
  std::vector<DVec3> places;
  for (int i = 0; i <= 8; ++i) {
    for (const double side : {-1.0, 1.0})
      places.emplace_back(-kHalfLength + double{kBay} * i, 0.0, side * kHalfWidth);
  }
  for (const double end : {-1.0, 1.0}) {
    for (const double z : {-1.5, 1.5}) places.emplace_back(end * kHalfLength, 0.0, z);
  }
  return places;
}

void add_columns(SceneBuilder& b, const Materials& m) {
  const Index base = b.add(column_base(), m.base);
  const Index head = b.add(capital(), m.capital);
  const Index shaft = b.add(fluted_shaft(0.38F, kGround.springing - kCapitalHeight), m.column);
  const Index slim_shaft = b.add(twisted_shaft(0.2F, kGallery.springing - 0.3F), m.twisted);
  for (const DVec3& place : column_places()) {
    b.place(base, translation(place));
    b.place(shaft, translation(place));
    b.place(head, translation(place + DVec3{0.0, kGround.springing - kCapitalHeight, 0.0}));
    const DMat4 above = translation(place + DVec3{0.0, kGallery.floor, 0.0});
    b.place(base, above * scaling(DVec3{0.62}));
    b.place(slim_shaft, above);
    b.place(head,
            above * translation({0.0, kGallery.springing - 0.32, 0.0}) * scaling(DVec3{0.71}));
  }
}

void add_arcade(SceneBuilder& b, const Materials& m, const Storey& storey, Index wall) {
  const Index face = b.add(spandrel(storey), wall);
  const Index soffit = b.add(intrados(storey), m.trim);
  const Index rings = b.add(archivolt(storey), m.capital);
  const Index ceiling = b.add(vault(storey), m.vault);
  const Index course = b.add(moulding(), m.trim);
  const DMat4 lift = translation({0.0, storey.floor, 0.0});
  for (const DMat4& frame : bay_frames()) {
    for (const Index mesh : {face, soffit, rings}) b.place(mesh, lift * frame);
    b.place(ceiling, lift * frame * translation({0.0, 0.0, -kAisle / 2.0}));
    b.place(course, lift * frame * translation({0.0, storey.height - 0.12, 0.0}));
  }
  for (const double x : {-1.0, 1.0}) {
    for (const double z : {-1.0, 1.0}) {
      b.place(ceiling, lift * translation({x * (kHalfLength + kAisle / 2.0), 0.0,
                                           z * (kHalfWidth + kAisle / 2.0)}));
    }
  }
}

void add_balustrades(SceneBuilder& b, const Materials& m) {
  const Index posts = b.add(balusters(), m.capital);
  const Index rail = b.add(rails(), m.trim);
  const DMat4 lift = translation({0.0, kGallery.floor, 0.0});
  for (const DMat4& frame : bay_frames()) {
    b.place(posts, lift * frame);
    b.place(rail, lift * frame);
  }
}

/// A horizontal rectangle that faces up.
void add_floor(SceneBuilder& b, Index material, const char* name, const Vec2& low, const Vec2& high,
               float height) {
  const Vec2 size = high - low;
  b.place(parallelogram(name, {low.x, height, high.y}, {size.x, 0, 0}, {0, 0, -size.y},
                        size / kTextureSize),
          material);
}

void add_floors(SceneBuilder& b, const Materials& m) {
  const Vec2 court(kHalfLength, kHalfWidth), outer(kHalfLength + kAisle, kHalfWidth + kAisle);
  add_floor(b, m.court_floor, "court floor", -court, court, 0.0F);
  const struct {
    float height;
    Index material;
    const char* name;
  } levels[] = {{0.0F, m.aisle_floor, "aisle floor"},
                {kGallery.floor, m.aisle_floor, "gallery floor"},
                {static_cast<float>(kRoof) + 0.1F, m.roof, "roof"}};
  for (const auto& level : levels) {
    add_floor(b, level.material, level.name, {-outer.x, court.y}, outer, level.height);
    add_floor(b, level.material, level.name, -outer, {outer.x, -court.y}, level.height);
    add_floor(b, level.material, level.name, {-outer.x, -court.y}, {-court.x, court.y},
              level.height);
    add_floor(b, level.material, level.name, {court.x, -court.y}, {outer.x, court.y}, level.height);
  }
}

void add_outer_walls(SceneBuilder& b, const Materials& m) {
  const struct {
    double angle_deg, distance, half_length;
  } walls[] = {{0, kHalfWidth + kAisle, kHalfLength + kAisle},
               {180, kHalfWidth + kAisle, kHalfLength + kAisle},
               {90, kHalfLength + kAisle, kHalfWidth + kAisle},
               {-90, kHalfLength + kAisle, kHalfWidth + kAisle}};
  const struct {
    float bottom, top;
    Index material;
  } bands[] = {{0.0F, 1.2F, m.ashlar},
               {1.2F, kGallery.floor, m.plaster},
               {kGallery.floor, static_cast<float>(kRoof), m.brick}};
  for (const auto& wall : walls) {
    for (const auto& band : bands) {
      const auto length = static_cast<float>(2.0 * wall.half_length);
      const Vec3 corner(-wall.half_length, band.bottom, -wall.distance);
      const Vec2 repeat = Vec2{length, band.top - band.bottom} / kTextureSize;
      b.place(parallelogram("outer wall", corner, {length, 0, 0}, {0, band.top - band.bottom, 0},
                            repeat),
              band.material, rotation_y(Degrees{wall.angle_deg}));
    }
  }
}

void add_doors_and_windows(SceneBuilder& b, const Materials& m) {
  const Index door = b.add(box("door", {1.3F, 2.5F, 0.12F}, 1.3F), m.wood);
  const Index window =
      b.add(parallelogram("window", {-0.35F, 0.0F, 0.0F}, {0.7F, 0, 0}, {0, 1.1F, 0}), m.dim_glow);
  int i = 0;
  for (const DMat4& frame : bay_frames()) {
    const DMat4 wall = frame * translation({0.0, 0.0, -kAisle + 0.04});
    if (i % 4 == 1) b.place(door, wall * translation({0.0, 1.25, 0.0}));
    if (i % 3 == 0) b.place(window, wall * translation({0.0, kGallery.floor + 1.0, 0.0}));
    ++i;
  }
}

void add_curtains(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  const std::array cloths{m.red_fabric, m.green_fabric, m.blue_fabric};
  const std::vector<DMat4> frames = bay_frames();
  for (std::size_t i = 0; i < 16; i += 2) {
    // Every other bay of the long sides, alternating between them.
    const std::size_t bay = i + (i / 2) % 2;
    b.place(curtain(2.3F, 3.4F, seed + i), cloths[(i / 2) % 3],
            frames[bay] * translation({0.0, kGallery.floor + 0.9, 0.30}));
  }
  for (std::size_t i = 16; i < 20; ++i) {
    b.place(curtain(2.3F, 2.9F, seed + i), cloths[i % 3],
            frames[i] * translation({0.0, 3.1, -0.5}));
  }
}

void add_plants(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  const Index container = b.add(pot(), m.terracotta);
  const std::array shrubs{b.add(shrub(44, seed), m.leaves), b.add(shrub(56, seed + 1), m.grass),
                          b.add(shrub(36, seed + 2), m.leaves)};
  for (int i = 0; i < 12; ++i) {
    const int pair = i / 2;
    const double x = -kHalfLength + 1.5 + 4.2 * pair, z = i % 2 == 0 ? -3.7 : 3.7;
    const DMat4 place = translation({x, 0.0, z}) * rotation_y(Degrees{70.0 * i});
    b.place(container, place);
    b.place(shrubs[static_cast<std::size_t>(i) % 3], place);
  }
}

void add_vases(SceneBuilder& b, const Materials& m) {
  const Index big = b.add(vase(), m.glaze), metal_vase = b.add(vase(), m.bronze);
  for (int i = 0; i < 8; ++i) {
    const double x = -9.0 + 6.0 * (i / 2), z = i % 2 == 0 ? -5.2 : 5.2;
    b.place(i % 3 == 0 ? metal_vase : big,
            translation({x, 0.0, z}) * scaling(DVec3{0.8 + 0.05 * i}));
  }
}

void add_lanterns(SceneBuilder& b, const Materials& m) {
  constexpr float kDrop = 3.2F;
  const Index links = b.add(chain(kDrop), m.iron);
  const Index cage = b.add(lantern_cage(), m.bronze), panes = b.add(lantern_panes(), m.glow);
  for (int i = 0; i < 6; ++i) {
    const double x = -10.0 + 4.0 * i;
    const DVec3 hook{x, 7.6, 0.0};
    b.place(cable({static_cast<float>(x), 8.0F, -4.4F}, {static_cast<float>(x), 8.0F, 4.4F}, 0.4F),
            m.iron);
    b.place(links, translation(hook));
    b.place(cage, translation(hook - DVec3{0.0, kDrop, 0.0}));
    b.place(panes, translation(hook - DVec3{0.0, kDrop, 0.0}));
    const DVec3 flame = hook - DVec3{0.0, kDrop + 0.75, 0.0};
    b.add(Light{.kind = LightKind::Point, .intensity = Rgb{5.0F, 3.3F, 1.7F}, .position = flame});
  }
}

void add_pennants(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  const std::array cloths{m.red_fabric, m.blue_fabric, m.green_fabric};
  for (int line = 0; line < 2; ++line) {
    const double x0 = line == 0 ? -11.0 : 11.0;
    b.place(
        cable({static_cast<float>(x0), 8.6F, -4.3F}, {static_cast<float>(-x0), 8.6F, 4.3F}, 1.2F),
        m.iron);
    for (int i = 1; i < 24; ++i) {
      const double t = i / 24.0;
      const DVec3 at{x0 * (1.0 - 2.0 * t), 8.6 - 4.8 * t * (1.0 - t), -4.3 + 8.6 * t};
      b.place(pennant(seed + static_cast<std::uint64_t>(line * 24 + i)),
              cloths[static_cast<std::size_t>(i) % 3],
              translation(at) * rotation_y(Degrees{line == 0 ? -21.0 : 21.0}));
    }
  }
}

void add_centre(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  const DMat4 place = translation({2.5, 0.0, 0.0});
  b.place(fountain_basin(), m.base, place);
  b.place(fountain_water(), m.water, place);
  b.place(sculpture(), m.gold, place * translation({0.0, 1.10, 0.0}));
  b.place(rug(2.0F, 5.0F, seed), m.carpet, translation({-4.2, 0.0, 0.0}));
  b.place(rug(1.8F, 3.6F, seed + 1), m.carpet, translation({8.5, 0.0, 0.0}));
  const Index seat = b.add(bench(), m.wood);
  for (const double x : {-7.5, -1.5, 6.0}) {
    b.place(seat, translation({x, 0.0, -3.0}));
    b.place(seat, translation({x + 1.0, 0.0, 3.0}) * rotation_y(Degrees{180.0}));
  }
}

void set_the_scene(SceneBuilder& b) {
  b.add(Light{.kind = LightKind::Directional,
              .intensity = Rgb{7.0F, 6.3F, 5.2F},
              .direction = normalize(Vec3{0.42F, -1.0F, 0.30F})});
  Settings& settings = b.settings();
  settings.ambient = Rgb{0.42F, 0.50F, 0.62F};
  settings.ambient_distance_m = 5.0;
  settings.tone = {.exposure_ev = 0.0F, .curve = image::ToneCurve::Filmic};
  // Looking down the court, along +x.
  settings.scene_from_stage = {{-7.5, 0.0, 0.4},
                               glm::angleAxis(Radians(Degrees{-90.0}).value(), DVec3{0, 1, 0})};
  b.add(
      Camera{"court", math::look_at({-7.5, 1.6, 0.4}, {2.5, 2.0, 0.0}, {0, 1, 0}), Degrees{75.0}});
  b.add(Camera{"gallery", math::look_at({-10.0, 6.7, -3.6}, {4.0, 3.0, 2.0}, {0, 1, 0}),
               Degrees{65.0}});
  b.add(
      Camera{"aisle", math::look_at({-11.0, 1.6, 6.0}, {0.0, 1.8, 5.4}, {0, 1, 0}), Degrees{70.0}});
}

}  // namespace

Scene atrium(std::uint64_t seed) {
  SceneBuilder builder("atrium");
  Materials materials{};
  make_stone(builder, materials, seed * 1000);
  make_floors(builder, materials, seed * 1000 + 100);
  make_soft_and_metal(builder, materials, seed * 1000 + 200);
  add_floors(builder, materials);
  add_outer_walls(builder, materials);
  add_doors_and_windows(builder, materials);
  add_columns(builder, materials);
  add_arcade(builder, materials, kGround, materials.ashlar);
  add_arcade(builder, materials, kGallery, materials.brick);
  add_balustrades(builder, materials);
  add_curtains(builder, materials, seed * 1000 + 300);
  add_plants(builder, materials, seed * 1000 + 400);
  add_vases(builder, materials);
  add_lanterns(builder, materials);
  add_pennants(builder, materials, seed * 1000 + 500);
  add_centre(builder, materials, seed * 1000 + 600);
  set_the_scene(builder);
  return std::move(builder).finish();
}

}  // namespace macula::scene::built_in
