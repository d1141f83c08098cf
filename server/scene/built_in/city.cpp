// A town of 96 houses on a grid of streets, about 300 x 270 m, seen from a crossing: depth edges
// everywhere, from the window bars across the street to roofs at the horizon (the place of Rungholt
// among the papers' scenes). In `city` every house is built for itself; `city-instanced` puts
// copies of twelve of them on the same lots.
#include <array>
#include <cmath>
#include <optional>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/city_building.h"
#include "server/scene/built_in/city_street.h"
#include "server/scene/built_in/plants.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

using namespace city;

constexpr int kLotsX = 10, kLotsZ = 10;
constexpr double kPitchX = 30.0, kPitchZ = 27.0;  // m from lot to lot
constexpr double kLotX = 21.0, kLotZ = 18.0;      // m of pavement; the rest is street
constexpr float kKerb = 0.14F;
constexpr int kWalls = 6, kRoofs = 2, kPaints = 5;

struct Materials {
  std::array<Index, kWalls> walls;
  std::array<Index, kRoofs> roofs;
  std::array<Index, kPaints> paints;
  std::array<Index, 2> shutters, cloths;
  Index trim, frame, glass, blinds, iron, tyre, asphalt, paving, line, globe, bark, leaves, grass,
      wood, stone, water;
};

std::array<Index, kWalls> make_walls(SceneBuilder& b, std::uint64_t seed) {
  constexpr int kPixels = 512;
  const auto stucco = [&](const char* name, const Palette& palette, std::uint64_t s) {
    return b.add(textured(name, b.add(plaster(name, kPixels, palette, s))));
  };
  const auto brick = [&](const char* name, const Palette& palette, std::uint64_t s) {
    const Masonry bricks{.columns = 8,
                         .courses = 32,
                         .joint = 0.08F,
                         .stone = palette,
                         .mortar = Vec3{0.66F, 0.62F, 0.56F}};
    return b.add(textured(name, b.add(masonry(name, 2 * kPixels, bricks, s))));
  };
  const Masonry blocks{.columns = 4,
                       .courses = 8,
                       .joint = 0.02F,
                       .stone = {{0.55F, 0.50F, 0.42F}, {0.84F, 0.78F, 0.68F}},
                       .mortar = Vec3{0.55F, 0.51F, 0.45F}};
  return {stucco("ochre stucco", {{0.68F, 0.52F, 0.30F}, {0.93F, 0.80F, 0.56F}}, seed),
          stucco("rose stucco", {{0.68F, 0.42F, 0.36F}, {0.92F, 0.72F, 0.64F}}, seed + 1),
          stucco("white stucco", {{0.70F, 0.68F, 0.63F}, {0.95F, 0.94F, 0.90F}}, seed + 2),
          brick("red brick", {{0.38F, 0.17F, 0.12F}, {0.68F, 0.38F, 0.28F}}, seed + 3),
          brick("brown brick", {{0.30F, 0.21F, 0.15F}, {0.58F, 0.44F, 0.33F}}, seed + 4),
          b.add(textured("sandstone", b.add(masonry("sandstone", kPixels, blocks, seed + 5))))};
}

void make_house_materials(SceneBuilder& b, Materials& m, std::uint64_t seed) {
  m.walls = make_walls(b, seed);
  const auto tiled = [&](const char* name, const Palette& palette, std::uint64_t s) {
    return b.add(textured(name, b.add(plaster(name, 512, palette, s))));
  };
  m.roofs = {tiled("terracotta", {{0.40F, 0.20F, 0.13F}, {0.66F, 0.40F, 0.29F}}, seed + 6),
             tiled("slate", {{0.20F, 0.21F, 0.24F}, {0.42F, 0.43F, 0.46F}}, seed + 7)};
  const auto two_sided = [&b](const char* name, const Rgb& color) {
    Material material = lambert(name, color);
    material.double_sided = true;
    return b.add(std::move(material));
  };
  m.shutters = {two_sided("green shutters", {0.08F, 0.22F, 0.14F}),
                two_sided("blue shutters", {0.12F, 0.20F, 0.34F})};
  m.cloths = {two_sided("red awning", {0.55F, 0.07F, 0.05F}),
              two_sided("striped awning", {0.62F, 0.56F, 0.44F})};
  m.trim = b.add(lambert("trim", {0.72F, 0.68F, 0.60F}));
  m.frame = b.add(glossy(lambert("frames", {0.78F, 0.77F, 0.74F}), 0.4F));
  m.glass = b.add(glossy(lambert("glass", {0.03F, 0.04F, 0.05F}), 0.05F));
  m.blinds = b.add(lambert("drawn blinds", {0.62F, 0.56F, 0.44F}));
  m.iron = b.add(metal("iron", {0.16F, 0.16F, 0.17F}, 0.5F));
}

