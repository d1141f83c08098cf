// A room in which everything that can move does: rings and a mobile turn, a crate slides, a ball
// rolls without slipping, a banner waves, a lantern swings and a lamp without a body circles. All
// of it repeats; after kCycle the whole room is again as it was at time 0.
#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

constexpr int kTextureSize = 512;
constexpr std::chrono::seconds kCycle{24};  // every period below divides it
constexpr double kTurn = 2.0 * std::numbers::pi;

Nanoseconds cycle_over(int parts) {
  return kCycle / parts;
}

// ---- tracks ----

/// Keys at equal steps over one period, the last as the first.
template <class Value, class At>
Track<Value> sampled(Nanoseconds period, int steps, const At& at) {
  Track<Value> track;
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    track.times_s.push_back(share * units::to_s(period));
    track.values.push_back(at(share));
  }
  return track;
}

Joint repeating(std::string name, const DMat4& parent_from_base, int parts) {
  Joint joint;
  joint.name = std::move(name);
  joint.parent_from_base = parent_from_base;
  joint.period = cycle_over(parts);
  return joint;
}

/// Turns about its own axis for ever, `turns` times a period; negative: the other way.
Joint turning(std::string name, const DMat4& parent_from_base, const DVec3& axis, int parts,
              int turns = 1) {
  Joint joint = repeating(std::move(name), parent_from_base, parts);
  // Eighths of a turn: the shorter arc between two keys is the one meant.
  joint.rotations = sampled<DQuat>(joint.period, 8 * std::abs(turns), [&](double share) {
    return glm::angleAxis(kTurn * turns * share, axis);
  });
  return joint;
}

Joint swinging(std::string name, const DMat4& parent_from_base, const DVec3& axis,
               Radians amplitude, int parts) {
  Joint joint = repeating(std::move(name), parent_from_base, parts);
  joint.rotations = sampled<DQuat>(joint.period, 24, [&](double share) {
    return glm::angleAxis(amplitude.value() * std::cos(kTurn * share), axis);
  });
  return joint;
}

/// There and back, at rest at both ends.
Joint sliding(std::string name, const DVec3& from, const DVec3& to, int parts) {
  Joint joint = repeating(std::move(name), DMat4{1.0}, parts);
  const double half = 0.5 * units::to_s(joint.period);
  const DVec3 rest{0.0};
  joint.translations = {Interpolation::CubicSpline,
                        {0.0, half, 2.0 * half},
                        {rest, from, rest, rest, to, rest, rest, from, rest}};
  return joint;
}

/// A ball that rolls along +x and back on the plane y = 0: it turns by its way over its radius.
Joint rolling(const DVec3& from, double way_m, double radius_m, int parts) {
  Joint joint = repeating("rolling", DMat4{1.0}, parts);
  const auto position = [&](double share) { return 0.5 * way_m * (1.0 - std::cos(kTurn * share)); };
  joint.translations = sampled<DVec3>(joint.period, 48, [&](double share) {
    return from + DVec3{position(share), radius_m, 0.0};
  });
  joint.rotations = sampled<DQuat>(joint.period, 48, [&](double share) {
    return glm::angleAxis(-position(share) / radius_m, DVec3{0.0, 0.0, 1.0});
  });
  return joint;
}

// ---- the room ----

struct Materials {
  Index plaster, side_wall, floor, wood, clay, brass, steel, cloth, lantern;
};

