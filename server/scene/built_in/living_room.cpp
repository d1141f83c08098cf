// A living room in the evening, at the scale of the Room of the foveated stochastic lightcuts paper
// (5,103.9k triangles, 30.4k lights): a shag rug of half a million blades, sofas with knitted
// blankets, a laid table under pendants, a piano, plants, a lit television, candles and strings of
// small bulbs. Every light is the mesh that shines.
#include <array>
#include <utility>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/fixtures.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/interior.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/room_shell.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textiles.h"

namespace macula::scene::built_in {
namespace {

constexpr Vec3 kRoom{8.4F, 2.8F, 6.4F};

void add_sofas(SceneBuilder& b, const InteriorMaterials& m) {
  const Armchair long_one = armchair(1.9F), single = armchair(0.66F);
  const DMat4 sofa = translation({-1.6, 0.0, -1.9});
  b.place(long_one.leather, m.upholstery, sofa);
  b.place(long_one.legs, m.dark_wood, sofa);
  const Index leather = b.add(single.leather, m.leather), legs = b.add(single.legs, m.dark_wood);
  for (const DMat4& at : {translation({-3.35, 0.0, -0.1}) * rotation_y(Degrees{80.0}),
                          translation({0.35, 0.0, -0.5}) * rotation_y(Degrees{-75.0})}) {
    b.place(leather, at);
    b.place(legs, at);
  }
  const Index pillow = b.add(cushion({0.24F, 0.09F, 0.24F}, 96, 48), m.curtain);
  const Index other = b.add(cushion({0.22F, 0.08F, 0.22F}, 96, 48), m.wool);
  for (const auto& [x, mesh] :
       {std::pair{-2.35, pillow}, std::pair{-1.95, other}, std::pair{-1.0, pillow}})
    b.place(mesh, translation({x, 0.72, -1.88}) * rotation_z(Degrees{8.0 * x}) *
                      rotation_x(Degrees{70.0}));
  const Index blanket = b.add(knitted_blanket(0.62F, 1.0F, 56, 74), m.wool);
  b.place(blanket, translation({-0.95, 0.52, -1.62}));
  b.place(blanket, translation({0.05, 0.74, -0.45}) * rotation_y(Degrees{-75.0}));
}

void add_coffee_table(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const DMat4 at = translation({-1.6, 0.0, -0.45});
  b.place(table(1.3F, 0.65F, 0.42F), m.wood, at);
  const DMat4 top = at * translation({0.0, 0.42, 0.0});
  const Lamp group = candles(9, 0.36F, seed);
  b.place(group.body, m.wax, top * translation({0.1, 0.0, 0.0}));
  b.place(group.glow, m.flame, top * translation({0.1, 0.0, 0.0}));
  b.place(bowl(), m.glaze, top * translation({0.47, 0.0, 0.1}));
  place_books(b, m, pile_of_books(4, seed + 1), top * translation({-0.4, 0.0, 0.0}));
}

void add_television(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const DMat4 at = translation({-1.6, 0.0, kRoom.z / 2.0 - 0.32}) * rotation_y(Degrees{180.0});
  b.place(table(1.9F, 0.42F, 0.5F), m.dark_wood, at);
  const Screen set = screen(1.35F, 0.76F, 112);
  b.place(set.picture, m.screen, at * translation({0.0, 0.5, 0.0}));
  b.place(set.case_, m.dark, at * translation({0.0, 0.5, 0.0}));
  const Lamp lights = candles(6, 0.3F, seed);
  for (const double x : {-0.85, 0.85}) {
    b.place(lights.body, m.wax, at * translation({x, 0.5, 0.0}));
    b.place(lights.glow, m.flame, at * translation({x, 0.5, 0.0}));
  }
}

/// One cover: plate, bowl, glass and a candle's light from above.
void add_dining(SceneBuilder& b, const InteriorMaterials& m) {
  constexpr float kHeight = 0.75F;
  const DMat4 at = translation({2.6, 0.0, 0.6});
  b.place(table(1.0F, 2.2F, kHeight), m.wood, at);
  const Chair made = chair();
  const Index bent = b.add(made.wood, m.dark_wood), cane = b.add(made.seat, m.straw);
  const Index dish = b.add(plate(), m.porcelain), deep = b.add(bowl(), m.porcelain),
              glass = b.add(wine_glass(), m.glass);
  for (int i = 0; i < 6; ++i) {
    const double side = i % 2 == 0 ? -1.0 : 1.0, z = -0.72 + 0.72 * (i / 2);
    const DMat4 seat = at * translation({0.0, 0.0, z}) * rotation_y(Degrees{side * 90.0});
    const DMat4 chair_at =
        seat * translation({0.0, 0.0, 0.72}) * rotation_y(Degrees{176.0 + 3.0 * i});
    b.place(bent, chair_at);
    b.place(cane, chair_at);
    const DMat4 cover = seat * translation({0.0, double{kHeight}, 0.30});
    b.place(dish, cover);
    b.place(deep, cover * translation({0.0, 0.008, 0.0}) * scaling(DVec3{0.62}));
    b.place(glass, cover * translation({0.16, 0.0, -0.12}));
  }
  b.place(bowl(), m.glaze, at * translation({0.0, double{kHeight}, 0.0}) * scaling(DVec3{1.5}));
  const Lamp light = pendant(1.05F, 0.19F);
  const Index body = b.add(light.body, m.brass), glow = b.add(light.glow, m.warm_glow);
  for (const double z : {-0.7, 0.0, 0.7}) {
    const DMat4 hook = at * translation({0.0, double{kRoom.y}, z});
    b.place(body, hook);
    b.place(glow, hook);
  }
}

void add_music_and_books(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const DMat4 at = translation({-kRoom.x / 2.0 + 0.42, 0.0, 1.5}) * rotation_y(Degrees{90.0});
  b.place(piano(), m.dark_wood, at);
  b.place(white_keys(), m.porcelain, at);
  b.place(black_keys(), m.dark, at);
  const Chair stool = chair();
  b.place(stool.wood, m.dark_wood, at * translation({0.0, 0.0, 0.75}) * rotation_y(Degrees{185.0}));
  b.place(stool.seat, m.straw, at * translation({0.0, 0.0, 0.75}) * rotation_y(Degrees{185.0}));
  constexpr float kWidth = 1.5F;
  const Index shelves = b.add(bookcase(kWidth), m.wood);
  for (int i = 0; i < 2; ++i) {
    const DMat4 place = translation({1.35 + 1.56 * i, 0.0, -kRoom.z / 2.0 + 0.36});
    b.place(shelves, place);
    Books books;
    for (int shelf = 0; shelf < kShelves; ++shelf)
      append(books,
             row_of_books(kWidth - 0.3F, 0.32F, seed + static_cast<unsigned>(10 * i + shelf)),
             translation({-kWidth / 2.0 + 0.1, double{shelf_height(shelf)}, -0.03}));
    place_books(b, m, std::move(books), place);
  }
  const Lamp lamp = shaded_lamp(1.55F, 0.25F);
  const Index foot = b.add(lamp.body, m.brass), shade = b.add(lamp.glow, m.shade_glow);
  for (const DVec3& place : {DVec3{-3.4, 0.0, -1.7}, DVec3{0.25, 0.0, -2.6}}) {
    b.place(foot, translation(place));
    b.place(shade, translation(place));
  }
}

void add_walls_and_windows(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const Index frame = b.add(picture_frame(0.8F, 0.6F), m.brass);
  const Index art =
      b.add(parallelogram("painting", {-0.4F, -0.3F, 0.005F}, {0.8F, 0, 0}, {0, 0.6F, 0}), m.art);
  for (const double x : {-3.0, -1.6, -0.2}) {
    const DMat4 at = translation({x, 1.75, -kRoom.z / 2.0 + 0.01});
    b.place(frame, at);
    b.place(art, at);
  }
  const float wall = kRoom.x / 2 - 0.1F;
  for (int window = 0; window < 2; ++window) {
    const float z = -1.6F + 3.2F * static_cast<float>(window);
    for (const double side : {-0.82, 0.82})
      b.place(atrium_parts::curtain(1.5F, 2.5F, seed + static_cast<unsigned>(window)), m.curtain,
              translation({kRoom.x / 2.0 - 0.12, 2.6, double{z} + side}) *
                  rotation_y(Degrees{-90.0}) * scaling({0.4, 1.0, 1.0}));
    const StringOfLights lights =
        string_of_lights({wall, 2.5F, z - 0.9F}, {wall, 2.5F, z + 0.9F},
                         {.sag = 0.22F, .count = 30}, seed + 40 + static_cast<unsigned>(window));
    b.place(lights.cable, m.dark);
    b.place(lights.bulbs, window == 0 ? m.warm_glow : m.red_glow);
  }
}

void add_plants(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const Index pot = b.add(plant_pot(0.2F), m.glaze);
  const std::array plants{b.add(leafy_plant(90, 1.1F, seed), m.leaf),
                          b.add(leafy_plant(60, 0.7F, seed + 1), m.leaf),
                          b.add(leafy_plant(120, 1.4F, seed + 2), m.leaf)};
  constexpr std::array kPlaces{DVec3{-3.8, 0.0, -2.75}, DVec3{3.75, 0.0, -0.1},
                               DVec3{3.7, 0.0, 2.7},    DVec3{-0.35, 0.0, 2.95},
                               DVec3{-3.3, 0.0, 2.8},   DVec3{0.35, 0.0, -3.0}};
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const DMat4 at = translation(kPlaces[i]) * rotation_y(Degrees{70.0 * static_cast<double>(i)});
    b.place(pot, at);
    b.place(plants[i % 3], at * translation({0.0, 0.25, 0.0}));
  }
  const Index basket = b.add(wicker_basket(0.22F, 0.34F), m.straw);
  for (const DVec3& at : {DVec3{-0.25, 0.0, -1.75}, DVec3{-3.75, 0.0, 0.55}})
    b.place(basket, translation(at));
}

void set_the_scene(SceneBuilder& b) {
  Settings& settings = b.settings();
  settings.ambient = Rgb{0.06F, 0.06F, 0.066F};
  settings.ambient_distance_m = 1.5;
  settings.tone = {.exposure_ev = 2.0F, .curve = image::ToneCurve::Filmic};
  settings.scene_from_stage.position = {0.9, 0.0, 2.2};
  b.add(
      Camera{"door", math::look_at({1.3, 1.6, 2.5}, {-0.5, 0.85, -1.0}, {0, 1, 0}), Degrees{64.0}});
  b.add(
      Camera{"table", math::look_at({0.8, 1.5, -1.2}, {2.9, 0.85, 0.9}, {0, 1, 0}), Degrees{62.0}});
}

}  // namespace

Scene room(std::uint64_t seed) {
  SceneBuilder b("room");
  const InteriorMaterials m = make_interior_materials(b, seed * 1000 + 7);
  place_shell(b, m, room_shell(kRoom, 2));
  add_sofas(b, m);
  add_coffee_table(b, m, seed * 1000 + 100);
  add_television(b, m, seed * 1000 + 200);
  add_dining(b, m);
  add_music_and_books(b, m, seed * 1000 + 300);
  add_walls_and_windows(b, m, seed * 1000 + 400);
  add_plants(b, m, seed * 1000 + 500);
  place_pile_rug(b, m.rug, {-1.6, 0.0, -0.2}, 4.0, 3.0,
                 {.fibres = 22'000, .length = 0.04F, .width = 0.003F}, seed * 1000 + 600);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