void make_street_materials(SceneBuilder& b, Materials& m, std::uint64_t seed) {
  m.paints = {b.add(glossy(lambert("red paint", {0.50F, 0.03F, 0.03F}), 0.12F)),
              b.add(glossy(lambert("white paint", {0.78F, 0.78F, 0.76F}), 0.12F)),
              b.add(glossy(lambert("blue paint", {0.03F, 0.08F, 0.30F}), 0.12F)),
              b.add(glossy(lambert("black paint", {0.02F, 0.02F, 0.02F}), 0.08F)),
              b.add(glossy(lambert("silver paint", {0.42F, 0.43F, 0.44F}), 0.18F))};
  m.tyre = b.add(glossy(lambert("tyre", {0.03F, 0.03F, 0.03F}), 0.6F));
  m.asphalt = b.add(textured(
      "asphalt",
      b.add(plaster("asphalt", 1024, {{0.22F, 0.22F, 0.23F}, {0.44F, 0.43F, 0.42F}}, seed))));
  const Tiling slabs{.tiles = 8,
                     .grout = 0.03F,
                     .first = {{0.50F, 0.48F, 0.45F}, {0.70F, 0.68F, 0.64F}},
                     .second = {{0.54F, 0.52F, 0.48F}, {0.74F, 0.71F, 0.66F}}};
  m.paving = b.add(textured("paving", b.add(tiles("paving", 512, slabs, seed + 1))));
  m.line = b.add(lambert("road paint", {0.78F, 0.77F, 0.72F}));
  m.globe = b.add(glossy(lambert("lamp globe", {0.80F, 0.79F, 0.75F}), 0.15F));
  m.bark = b.add(textured(
      "bark", b.add(wood("bark", 512, {{0.16F, 0.12F, 0.09F}, {0.42F, 0.34F, 0.27F}}, seed + 2))));
  m.leaves = b.add(foliage_material(
      "leaves",
      b.add(foliage("leaves", 512, {{0.06F, 0.20F, 0.04F}, {0.42F, 0.62F, 0.22F}}, seed + 3))));
  m.grass = b.add(textured(
      "lawn",
      b.add(plaster("lawn", 512, {{0.10F, 0.24F, 0.06F}, {0.38F, 0.54F, 0.20F}}, seed + 4))));
  m.wood = b.add(lambert("bench wood", {0.32F, 0.18F, 0.09F}));
  m.stone = b.add(lambert("fountain stone", {0.58F, 0.55F, 0.50F}));
  m.water = b.add(glossy(lambert("water", {0.04F, 0.14F, 0.16F}), 0.05F));
}

// ---- houses ----

/// The meshes of a house in the scene, and what it is painted with.
struct Built {
  std::vector<Index> meshes;
};
Built add_house(SceneBuilder& b, const Materials& m, const Kit& kit, const Plan& plan, Dice& dice) {
  House house = make_house(kit, plan);
  const auto pick = [&dice](const auto& choices) {
    return choices[static_cast<std::size_t>(dice.below(static_cast<int>(choices.size())))];
  };
  std::array<Index, kParts> materials{};
  materials[Wall] = pick(m.walls), materials[Trim] = m.trim, materials[Frame] = m.frame;
  materials[Glass] = m.glass, materials[Blinds] = m.blinds;
  materials[Shutter] = pick(m.shutters), materials[Iron] = m.iron,
  materials[Cloth] = pick(m.cloths);
  materials[Roof] = plan.roof == RoofKind::Flat ? m.asphalt : pick(m.roofs);
  Built built;
  for (std::size_t part = 0; part < kParts; ++part) {
    if (house[part].triangles.empty()) continue;
    built.meshes.push_back(b.add(std::move(house[part]), materials[part]));
  }
  return built;
}

struct Lot {
  int x = 0, z = 0;
  bool square = false;  ///< open: grass, trees and a fountain instead of a house

  DVec3 centre() const {
    return {kPitchX * (x - (kLotsX - 1) / 2.0), 0.0, kPitchZ * (z - (kLotsZ - 1) / 2.0)};
  }
};
std::vector<Lot> make_lots() {
  std::vector<Lot> lots;
  for (int z = 0; z < kLotsZ; ++z) {
    for (int x = 0; x < kLotsX; ++x) {
      const bool square =
          (x == 5 && z == 4) || (x == 2 && z == 7) || (x == 8 && z == 2) || (x == 3 && z == 3);
      lots.push_back({x, z, square});
    }
  }
  return lots;
}

