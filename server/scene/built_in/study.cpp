// A study at dusk, at the scale of the Study of the foveated stochastic lightcuts paper (2,110.1k
// triangles, 58.1k lights): shelves of books, a desk with two lit screens, a buttoned armchair with
// a knitted blanket, a pile rug, a fire of coals, a chandelier and strings of small bulbs. Every
// light is the mesh that shines.
#include <array>

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

constexpr Vec3 kRoom{6.6F, 3.0F, 5.4F};

void add_library(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  constexpr float kWidth = 1.5F;
  const Index shelves = b.add(bookcase(kWidth), m.wood);
  // Three cases along the back wall, two along the left one.
  std::vector<DMat4> places;
  for (int i = 0; i < 3; ++i)
    places.push_back(translation({-1.45 + 1.56 * i, 0.0, -kRoom.z / 2.0 + 0.36}));
  for (int i = 0; i < 2; ++i)
    places.push_back(translation({-kRoom.x / 2.0 + 0.36, 0.0, 0.2 + 1.56 * i}) *
                     rotation_y(Degrees{90.0}));
  for (std::size_t i = 0; i < places.size(); ++i) {
    b.place(shelves, places[i]);
    Books books;
    for (int shelf = 0; shelf < kShelves; ++shelf) {
      append(books,
             row_of_books(kWidth - 0.1F, 0.33F, seed + 10 * i + static_cast<unsigned>(shelf)),
             translation({-kWidth / 2.0 + 0.05, double{shelf_height(shelf)}, -0.03}));
    }
    place_books(b, m, std::move(books), places[i]);
  }
}

void add_desk(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  // Seen from the door: the chair side towards the room, screens towards the viewer.
  const DMat4 at = translation({1.75, 0.0, -0.55}) * rotation_y(Degrees{-58.0});
  b.place(desk(), m.wood, at);
  const DMat4 top = at * translation({0.0, 0.76, 0.0});
  const Screen monitor = screen(0.62F, 0.36F, 96);
  const Index picture = b.add(monitor.picture, m.screen), shell = b.add(monitor.case_, m.dark);
  for (const double side : {-1.0, 1.0}) {
    const DMat4 place =
        top * translation({side * 0.34, 0.0, -0.12}) * rotation_y(Degrees{-14.0 * side});
    b.place(picture, place);
    b.place(shell, place);
  }
  b.place(keyboard(), m.dark, top * translation({0.0, 0.0, 0.22}));
  const Lamp lamp = desk_lamp();
  const DMat4 corner = top * translation({-0.75, 0.0, -0.1}) * rotation_y(Degrees{30.0});
  b.place(lamp.body, m.brass, corner);
  b.place(lamp.glow, m.warm_glow, corner);
  place_books(b, m, pile_of_books(7, seed), top * translation({0.72, 0.0, 0.1}));
  place_books(b, m, pile_of_books(3, seed + 1), top * translation({-0.6, 0.0, 0.25}));
  const Chair seat = chair();
  const DMat4 chair_at = at * translation({0.0, 0.0, 0.75}) * rotation_y(Degrees{190.0});
  b.place(seat.wood, m.dark_wood, chair_at);
  b.place(seat.seat, m.straw, chair_at);
}

void add_reading_corner(SceneBuilder& b, const InteriorMaterials& m) {
  const Armchair big = armchair(0.62F);
  const Index leather = b.add(big.leather, m.leather), legs = b.add(big.legs, m.dark_wood);
  for (const DMat4& at : {translation({-1.55, 0.0, -0.75}) * rotation_y(Degrees{48.0}),
                          translation({-0.45, 0.0, -1.75}) * rotation_y(Degrees{8.0})}) {
    b.place(leather, at);
    b.place(legs, at);
  }
  b.place(knitted_blanket(0.5F, 0.9F, 44, 62), m.wool,
          translation({-1.30, 0.74, -0.55}) * rotation_y(Degrees{138.0}));
  const DMat4 side_table = translation({-0.95, 0.0, -1.15});
  b.place(table(0.42F, 0.42F, 0.5F), m.dark_wood, side_table);
  place_books(b, m, pile_of_books(3, 77), side_table * translation({0.0, 0.5, 0.0}));
  const Lamp lamp = shaded_lamp(1.6F, 0.24F);
  const DMat4 lamp_at = translation({-2.35, 0.0, -1.35});
  b.place(lamp.body, m.brass, lamp_at);
  b.place(lamp.glow, m.shade_glow, lamp_at);
  const DMat4 globe = translation({0.62, 0.0, 0.55});
  b.place(table(0.5F, 0.5F, 0.45F), m.dark_wood, globe);
  b.place(globe_stand(), m.brass, globe * translation({0.0, 0.45, 0.0}));
  b.place(globe_ball(), m.leather,
          globe * translation({0.0, 0.89, 0.0}) * rotation_z(Degrees{23.0}));
  b.place(wicker_basket(0.2F, 0.32F), m.straw, translation({-2.2, 0.0, -0.35}));
}

