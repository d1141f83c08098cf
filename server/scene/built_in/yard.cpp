// A garden party at night, at the scale of the Yard of the foveated stochastic lightcuts paper
// (2,575.1k triangles, 250.6k moving lights): strings of bulbs that swing in the wind between
// house, trees and posts, and fireflies over a lawn of blades. Every light is a triangle that
// moves: a string turns about the line between its ends, a swarm of fireflies drifts around a loop.
#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/city_building.h"
#include "server/scene/built_in/city_street.h"
#include "server/scene/built_in/fixtures.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/interior.h"
#include "server/scene/built_in/plants.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kLawnX = 14.0, kLawnZ = 12.0;  // m

struct Materials {
  InteriorMaterials inside;
  Index grass, earth, gravel, bark, leaves, hedge, petals, wall, roof, trim, glass, blinds, shutter,
      fence, water;
  std::array<Index, 5> bulbs;
  Index firefly;
};

Materials make_materials(SceneBuilder& b, std::uint64_t seed) {
  constexpr int kPixels = 512;
  Materials m{};
  m.inside = make_interior_materials(b, seed);
  const auto two_sided = [&b](Material material) {
    material.double_sided = true;
    return b.add(std::move(material));
  };
  m.grass = two_sided(lambert("grass", {0.10F, 0.26F, 0.06F}));
  const auto ground = [&](const char* name, const Palette& palette, std::uint64_t s) {
    return b.add(textured(name, b.add(plaster(name, kPixels, palette, s))));
  };
  m.earth = ground("earth", {{0.16F, 0.12F, 0.08F}, {0.34F, 0.27F, 0.18F}}, seed + 60);
  m.gravel = ground("gravel", {{0.38F, 0.35F, 0.31F}, {0.70F, 0.66F, 0.60F}}, seed + 61);
  m.bark = b.add(textured(
      "bark",
      b.add(wood("bark", kPixels, {{0.16F, 0.12F, 0.09F}, {0.42F, 0.34F, 0.27F}}, seed + 62))));
  m.leaves = b.add(foliage_material(
      "leaves", b.add(foliage("leaves", kPixels, {{0.06F, 0.20F, 0.04F}, {0.42F, 0.62F, 0.22F}},
                              seed + 63))));
  m.hedge = b.add(foliage_material(
      "hedge",
      b.add(foliage("hedge", kPixels, {{0.04F, 0.14F, 0.04F}, {0.24F, 0.44F, 0.16F}}, seed + 64))));
  m.petals = two_sided(lambert("petals", {0.62F, 0.16F, 0.30F}));
  const Masonry bricks{.columns = 8,
                       .courses = 32,
                       .joint = 0.08F,
                       .stone = {{0.38F, 0.20F, 0.15F}, {0.66F, 0.42F, 0.32F}},
                       .mortar = Vec3{0.62F, 0.58F, 0.52F}};
  m.wall = b.add(textured("house", b.add(masonry("house", 2 * kPixels, bricks, seed + 65))));
  m.roof = ground("roof", {{0.30F, 0.14F, 0.10F}, {0.58F, 0.32F, 0.22F}}, seed + 66);
  m.trim = b.add(lambert("trim", {0.70F, 0.67F, 0.60F}));
  m.glass = b.add(glossy(lambert("glass", {0.03F, 0.04F, 0.05F}), 0.05F));
  m.blinds = b.add(lambert("drawn curtain", {0.55F, 0.45F, 0.30F}));
  m.shutter = two_sided(lambert("shutters", {0.14F, 0.24F, 0.26F}));
  m.fence = b.add(lambert("fence", {0.62F, 0.58F, 0.50F}));
  m.water = b.add(glossy(lambert("water", {0.02F, 0.05F, 0.06F}), 0.05F));
  m.bulbs = {b.add(lamp("amber bulbs", {22.0F, 14.0F, 6.0F})),
             b.add(lamp("red bulbs", {17.0F, 3.5F, 2.4F})),
             b.add(lamp("green bulbs", {4.5F, 14.0F, 4.5F})),
             b.add(lamp("blue bulbs", {4.0F, 7.5F, 20.0F})),
             b.add(lamp("white bulbs", {15.0F, 14.0F, 11.5F}))};
  m.firefly = b.add(lamp("firefly", {7.0F, 14.0F, 2.5F}));
  return m;
}

// ---- what moves ----

