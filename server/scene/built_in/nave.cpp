// The nave of a cathedral at about the size of Sibenik's, which the papers render: barrel vault on
// transverse ribs, arcades on clustered piers, aisles with groin vaults, a triforium, clerestory
// windows open to the sun, stained glass, an apse, pews and chandeliers. x across, the altar at -z.
#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/nave_parts.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

using namespace nave_parts;

struct Materials {
  Index limestone, ashlar, rib, pier, base, floor, aisle_vault, barrel, wood, gold, iron, wax,
      cloth, flame, glass, rose, carpet;
};

Materials make_materials(SceneBuilder& b, std::uint64_t seed) {
  constexpr int kPixels = 1024;
  Materials m{};
  const Palette pale{{0.58F, 0.54F, 0.47F}, {0.90F, 0.87F, 0.80F}};
  m.limestone = b.add(textured("limestone", b.add(plaster("limestone", kPixels, pale, seed))));
  const Masonry blocks{.columns = 2,
                       .courses = 4,
                       .joint = 0.018F,
                       .stone = {{0.55F, 0.50F, 0.42F}, {0.88F, 0.83F, 0.74F}},
                       .mortar = Vec3{0.60F, 0.57F, 0.50F}};
  m.ashlar = b.add(textured("ashlar", b.add(masonry("ashlar", kPixels, blocks, seed + 1))));
  m.rib = b.add(lambert("rib", {0.66F, 0.61F, 0.52F}));
  const Index grey = b.add(
      marble("grey marble", kPixels, {{0.40F, 0.40F, 0.42F}, {0.86F, 0.85F, 0.83F}}, seed + 2));
  m.pier = b.add(glossy(textured("pier", grey), 0.55F));
  m.base = b.add(
      glossy(textured("pier base",
                      b.add(marble("red marble", kPixels,
                                   {{0.28F, 0.09F, 0.07F}, {0.72F, 0.45F, 0.36F}}, seed + 3))),
             0.3F));
  const Tiling slabs{.tiles = 4,
                     .grout = 0.012F,
                     .first = {{0.24F, 0.22F, 0.22F}, {0.42F, 0.40F, 0.39F}},
                     .second = {{0.66F, 0.61F, 0.54F}, {0.88F, 0.84F, 0.77F}}};
  m.floor =
      b.add(glossy(textured("floor", b.add(tiles("slabs", kPixels, slabs, seed + 4))), 0.25F));
  m.aisle_vault = b.add(textured(
      "aisle vault", b.add(plaster("blue plaster", kPixels,
                                   {{0.30F, 0.36F, 0.46F}, {0.62F, 0.68F, 0.76F}}, seed + 5))));
  m.barrel =
      b.add(textured("barrel vault", b.add(masonry("vault stones", kPixels, blocks, seed + 6))));
  m.wood = b.add(glossy(
      textured("wood", b.add(wood("oak", kPixels, {{0.20F, 0.10F, 0.05F}, {0.52F, 0.33F, 0.18F}},
                                  seed + 7))),
      0.4F));
  m.gold = b.add(metal("gold", {0.95F, 0.71F, 0.34F}, 0.28F));
  m.iron = b.add(metal("iron", {0.22F, 0.21F, 0.20F}, 0.5F));
  m.wax = b.add(lambert("wax", {0.86F, 0.80F, 0.66F}));
  m.cloth = b.add(textured(
      "altar cloth", b.add(fabric("altar cloth", kPixels,
                                  {{0.60F, 0.55F, 0.45F}, {0.96F, 0.94F, 0.90F}}, seed + 8))));
  Material runner = textured(
      "runner",
      b.add(carpet("runner", kPixels, {{0.26F, 0.03F, 0.05F}, {0.72F, 0.30F, 0.18F}}, seed + 9)));
  runner.base_color_texture->uv_scale = {16.0F, 1.0F};  // along 30 m
  m.carpet = b.add(std::move(runner));
  m.flame = b.add(lamp("flame", {60.0F, 36.0F, 13.0F}));
  const auto window = [&](const char* name, std::uint64_t s) {
    Material glass = lamp(name, Rgb{1.5F});
    glass.emission_texture = TextureRef{.image = b.add(stained_glass(name, kPixels, 17, s))};
    return b.add(std::move(glass));
  };
  m.glass = window("stained glass", seed + 10);
  m.rose = window("rose window", seed + 11);
  return m;
}