Materials add_materials(SceneBuilder& builder, std::uint64_t seed) {
  const auto image = [&](Image picture) { return builder.add(std::move(picture)); };
  const auto painted = [&](const char* name, Image picture) {
    return builder.add(textured(name, image(std::move(picture))));
  };
  Materials m{};
  m.plaster = painted("plaster", plaster("plaster", kTextureSize,
                                         {{0.72F, 0.69F, 0.63F}, {0.93F, 0.91F, 0.86F}}, seed));
  m.side_wall = painted(
      "side wall",
      plaster("side wall", kTextureSize, {{0.22F, 0.38F, 0.42F}, {0.42F, 0.60F, 0.62F}}, seed + 1));
  m.floor = painted("floor", tiles("floor", kTextureSize,
                                   {.tiles = 4,
                                    .grout = 0.015F,
                                    .first = {{0.55F, 0.30F, 0.20F}, {0.74F, 0.45F, 0.32F}},
                                    .second = {{0.70F, 0.62F, 0.50F}, {0.88F, 0.80F, 0.68F}}},
                                   seed + 2));
  m.wood = painted(
      "wood", wood("wood", kTextureSize, {{0.35F, 0.20F, 0.10F}, {0.68F, 0.46F, 0.26F}}, seed + 3));
  m.clay = painted("clay", marble("clay", kTextureSize,
                                  {{0.50F, 0.16F, 0.12F}, {0.95F, 0.72F, 0.58F}}, seed + 4));
  m.cloth = painted("cloth", fabric("cloth", kTextureSize,
                                    {{0.42F, 0.08F, 0.12F}, {0.86F, 0.66F, 0.30F}}, seed + 5));
  m.brass = builder.add(metal("brass", {0.86F, 0.66F, 0.32F}, 0.45F));
  m.steel = builder.add(metal("steel", {0.68F, 0.70F, 0.73F}, 0.40F));
  m.lantern = builder.add(lamp("lantern", {34.0F, 22.0F, 10.0F}));
  return m;
}

void add_room(SceneBuilder& builder, const Materials& m) {
  constexpr float kHalfWidth = 3.0F, kHeight = 3.0F, kFront = -4.0F, kBack = 2.8F;
  constexpr float kTile = 1.6F;  // m of wall one texture covers
  const auto wall = [&](const char* name, Index material, const Vec3& corner, const Vec3& u,
                        const Vec3& v) {
    builder.place(parallelogram(name, corner, u, v, Vec2{glm::length(u), glm::length(v)} / kTile),
                  material);
  };
  const float w = kHalfWidth, h = kHeight, length = kBack - kFront;
  wall("floor", m.floor, {-w, 0, kBack}, {2 * w, 0, 0}, {0, 0, -length});
  wall("ceiling", m.plaster, {-w, h, kFront}, {2 * w, 0, 0}, {0, 0, length});
  wall("front", m.plaster, {-w, 0, kFront}, {2 * w, 0, 0}, {0, h, 0});
  wall("back", m.plaster, {w, 0, kBack}, {-2 * w, 0, 0}, {0, h, 0});
  wall("left", m.side_wall, {-w, 0, kBack}, {0, 0, -length}, {0, h, 0});
  wall("right", m.side_wall, {w, 0, kFront}, {0, 0, length}, {0, h, 0});
}

// ---- what moves ----

/// Three rings in each other on a wooden foot, a ball in the middle.
void add_rings(SceneBuilder& builder, const Materials& m) {
  const DVec3 centre{-1.55, 1.15, -1.9};
  const std::array<Vec2, 5> foot{Vec2{0.30F, 0.0F}, Vec2{0.28F, 0.06F}, Vec2{0.07F, 0.12F},
                                 Vec2{0.05F, 0.35F}, Vec2{0.07F, 0.52F}};
  builder.place(lathe("foot", smooth(foot, 6), 32, {4, 2}), m.wood,
                translation({centre.x, 0.0, centre.z}));
  const Index outer = builder.add(turning("outer ring", translation(centre), {0, 1, 0}, 3));
  Joint next = turning("middle ring", DMat4{1.0}, {1, 0, 0}, 4);
  next.parent = outer;
  const Index middle = builder.add(std::move(next));
  next = turning("inner ring", DMat4{1.0}, {0, 0, 1}, 6, -1);
  next.parent = middle;
  const Index inner = builder.add(std::move(next));
  builder.hang(outer, builder.add(torus("outer ring", 0.60F, 0.030F, 64, 12, {12, 1}), m.brass),
               rotation_x(Degrees{90.0}));
  builder.hang(middle, builder.add(torus("middle ring", 0.50F, 0.026F, 64, 12, {10, 1}), m.steel),
               rotation_x(Degrees{90.0}));
  builder.hang(inner, builder.add(torus("inner ring", 0.40F, 0.022F, 56, 12, {8, 1}), m.brass),
               rotation_z(Degrees{90.0}));
  builder.hang(inner, builder.add(sphere("core", 0.20F, 40, 20, {2, 1}), m.clay), DMat4{1.0});
}