/// A joint at `from` whose x axis runs to `to`, level with it: swings about that axis like a
/// hammock.
Joint swing(const DVec3& from, const DVec3& to, double degrees, double period_s, double phase) {
  Joint joint;
  joint.name = "swing";
  const DVec3 along = to - from;
  joint.parent_from_base = translation(from) * rotation_y(Radians{std::atan2(-along.z, along.x)});
  constexpr int kKeys = 24;
  for (int i = 0; i <= kKeys; ++i) {
    const double t = static_cast<double>(i) / kKeys;
    // A pendulum with a little of its second harmonic: gusts come from one side.
    const double angle = degrees * (std::sin(kTurn * (t + phase)) + 0.3 * std::sin(2 * kTurn * t));
    joint.rotations.times_s.push_back(period_s * t);
    joint.rotations.values.push_back(
        glm::angleAxis(Radians(Degrees{angle}).value(), DVec3{1, 0, 0}));
  }
  joint.period = units::from_s(period_s);
  return joint;
}

/// A joint that drifts around a closed loop about `centre` and turns on the way.
Joint drift(const DVec3& centre, Dice& dice) {
  Joint joint;
  joint.name = "drift";
  const double period_s = dice.in(7.0F, 14.0F), phase = dice.next();
  const DVec3 reach{dice.in(0.4F, 1.2F), dice.in(0.15F, 0.4F), dice.in(0.4F, 1.2F)};
  constexpr int kKeys = 32;
  for (int i = 0; i <= kKeys; ++i) {
    const double t = static_cast<double>(i) / kKeys;
    joint.translations.times_s.push_back(period_s * t);
    joint.translations.values.push_back(
        centre + reach * DVec3{std::sin(kTurn * (t + phase)), std::sin(kTurn * (2.0 * t + phase)),
                               std::cos(kTurn * (3.0 * t + phase))});
    joint.rotations.times_s.push_back(period_s * t);
    joint.rotations.values.push_back(glm::angleAxis(0.6 * std::sin(kTurn * t), DVec3{0, 1, 0}));
  }
  joint.period = units::from_s(period_s);
  return joint;
}

void add_strings(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  constexpr int kStrings = 26;
  constexpr StringShape kShape{.sag = 0.55F, .count = 55, .bulb_radius = 0.026F};
  Dice dice(seed);
  for (int i = 0; i < kStrings; ++i) {
    // From the house's eaves to posts and trees across the lawn, fanned, in two tiers.
    const double t = (i + 0.5) / kStrings, height = i % 2 == 0 ? 3.4 : 4.3;
    const DVec3 from{-6.8 + 13.6 * t, height, -kLawnZ / 2 - 0.2};
    const DVec3 to{-6.8 + 13.6 * std::fmod(t * 3.0 + 0.17, 1.0), height, kLawnZ / 2 - 0.6};
    const auto length = static_cast<float>(glm::length(to - from));
    StringOfLights lights =
        string_of_lights({0, 0, 0}, {length, 0, 0}, kShape, seed + 10 + static_cast<unsigned>(i));
    const Index joint =
        b.add(swing(from, to, dice.in(4.0F, 9.0F), dice.in(2.6F, 4.0F), dice.next()));
    b.hang(joint, b.add(std::move(lights.cable), m.inside.dark));
    b.hang(joint, b.add(std::move(lights.bulbs), m.bulbs[static_cast<std::size_t>(i) % 5]));
  }
}

void add_fireflies(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  constexpr int kSwarms = 130, kFlies = 30;
  const Mesh fly = sphere("", 0.008F, 5, 3);  // 20 triangles
  Dice dice(seed);
  for (int swarm = 0; swarm < kSwarms; ++swarm) {
    Mesh mesh;
    mesh.name = "fireflies";
    for (int i = 0; i < kFlies; ++i)
      append(mesh, fly,
             translation({2.4 * (dice.next() - 0.5), 1.0 * (dice.next() - 0.5),
                          2.4 * (dice.next() - 0.5)}));
    const DVec3 centre{1.1 * kLawnX * (dice.next() - 0.5), 0.9 + 1.1 * dice.next(),
                       1.1 * kLawnZ * (dice.next() - 0.5)};
    b.hang(b.add(drift(centre, dice)), b.add(std::move(mesh), m.firefly));
  }
}

// ---- what stands ----