/// Both sides of the nave, bay by bay: x across towards the nave's middle is the frame's +z.
std::vector<DMat4> bay_frames() {
  std::vector<DMat4> frames;
  for (int i = 0; i < kBays; ++i) {
    const double z = -kBay * (i + 0.5);
    frames.push_back(translation({-kHalfWidth, 0.0, z}) * rotation_y(Degrees{90.0}));
    frames.push_back(translation({kHalfWidth, 0.0, z}) * rotation_y(Degrees{-90.0}));
  }
  return frames;
}

void add_arcades(SceneBuilder& b, const Materials& m) {
  using atrium_parts::kGround;
  const DMat4 grown = scaling(DVec3{kBay / atrium_parts::kBay});
  const Index wall = b.add(atrium_parts::spandrel(kGround), m.ashlar);
  const Index soffit = b.add(atrium_parts::intrados(kGround), m.limestone);
  const Index rings = b.add(atrium_parts::archivolt(kGround), m.rib);
  const Index vault = b.add(atrium_parts::vault(kGround), m.aisle_vault);
  const Index course = b.add(atrium_parts::moulding(), m.rib);
  for (const DMat4& frame : bay_frames()) {
    for (const Index mesh : {wall, soffit, rings}) b.place(mesh, frame * grown);
    b.place(vault, frame * translation({0.0, 0.0, -kAisle / 2.0}) * grown);
    b.place(course, frame * translation({0.0, kArcadeTop - 0.1, 0.0}) * grown);
  }
}

void add_piers(SceneBuilder& b, const Materials& m) {
  const Index shaft = b.add(clustered_pier(0.55F, kSpringing - 0.7F), m.pier);
  const Index foot = b.add(atrium_parts::column_base(), m.base);
  const Index head = b.add(atrium_parts::capital(), m.rib);
  const Index shaft_up = b.add(wall_shaft(kSpringing + 0.1F, kVaultSpringing), m.rib);
  for (int i = 0; i <= kBays; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const DMat4 place = translation({side * kHalfWidth, 0.0, -double{kBay} * i});
      b.place(foot, place * scaling(DVec3{1.6, 1.5, 1.6}));
      b.place(shaft, place);
      b.place(head, place * translation({0.0, kSpringing - 0.75, 0.0}) *
                        scaling(DVec3{1.62, 1.62, 1.62}));
      b.place(shaft_up, translation({side * (kHalfWidth - 0.45), 0.0, -double{kBay} * i}));
    }
  }
}

/// Two small arches a bay before a dark passage.
void add_triforium(SceneBuilder& b, const Materials& m) {
  const DMat4 shrunk = scaling(DVec3{0.5 * kBay / atrium_parts::kBay});
  const Index wall = b.add(atrium_parts::spandrel(kTriforium), m.ashlar);
  const Index soffit = b.add(atrium_parts::intrados(kTriforium), m.limestone);
  const Index rings = b.add(atrium_parts::archivolt(kTriforium), m.rib);
  const Index column = b.add(atrium_parts::twisted_shaft(0.0F, kTriforium.springing), m.base);
  const Index rail = b.add(atrium_parts::balusters(), m.rib);
  const Index back = b.add(parallelogram("passage", {-kBay / 2, 0, 0}, {kBay, 0, 0},
                                         {0, kClerestory - kArcadeTop, 0}, {2.5F, 1.4F}),
                           m.limestone);
  for (const DMat4& frame : bay_frames()) {
    b.place(back, frame * translation({0.0, kArcadeTop, -1.3}));
    for (const double x : {-kBay / 4.0, kBay / 4.0}) {
      const DMat4 at = frame * translation({x, kArcadeTop + 0.3, 0.0}) * shrunk;
      for (const Index mesh : {wall, soffit, rings}) b.place(mesh, at);
      b.place(rail, at);
      b.place(column, at * translation({-1.5, 0.0, 0.0}) * scaling(DVec3{1.5, 1.0, 1.5}));
    }
  }
}