void add_fire(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const DMat4 at = translation({-kRoom.x / 2.0 + 0.42, 0.0, -1.45}) * rotation_y(Degrees{90.0});
  b.place(fireplace(), m.stone, at);
  b.place(fire_irons(), m.iron, at * translation({0.0, 0.03, -0.1}));
  b.place(embers(0.30F, 60, seed), m.embers, at * translation({0.0, 0.10, -0.12}));
  const Lamp lights = candles(4, 1.2F, seed + 90);
  b.place(lights.body, m.wax, at * translation({0.0, 1.28, -0.12}));
  b.place(lights.glow, m.flame, at * translation({0.0, 1.28, -0.12}));
}

void add_overhead(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  const Lamp crown = chandelier(0.75F, 8);
  const DMat4 hook = translation({0.1, double{kRoom.y}, -0.3});
  b.place(crown.body, m.brass, hook);
  b.place(crown.glow, m.warm_glow, hook);
  const float x = kRoom.x / 2 - 0.1F, back = -kRoom.z / 2 + 0.45F, y = 2.52F;
  const std::array<std::array<Vec3, 2>, 4> spans{{{Vec3{-2.3F, y, back}, Vec3{0.0F, y, back}},
                                                  {Vec3{0.0F, y, back}, Vec3{2.3F, y, back}},
                                                  {Vec3{x, 2.45F, -2.5F}, Vec3{x, 2.45F, 0.0F}},
                                                  {Vec3{x, 2.45F, 0.0F}, Vec3{x, 2.45F, 2.5F}}}};
  const std::array glows{m.warm_glow, m.red_glow, m.green_glow, m.blue_glow};
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const StringOfLights lights =
        string_of_lights(spans[i][0], spans[i][1], {.sag = 0.16F, .count = 40}, seed + i);
    b.place(lights.cable, m.dark);
    b.place(lights.bulbs, glows[i]);
  }
}

void add_soft_things(SceneBuilder& b, const InteriorMaterials& m, std::uint64_t seed) {
  place_pile_rug(b, m.rug, {-0.3, 0.0, 0.1}, 3.0, 2.5, {.fibres = 11'000, .length = 0.022F}, seed);
  for (int window = 0; window < 2; ++window) {
    const double z = -1.35 + 2.7 * window;
    for (const double side : {-0.78, 0.78})
      b.place(atrium_parts::curtain(1.4F, 2.45F, seed + static_cast<unsigned>(window)), m.curtain,
              translation({kRoom.x / 2.0 - 0.12, 2.62, z + side}) * rotation_y(Degrees{-90.0}) *
                  scaling({0.4, 1.0, 1.0}));
  }
  const Index pot = b.add(plant_pot(0.18F), m.glaze);
  for (const DVec3& at : {DVec3{2.75, 0.0, -2.2}, DVec3{-2.85, 0.0, 2.2}, DVec3{2.8, 0.0, 1.3}}) {
    b.place(pot, translation(at));
    b.place(leafy_plant(70, 0.9F, seed + static_cast<std::uint64_t>(at.x + 20.0)), m.leaf,
            translation(at + DVec3{0.0, 0.22, 0.0}));
  }
}

void set_the_scene(SceneBuilder& b) {
  Settings& settings = b.settings();
  // Dusk outside, and what the walls return of the lamps.
  settings.ambient = Rgb{0.05F, 0.052F, 0.062F};
  settings.ambient_distance_m = 1.5;
  settings.tone = {.exposure_ev = 1.8F, .curve = image::ToneCurve::Filmic};
  settings.scene_from_stage.position = {0.7, 0.0, 1.9};
  b.add(Camera{"door", math::look_at({1.4, 1.6, 2.45}, {-0.35, 1.05, -1.2}, {0, 1, 0}),
               Degrees{62.0}});
  b.add(
      Camera{"desk", math::look_at({0.5, 1.5, 1.0}, {2.0, 0.95, -0.9}, {0, 1, 0}), Degrees{55.0}});
}

}  // namespace

Scene study(std::uint64_t seed) {
  SceneBuilder b("study");
  const InteriorMaterials m = make_interior_materials(b, seed * 1000);
  place_shell(b, m, room_shell(kRoom, 2));
  add_library(b, m, seed * 1000 + 100);
  add_desk(b, m, seed * 1000 + 200);
  add_reading_corner(b, m);
  add_fire(b, m, seed * 1000 + 300);
  add_overhead(b, m, seed * 1000 + 400);
  add_soft_things(b, m, seed * 1000 + 500);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