void add_ground(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  b.place(parallelogram("earth", {-20, -0.01F, 20}, {40, 0, 0}, {0, 0, -40}, Vec2{16.0F}), m.earth);
  std::array<Index, 4> patches{};
  for (std::size_t i = 0; i < patches.size(); ++i)
    patches[i] = b.add(
        pile_patch({.side = 1.0F, .fibres = 1'800, .length = 0.07F, .width = 0.006F}, seed + i),
        m.grass);
  Dice dice(seed + 9);
  for (int j = 0; j < static_cast<int>(kLawnZ); ++j) {
    for (int i = 0; i < static_cast<int>(kLawnX); ++i) {
      const DVec3 at{i + 0.5 - kLawnX / 2, 0.0, j + 0.5 - kLawnZ / 2};
      b.place(patches[static_cast<std::size_t>(dice.below(4))],
              translation(at) * rotation_y(Degrees{90.0 * dice.below(4)}));
    }
  }
  const auto terrace = [seed](float u, float v) {
    // Rounded cobbles.
    const float x = 15.0F * (u - 0.5F), z = 2.4F * (0.5F - v);
    const float cobble = std::abs(std::sin(9.0F * x) * std::sin(9.0F * z));
    return Vec3{x, 0.02F + 0.03F * std::sqrt(cobble) + 0.01F * roughness({x, 0, z}, seed), z};
  };
  b.place(tessellate("terrace", terrace, {420, 68, Around::Open, {8.0F, 1.3F}}), m.gravel,
          translation({0.0, 0.0, -kLawnZ / 2 - 1.2}));
}

void add_house(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  using namespace city;
  House house = make_house(make_kit(), {.bays_x = 6,
                                        .bays_z = 3,
                                        .floors = 1,
                                        .roof = RoofKind::Tiled,
                                        .shutters = Shutters::Louvred,
                                        .balcony_share = 0.2F,
                                        .shop_share = 0.0F,
                                        .seed = seed});
  const std::array<Index, kParts> materials{m.wall,    m.trim, m.trim,        m.glass, m.blinds,
                                            m.shutter, m.roof, m.inside.iron, m.fence};
  for (std::size_t part = 0; part < kParts; ++part) {
    if (!house[part].triangles.empty())
      b.place(std::move(house[part]), materials[part], translation({0.0, 0.0, -kLawnZ / 2 - 6.9}));
  }
}

void add_trees(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  std::vector<std::array<Index, 2>> kinds;
  for (std::uint64_t i = 0; i < 3; ++i) {
    Tree made = tree({.height = 6.5F,
                      .bare_trunk = 1.8F,
                      .branches = 26,
                      .sprigs_per_branch = 56,
                      .sprig_length = 0.42F},
                     seed + i);
    kinds.push_back({b.add(std::move(made.wood), m.bark), b.add(std::move(made.leaves), m.leaves)});
  }
  constexpr std::array kPlaces{DVec3{-8.2, 0, -3.5}, DVec3{-8.6, 0, 0.5}, DVec3{-8.0, 0, 4.5},
                               DVec3{8.3, 0, -4.0},  DVec3{8.6, 0, 0.0},  DVec3{8.1, 0, 4.2},
                               DVec3{-4.5, 0, 7.6},  DVec3{0.2, 0, 8.0},  DVec3{4.6, 0, 7.5},
                               DVec3{-11.5, 0, 7.0}, DVec3{11.4, 0, 6.8}};
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const DMat4 at = translation(kPlaces[i]) * rotation_y(Degrees{83.0 * static_cast<double>(i)}) *
                     scaling(DVec3{0.85 + 0.06 * static_cast<double>(i % 5)});
    for (const Index mesh : kinds[i % 3]) b.place(mesh, at);
  }
}

void add_borders(SceneBuilder& b, const Materials& m, std::uint64_t seed) {
  std::array<Index, 3> plants{};
  for (std::size_t i = 0; i < plants.size(); ++i)
    plants[i] = b.add(leafy_plant(44, 0.55F, seed + i), i == 1 ? m.petals : m.inside.leaf);
  const Index shrub = b.add(atrium_parts::shrub(70, seed + 5), m.hedge);
  const Index picket = b.add(
      [] {
        Mesh mesh = box("picket", {0.07F, 1.0F, 0.025F});
        for (Vec3& p : mesh.positions) p.y += 0.5F;
        append(mesh, sphere("", 0.04F, 12, 8), translation({0.0, 1.02, 0.0}));
        return mesh;
      }(),
      m.fence);
  const Index rail = b.add(box("rail", {kLawnX + 4.0F, 0.06F, 0.04F}), m.fence);
  for (const double y : {0.3, 0.8}) b.place(rail, translation({0.0, y, kLawnZ / 2 + 0.85}));
  for (int i = 0; i < 110; ++i)
    b.place(picket, translation({-8.9 + 0.163 * i, 0.0, kLawnZ / 2 + 0.9}));
  for (int i = 0; i < 24; ++i) {
    const double side = i % 2 == 0 ? -1.0 : 1.0, z = -5.2 + 0.95 * (i / 2);
    b.place(plants[static_cast<std::size_t>(i) % 3],
            translation({side * (kLawnX / 2 - 0.1), 0.0, z}) * rotation_y(Degrees{57.0 * i}));
    b.place(shrub,
            translation({side * (kLawnX / 2 + 0.9), -0.35, z}) * rotation_y(Degrees{31.0 * i}));
  }
}

void add_party(SceneBuilder& b, const Materials& m) {
  constexpr float kHeight = 0.75F;
  const DMat4 at = translation({2.0, 0.05, -1.2}) * rotation_y(Degrees{24.0});
  b.place(table(2.4F, 1.0F, kHeight), m.inside.wood, at);
  const Chair made = chair();
  const Index bent = b.add(made.wood, m.inside.dark_wood), cane = b.add(made.seat, m.inside.straw);
  const Index dish = b.add(plate(), m.inside.porcelain),
              glass = b.add(wine_glass(), m.inside.glass);
  for (int i = 0; i < 6; ++i) {
    const double side = i % 2 == 0 ? 0.0 : 180.0, x = -0.8 + 0.8 * (i / 2);
    const DMat4 seat = at * translation({x, 0.0, 0.0}) * rotation_y(Degrees{side});
    b.place(bent, seat * translation({0.0, 0.0, 0.75}) * rotation_y(Degrees{175.0 + 4.0 * i}));
    b.place(cane, seat * translation({0.0, 0.0, 0.75}) * rotation_y(Degrees{175.0 + 4.0 * i}));
    b.place(dish, seat * translation({0.0, double{kHeight}, 0.30}));
    b.place(glass, seat * translation({0.17, double{kHeight}, 0.16}));
  }
  b.place(bowl(), m.inside.glaze, at * translation({0.0, double{kHeight}, 0.0}));
  const DMat4 fountain = translation({-2.8, 0.0, 0.4});
  b.place(atrium_parts::fountain_basin(), m.inside.stone, fountain);
  b.place(atrium_parts::fountain_water(), m.water, fountain);
  b.place(atrium_parts::sculpture(), m.inside.brass, fountain * translation({0.0, 1.10, 0.0}));
  const Index seat = b.add(city::park_bench(), m.inside.wood);
  b.place(seat, translation({-5.6, 0.02, 1.5}) * rotation_y(Degrees{80.0}));
  b.place(seat, translation({-3.2, 0.02, 4.2}) * rotation_y(Degrees{170.0}));
  const Index post = b.add(box("post", {0.09F, 4.4F, 0.09F}), m.fence);
  for (int i = 0; i < 8; ++i) b.place(post, translation({-6.9 + 1.97 * i, 2.2, kLawnZ / 2 - 0.55}));
  const Index basket = b.add(wicker_basket(0.24F, 0.3F), m.inside.straw);
  b.place(basket, translation({0.2, 0.03, 1.6}));
  b.place(knitted_blanket(1.3F, 1.6F, 60, 80), m.inside.wool,
          translation({0.9, 0.09, 2.6}) * rotation_y(Degrees{-20.0}));
}

void set_the_scene(SceneBuilder& b) {
  b.add(Light{.kind = LightKind::Directional,
              .intensity = Rgb{0.05F, 0.06F, 0.09F},
              .direction = normalize(Vec3{0.5F, -0.8F, -0.35F})});
  Settings& settings = b.settings();
  settings.ambient = Rgb{0.012F, 0.016F, 0.030F};
  settings.ambient_distance_m = 4.0;
  settings.tone = {.exposure_ev = 1.5F, .curve = image::ToneCurve::Filmic};
  settings.scene_from_stage.position = {0.6, 0.05, 4.6};
  b.add(
      Camera{"lawn", math::look_at({0.6, 1.65, 5.2}, {0.0, 1.5, -3.0}, {0, 1, 0}), Degrees{65.0}});
  b.add(Camera{"terrace", math::look_at({-5.5, 1.7, -5.8}, {1.5, 1.4, 1.5}, {0, 1, 0}),
               Degrees{65.0}});
}

}  // namespace

Scene yard(std::uint64_t seed) {
  SceneBuilder b("yard");
  const Materials m = make_materials(b, seed * 1000 + 17);
  add_ground(b, m, seed * 1000 + 100);
  add_house(b, m, seed * 1000 + 200);
  add_trees(b, m, seed * 1000 + 300);
  add_borders(b, m, seed * 1000 + 400);
  add_party(b, m);
  add_strings(b, m, seed * 1000 + 500);
  add_fireflies(b, m, seed * 1000 + 600);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