/// A bar under the ceiling with a smaller bar under each end, and things on those.
void add_mobile(SceneBuilder& builder, const Materials& m) {
  const Index bar = builder.add(turning("mobile", translation({0.2, 2.62, -2.9}), {0, 1, 0}, 2));
  const auto rod = [](float half_length) {
    const std::array<Vec3, 2> path{Vec3{-half_length, 0, 0}, Vec3{half_length, 0, 0}};
    return tube("rod", path, 0.008F, 8);
  };
  builder.hang(bar, builder.add(rod(0.62F), m.steel), DMat4{1.0});
  const Index thing_box = builder.add(box("cube", Vec3{0.14F}, 0.3F), m.wood);
  const Index thing_ball = builder.add(sphere("bead", 0.09F, 28, 14, {2, 1}), m.clay);
  const Index thing_ring = builder.add(torus("hoop", 0.10F, 0.022F, 36, 10, {4, 1}), m.brass);
  const Index twig = builder.add(rod(0.26F), m.steel);
  const Index thread = builder.add(
      tube("thread", std::array<Vec3, 2>{Vec3{0, 0, 0}, Vec3{0, -0.22F, 0}}, 0.004F, 6), m.steel);
  for (const double side : {-1.0, 1.0}) {
    Joint joint = turning("twig", translation({0.6 * side, -0.22, 0.0}), {0, 1, 0}, 4, -1);
    joint.parent = bar;
    const Index carried = builder.add(std::move(joint));
    builder.hang(bar, thread, translation({0.6 * side, 0.0, 0.0}));
    builder.hang(carried, twig, DMat4{1.0});
    for (const double end : {-1.0, 1.0})
      builder.hang(carried, thread, translation({0.25 * end, 0.0, 0.0}));
    const DMat4 left = translation({-0.25, -0.30, 0.0}), right = translation({0.25, -0.30, 0.0});
    builder.hang(carried, side < 0.0 ? thing_box : thing_ring, left * rotation_x(Degrees{35.0}));
    builder.hang(carried, thing_ball, right);
  }
}

void add_sliders(SceneBuilder& builder, const Materials& m) {
  const Index crate = builder.add(sliding("crate", {0.55, 0.30, -2.9}, {2.30, 0.30, -2.9}, 4));
  builder.hang(crate, builder.add(box("crate", {0.7F, 0.6F, 0.6F}, 0.8F), m.wood),
               rotation_y(Degrees{12.0}));
  constexpr double kRadius = 0.24;
  const Index ball = builder.add(rolling({-0.9, 0.0, -0.75}, 1.7, kRadius, 3));
  builder.hang(ball,
               builder.add(sphere("ball", static_cast<float>(kRadius), 48, 24, {2, 1}), m.clay),
               DMat4{1.0});
}

/// The banner's shape at a share of its period; u to the right, v upwards to the pole.
Vec3 banner(float u, float v, float share) {
  constexpr float kWidth = 1.5F, kHeight = 1.35F;
  constexpr float kRound = static_cast<float>(kTurn);
  const float drop = 1.0F - v;  // 0 at the pole: held there
  const float wave = 0.15F * drop * std::sin(kRound * (1.15F * u - share)) +
                     0.05F * drop * drop * std::sin(kRound * (2.2F * u + 0.8F * v - 2.0F * share));
  const float sway = 0.03F * drop * std::sin(kRound * (share + 0.3F));
  return {kWidth * (u - 0.5F) + sway, -kHeight * drop, wave};
}