enum class Copies { None, Instances };

void add_houses(SceneBuilder& b, const Materials& m, const std::vector<Lot>& lots, Copies copies,
                std::uint64_t seed) {
  constexpr std::size_t kDesigns = 12;
  const Kit kit = make_kit();
  Dice plans(seed), places(seed + 1);
  std::vector<Built> designs;
  for (const Lot& lot : lots) {
    if (lot.square) continue;
    const bool reuse = copies == Copies::Instances && designs.size() >= kDesigns;
    if (!reuse) designs.push_back(add_house(b, m, kit, draw_plan(plans), plans));
    const Built& house =
        reuse ? designs[static_cast<std::size_t>(places.below(kDesigns))] : designs.back();
    const DMat4 at = translation(lot.centre() + DVec3{0.0, double{kKerb}, 0.0}) *
                     rotation_y(Degrees{places.chance(0.5F) ? 0.0 : 180.0});
    for (const Index mesh : house.meshes) b.place(mesh, at);
  }
}

// ---- streets ----

void add_ground(SceneBuilder& b, const Materials& m, const std::vector<Lot>& lots) {
  constexpr float kHalf = 260.0F;
  b.place(parallelogram("asphalt", {-kHalf, 0, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf},
                        Vec2{2 * kHalf / 5.0F}),
          m.asphalt);
  const Index pavement = b.add(box("pavement", {kLotX, 2 * kKerb, kLotZ}, 4.0F), m.paving);
  const Index lawn = b.add(box("lawn", {kLotX - 4.0F, 0.1F, kLotZ - 4.0F}, 3.0F), m.grass);
  const Index dash = b.add(box("lane mark", {0.15F, 0.012F, 2.0F}), m.line);
  const Index stripe = b.add(box("crossing", {0.5F, 0.012F, 3.0F}), m.line);
  for (const Lot& lot : lots) {
    b.place(pavement, translation(lot.centre()));
    if (lot.square) b.place(lawn, translation(lot.centre() + DVec3{0.0, kKerb + 0.03, 0.0}));
    const DVec3 crossing = lot.centre() + DVec3{kPitchX / 2, 0.0, kPitchZ / 2};
    for (int i = 0; i < 4; ++i) {
      b.place(dash, translation(crossing + DVec3{0.0, 0.0, -8.0 - 4.0 * i}));
      b.place(dash,
              translation(crossing + DVec3{-8.5 - 4.5 * i, 0.0, 0.0}) * rotation_y(Degrees{90.0}));
    }
    for (int i = 0; i < 8; ++i)
      b.place(stripe, translation(crossing + DVec3{-3.8 + 1.05 * i, 0.0, -6.0}));
  }
}

void add_street_furniture(SceneBuilder& b, const Materials& m, const std::vector<Lot>& lots) {
  const StreetLamp lamp_parts = street_lamp();
  const Index post = b.add(lamp_parts.post, m.iron), globe = b.add(lamp_parts.globe, m.globe);
  const Index stop = b.add(bollard(), m.iron), signal = b.add(traffic_light(), m.iron);
  for (const Lot& lot : lots) {
    const DVec3 c = lot.centre() + DVec3{0.0, double{kKerb}, 0.0};
    for (const DVec3& corner : {DVec3{9.8, 0.0, 8.3}, DVec3{-9.8, 0.0, -8.3}}) {
      b.place(post, translation(c + corner));
      b.place(globe, translation(c + corner));
    }
    b.place(signal, translation(c + DVec3{9.9, 0.0, -8.4}) * rotation_y(Degrees{180.0}));
    for (int i = 0; i < 5; ++i) b.place(stop, translation(c + DVec3{-6.0 + 3.0 * i, 0.0, 8.5}));
  }
}

void add_cars(SceneBuilder& b, const Materials& m, const std::vector<Lot>& lots,
              std::uint64_t seed) {
  struct Model {
    Index body, glass, dark;
  };
  std::vector<Model> models;
  for (const Vec2& size : {Vec2{4.2F, 1.45F}, Vec2{4.7F, 1.5F}, Vec2{3.7F, 1.55F}}) {
    const Car made = car(size.x, size.y);
    for (const Index paint : m.paints) {
      models.push_back(
          {b.add(made.body, paint), b.add(made.glass, m.glass), b.add(made.dark, m.tyre)});
    }
  }
  Dice dice(seed);
  for (const Lot& lot : lots) {
    for (int i = 0; i < 3; ++i) {
      if (!dice.chance(0.6F)) continue;
      // Parked along the pavement's east side.
      const Model& model =
          models[static_cast<std::size_t>(dice.below(static_cast<int>(models.size())))];
      const DMat4 at = translation(lot.centre() + DVec3{kLotX / 2 + 1.15, 0.0, -5.6 + 5.4 * i}) *
                       rotation_y(Degrees{dice.chance(0.8F) ? 0.0 : 180.0});
      for (const Index mesh : {model.body, model.glass, model.dark}) b.place(mesh, at);
    }
  }
}