/// A round-headed window a bay, open to the sky, in a wall that carries the vault.
void add_clerestory(SceneBuilder& b, const Materials& m) {
  const Index wall = b.add(window_wall(), m.limestone);
  const Index frame_tubes = b.add(tracery(), m.rib);
  const Index course = b.add(atrium_parts::moulding(), m.rib);
  for (const DMat4& frame : bay_frames()) {
    const DMat4 at = frame * translation({0.0, kClerestory, 0.0});
    b.place(wall, at);
    b.place(frame_tubes, at);
    b.place(course, frame * translation({0.0, kVaultSpringing - 0.15, 0.05}) *
                        scaling(DVec3{kBay / atrium_parts::kBay, 1.0, 1.0}));
  }
}

void add_vault(SceneBuilder& b, const Materials& m) {
  const Index shell = b.add(barrel_bay(), m.barrel);
  const Index rib = b.add(transverse_rib(), m.rib);
  for (int i = 0; i < kBays; ++i) b.place(shell, translation({0.0, 0.0, -kBay * (i + 0.5)}));
  for (int i = 0; i <= kBays; ++i) b.place(rib, translation({0.0, 0.0, -double{kBay} * i}));
}

void add_outer_walls(SceneBuilder& b, const Materials& m) {
  const Index wall = b.add(parallelogram("aisle wall", {-kBay / 2, 0, 0}, {kBay, 0, 0},
                                         {0, kArcadeTop, 0}, {2.5F, 4.0F}),
                           m.ashlar);
  const Index window = b.add(arched_pane(0.8F, 2.2F), m.glass);
  const Index surround = b.add(arched_surround(0.8F, 2.2F), m.rib);
  const Index half_pier = b.add(clustered_pier(0.35F, kSpringing), m.pier);
  for (const DMat4& frame : bay_frames()) {
    b.place(wall, frame * translation({0.0, 0.0, -double{kAisle}}));
    for (const Index mesh : {window, surround}) {
      b.place(mesh, frame * translation({0.0, 2.2, -kAisle + 0.06}));
    }
    b.place(half_pier, frame * translation({-kBay / 2, 0.0, -double{kAisle}}));
  }
}

void add_floor(SceneBuilder& b, const Materials& m) {
  const float half = kHalfWidth + kAisle, length = kBay * kBays;
  b.place(parallelogram("floor", {-half, 0, 0}, {2 * half, 0, 0}, {0, 0, -length},
                        Vec2{2 * half, length} / 3.2F),
          m.floor);
  b.place(atrium_parts::rug(1.8F, length - 10.0F, 7), m.carpet,
          translation({0.0, 0.0, -length / 2.0 + 1.0}) * rotation_y(Degrees{90.0}));
}

void add_west_front(SceneBuilder& b, const Materials& m) {
  const float half = kHalfWidth + kAisle, top = kVaultSpringing + kHalfWidth + 0.5F;
  b.place(parallelogram("west wall", {half, 0, 0}, {-2 * half, 0, 0}, {0, top, 0},
                        Vec2{2 * half, top} / 2.0F),
          m.ashlar);
  const DMat4 inward = rotation_y(Degrees{180.0});
  b.place(rose_window(2.4F), m.rose, translation({0.0, 12.5, -0.08}) * inward);
  b.place(rose_tracery(2.4F), m.rib, translation({0.0, 12.5, -0.12}) * inward);
  b.place(panelled_door(), m.wood, translation({0.0, 0.0, -0.1}) * inward);
  // The aisles end in walls too; the nave's own end is the apse.
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (kHalfWidth + kAisle / 2.0);
    b.place(parallelogram("aisle end", {-kAisle / 2, 0, 0}, {kAisle, 0, 0}, {0, kArcadeTop, 0},
                          {2.5F, 4.0F}),
            m.ashlar, translation({x, 0.0, -double{kBay} * kBays}));
  }
}