void add_banner(SceneBuilder& builder, const Materials& m) {
  constexpr int kKeys = 24;
  const Nanoseconds period = cycle_over(6);
  const auto at = [](float share) {
    return tessellate("banner", [share](float u, float v) { return banner(u, v, share); },
                      {.columns = 48, .rows = 40, .texcoord_scale = {3.0F, 2.7F}});
  };
  Mesh mesh = at(0.0F);
  for (int key = 0; key <= kKeys; ++key) {
    const double share = static_cast<double>(key) / kKeys;
    Mesh shape = at(static_cast<float>(key % kKeys) / kKeys);
    mesh.deformation.times_s.push_back(share * units::to_s(period));
    mesh.deformation.positions.push_back(std::move(shape.positions));
    mesh.deformation.normals.push_back(std::move(shape.normals));
  }
  mesh.deformation.period = period;
  const DMat4 place = translation({1.75, 2.35, -1.55}) * rotation_y(Degrees{-24.0});
  builder.place(std::move(mesh), m.cloth, place);
  const std::array<Vec3, 2> pole{Vec3{-0.82F, 0.01F, 0}, Vec3{0.82F, 0.01F, 0}};
  builder.place(tube("pole", pole, 0.018F, 12), m.brass, place);
}

void add_lights(SceneBuilder& builder, const Materials& m) {
  const Index pendulum = builder.add(
      swinging("lantern", translation({0.25, 2.98, -1.7}), {0, 0, 1}, Degrees{24.0}, 8));
  const std::array<Vec3, 2> cord{Vec3{0, 0, 0}, Vec3{0, -1.08F, 0}};
  builder.hang(pendulum, builder.add(tube("cord", cord, 0.007F, 8), m.steel), DMat4{1.0});
  const std::array<Vec2, 4> cap{Vec2{0.17F, -0.02F}, Vec2{0.13F, 0.05F}, Vec2{0.05F, 0.09F},
                                Vec2{0.0F, 0.10F}};
  builder.hang(pendulum, builder.add(lathe("cap", smooth(cap, 4), 24), m.brass),
               translation({0.0, -1.14, 0.0}));
  builder.hang(pendulum, builder.add(sphere("lantern", 0.13F, 8, 4), m.lantern),
               translation({0.0, -1.24, 0.0}));
  const Index circle =
      builder.add(turning("circling", translation({0.0, 1.95, -1.0}), {0, 1, 0}, 3));
  Light light{
      .kind = LightKind::Point, .intensity = Rgb{3.4F, 3.9F, 4.8F}, .position = {1.5, 0.0, 0.0}};
  light.joint = circle;
  builder.add(light);
}

}  // namespace

Scene moving(std::uint64_t seed) {
  SceneBuilder builder("moving");
  const Materials materials = add_materials(builder, seed * 32);
  add_room(builder, materials);
  add_rings(builder, materials);
  add_mobile(builder, materials);
  add_sliders(builder, materials);
  add_banner(builder, materials);
  add_lights(builder, materials);

  Settings& settings = builder.settings();
  settings.scene_from_stage.position = {0.0, 0.0, 1.7};
  settings.ambient = Rgb{0.22F, 0.22F, 0.24F};
  settings.ambient_distance_m = 1.5;
  settings.tone.exposure_ev = 0.6F;
  builder.add(
      Camera{"front", math::look_at({0.0, 1.6, 2.4}, {0.0, 1.35, -2.0}, {0, 1, 0}), Degrees{58.0}});
  return std::move(builder).finish();
}

}  // namespace macula::scene::built_in