void add_greenery(SceneBuilder& b, const Materials& m, const std::vector<Lot>& lots,
                  std::uint64_t seed) {
  std::vector<std::array<Index, 2>> trees;
  for (std::uint64_t i = 0; i < 5; ++i) {
    Tree made = tree({.height = 6.0F + static_cast<float>(i % 3)}, seed + i);
    trees.push_back({b.add(std::move(made.wood), m.bark), b.add(std::move(made.leaves), m.leaves)});
  }
  const Index seat = b.add(park_bench(), m.wood);
  const Index basin = b.add(atrium_parts::fountain_basin(), m.stone);
  const Index water = b.add(atrium_parts::fountain_water(), m.water);
  Dice dice(seed + 9);
  const auto plant = [&](const DVec3& at) {
    const DMat4 place = translation(at) * rotation_y(Degrees{360.0 * dice.next()}) *
                        scaling(DVec3{0.8 + 0.4 * dice.next()});
    for (const Index mesh : trees[static_cast<std::size_t>(dice.below(5))]) b.place(mesh, place);
  };
  for (const Lot& lot : lots) {
    const DVec3 c = lot.centre() + DVec3{0.0, double{kKerb}, 0.0};
    if (!lot.square) {
      for (const double z : {-5.5, 0.0, 5.5})
        if (dice.chance(0.55F)) plant(c + DVec3{-9.75, 0.0, z});
      continue;
    }
    for (int i = 0; i < 12; ++i) {
      const double angle = 6.283 * i / 12.0;
      plant(c + DVec3{7.0 * std::cos(angle), 0.0, 5.6 * std::sin(angle)});
      if (i % 3 == 0)
        b.place(seat, translation(c + DVec3{4.2 * std::cos(angle + 0.3), 0.05,
                                            3.6 * std::sin(angle + 0.3)}) *
                          rotation_y(Degrees{-57.3 * (angle + 0.3) - 90.0}));
    }
    b.place(basin, translation(c));
    b.place(water, translation(c));
  }
}

void set_the_scene(SceneBuilder& b) {
  b.add(Light{.kind = LightKind::Directional,
              .intensity = Rgb{7.6F, 6.9F, 5.6F},
              .direction = normalize(Vec3{-0.62F, -0.78F, -0.42F})});
  Settings& settings = b.settings();
  settings.ambient = Rgb{0.46F, 0.58F, 0.78F};
  settings.ambient_distance_m = 12.0;
  settings.tone = {.exposure_ev = 0.0F, .curve = image::ToneCurve::Filmic};
  // In the middle of a street, beside the square at its end.
  settings.scene_from_stage.position = {0.0, 0.0, 32.0};
  b.add(
      Camera{"street", math::look_at({0.6, 1.7, 44.0}, {1.0, 4.4, 0.0}, {0, 1, 0}), Degrees{70.0}});
  b.add(Camera{"roofs", math::look_at({-70.0, 46.0, 110.0}, {10.0, 4.0, -10.0}, {0, 1, 0}),
               Degrees{55.0}});
  b.add(Camera{"square", math::look_at({7.0, 1.7, -3.0}, {17.5, 3.0, -15.0}, {0, 1, 0}),
               Degrees{75.0}});
}

Scene make_city(std::string name, Copies copies, std::uint64_t seed) {
  SceneBuilder b(std::move(name));
  Materials m{};
  make_house_materials(b, m, seed * 1000);
  make_street_materials(b, m, seed * 1000 + 100);
  const std::vector<Lot> lots = make_lots();
  add_ground(b, m, lots);
  add_houses(b, m, lots, copies, seed * 1000 + 200);
  add_street_furniture(b, m, lots);
  add_cars(b, m, lots, seed * 1000 + 300);
  add_greenery(b, m, lots, seed * 1000 + 400);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace

Scene city_of_houses(std::uint64_t seed) {
  return make_city("city", Copies::None, seed);
}

Scene city_instanced(std::uint64_t seed) {
  return make_city("city-instanced", Copies::Instances, seed);
}

}  // namespace macula::scene::built_in