void add_apse(SceneBuilder& b, const Materials& m) {
  const DMat4 end = translation({0.0, 0.0, -double{kBay} * kBays});
  b.place(apse_wall(), m.ashlar, end);
  b.place(half_dome(), m.aisle_vault, end);
  b.place(apse_floor(), m.floor, end);
  const Index window = b.add(arched_pane(0.75F, 4.4F), m.glass);
  const Index surround = b.add(arched_surround(0.75F, 4.4F), m.rib);
  for (const double angle : {-48.0, -16.0, 16.0, 48.0}) {
    const DMat4 at = end * rotation_y(Degrees{angle}) * translation({0.0, 4.0, -kHalfWidth + 0.08});
    b.place(window, at);
    b.place(surround, at);
  }
  for (int step = 0; step < 3; ++step) {
    const float width = 6.4F - 0.7F * static_cast<float>(step);
    b.place(box("altar step", {width, 0.16F, 4.4F - 0.7F * static_cast<float>(step)}, 1.5F), m.base,
            end * translation({0.0, 0.08 + 0.16 * step, -1.2}));
  }
  const DMat4 altar = end * translation({0.0, 0.48, -1.4});
  b.place(box("altar", {2.6F, 1.0F, 1.0F}, 1.2F), m.pier, altar * translation({0.0, 0.5, 0.0}));
  b.place(altar_cloth(), m.cloth, altar * translation({0.0, 1.02, 0.0}));
  b.place(crucifix(), m.gold, altar * translation({0.0, 1.03, -0.3}));
}

void add_candles(SceneBuilder& b, const Materials& m) {
  const Index stick = b.add(candlestick(), m.gold), candle = b.add(nave_parts::candle(), m.wax);
  const Index flame = b.add(candle_flame(), m.flame);
  for (const double x : {-1.0, -0.65, 0.65, 1.0}) {
    const DMat4 at = translation({x, 1.5, -kBay * kBays - 1.55});
    b.place(stick, at);
    b.place(candle, at * translation({0.0, 0.42, 0.0}));
    b.place(flame, at * translation({0.0, 0.42 + kCandleHeight, 0.0}));
  }
  const Index ring = b.add(chandelier(), m.iron);
  const Index links = b.add(atrium_parts::chain(12.4F), m.iron);
  for (int i = 0; i < 4; ++i) {
    const DVec3 hub{0.0, 6.4, -7.0 - 9.0 * i};
    b.place(ring, translation(hub));
    b.place(links, translation(hub + DVec3{0.0, 12.4 + 0.55, 0.0}));
    for (int k = 0; k < kChandelierCandles; ++k) {
      const DMat4 at = translation(hub) * rotation_y(Degrees{360.0 * k / kChandelierCandles}) *
                       translation({double{kChandelierRadius}, 0.06, 0.0});
      b.place(candle, at);
      b.place(flame, at * translation({0.0, double{kCandleHeight}, 0.0}));
    }
    b.add(Light{.kind = LightKind::Point,
                .intensity = Rgb{17.0F, 10.5F, 4.4F},
                .position = hub + DVec3{0.0, 0.55, 0.0}});
  }
}

void add_pews(SceneBuilder& b, const Materials& m) {
  const Index one = b.add(pew(), m.wood);
  for (int row = 0; row < 18; ++row) {
    for (const double x : {-2.45, 2.45}) b.place(one, translation({x, 0.0, -6.5 - 1.45 * row}));
  }
}

void set_the_scene(SceneBuilder& b) {
  b.add(Light{.kind = LightKind::Directional,
              .intensity = Rgb{15.0F, 13.2F, 10.5F},
              .direction = normalize(Vec3{0.80F, -1.0F, -0.28F})});
  Settings& settings = b.settings();
  settings.ambient = Rgb{0.26F, 0.27F, 0.30F};
  settings.ambient_distance_m = 7.0;
  settings.tone = {.exposure_ev = 1.0F, .curve = image::ToneCurve::Filmic};
  settings.scene_from_stage.position = {0.0, 0.0, -4.0};
  b.add(
      Camera{"nave", math::look_at({0.0, 1.7, -3.0}, {0.0, 4.6, -24.0}, {0, 1, 0}), Degrees{70.0}});
  b.add(Camera{"aisle", math::look_at({7.2, 1.7, -2.0}, {6.0, 2.8, -20.0}, {0, 1, 0}),
               Degrees{70.0}});
  b.add(Camera{"altar", math::look_at({0.8, 1.7, -33.0}, {-0.6, 5.0, -2.0}, {0, 1, 0}),
               Degrees{75.0}});
}

}  // namespace

Scene nave(std::uint64_t seed) {
  SceneBuilder b("nave");
  const Materials m = make_materials(b, seed * 1000);
  add_arcades(b, m);
  add_piers(b, m);
  add_triforium(b, m);
  add_clerestory(b, m);
  add_vault(b, m);
  add_outer_walls(b, m);
  add_floor(b, m);
  add_west_front(b, m);
  add_apse(b, m);
  add_candles(b, m);
  add_pews(b, m);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
