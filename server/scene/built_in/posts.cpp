// A room for measuring reprojection: objects at 0.7 to 4 m around the viewer at the origin, thin
// posts that uncover the background at every step, and Lambertian surfaces with a 1/f spectrum
// whose finest detail still spans some pixels at 9 pixels per degree, so that errors come from the
// warp alone.
#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

constexpr int kTextureSize = 512;
/// Lattice cells of the finest octave across a texture: 2 << 5.
constexpr float kFinestCells = 64.0F;
/// One pixel at 9 pixels per degree, seen from 1 m.
constexpr float kPixelAtOneMeter = 0.00194F;

/// The side of a texture tile, in meters, whose finest lattice cell spans `kCellPixels` at this
/// distance.
float tile_size_m(float distance_m) {
  constexpr float kCellPixels = 4.0F;
  return kFinestCells * kCellPixels * kPixelAtOneMeter * distance_m;
}

Index surface(SceneBuilder& builder, const std::string& name, const Palette& palette,
              std::uint64_t seed) {
  Field field = noise(kTextureSize, {.cells = 2, .octaves = 6}, seed);
  for (float& value : field.pixels()) value = 0.5F + 0.9F * value;
  return builder.add(textured(name, builder.add(colored(name, field, palette))));
}

struct Room {
  float half_width = 4.2F, height = 3.0F, front = -4.6F, back = 3.0F;
};

void add_room(SceneBuilder& builder, const Room& room, std::uint64_t seed) {
  const Index wall = surface(builder, "wall", {{0.35F, 0.30F, 0.28F}, {0.95F, 0.88F, 0.78F}}, seed);
  const Index side =
      surface(builder, "side wall", {{0.22F, 0.33F, 0.38F}, {0.75F, 0.88F, 0.90F}}, seed + 1);
  const Index floor =
      surface(builder, "floor", {{0.25F, 0.16F, 0.10F}, {0.85F, 0.70F, 0.52F}}, seed + 2);
  const float w = room.half_width, h = room.height, length = room.back - room.front;
  const auto wall_of = [&](const char* name, Index material, const Vec3& corner, const Vec3& u,
                           const Vec3& v) {
    const Vec2 repeat = Vec2{glm::length(u), glm::length(v)} / tile_size_m(4.0F);
    builder.place(parallelogram(name, corner, u, v, repeat), material);
  };
  wall_of("floor", floor, {-w, 0, room.back}, {2 * w, 0, 0}, {0, 0, -length});
  wall_of("ceiling", wall, {-w, h, room.front}, {2 * w, 0, 0}, {0, 0, length});
  wall_of("front wall", wall, {-w, 0, room.front}, {2 * w, 0, 0}, {0, h, 0});
  wall_of("back wall", wall, {w, 0, room.back}, {-2 * w, 0, 0}, {0, h, 0});
  wall_of("left wall", side, {-w, 0, room.back}, {0, 0, -length}, {0, h, 0});
  wall_of("right wall", side, {w, 0, room.front}, {0, 0, length}, {0, h, 0});
}

void add_posts(SceneBuilder& builder, std::uint64_t seed) {
  const Index paint =
      surface(builder, "post", {{0.15F, 0.20F, 0.45F}, {0.70F, 0.78F, 0.95F}}, seed);
  struct Post {
    float azimuth_deg, distance_m, radius_m;
  };
  constexpr std::array kPosts{Post{-22, 0.9F, 0.015F}, Post{14, 1.3F, 0.02F}, Post{34, 2.2F, 0.03F},
                              Post{-48, 1.7F, 0.025F}, Post{-6, 3.2F, 0.035F}};
  for (const Post& post : kPosts) {
    const float azimuth = static_cast<float>(Radians(Degrees{post.azimuth_deg}).value());
    const float height = 2.4F, tile = tile_size_m(post.distance_m);
    const std::array<Vec2, 5> profile{
        Vec2{post.radius_m, 0}, Vec2{post.radius_m, height / 2}, Vec2{post.radius_m, height},
        Vec2{post.radius_m * 0.5F, height + post.radius_m}, Vec2{0, height + post.radius_m}};
    const Vec2 repeat{std::max(1.0F, std::round(6.283F * post.radius_m / tile)), height / tile};
    builder.place(lathe("post", profile, 20, repeat), paint,
                  translation({post.distance_m * std::sin(azimuth), 0.0,
                               -post.distance_m * std::cos(azimuth)}));
  }
}

void add_objects(SceneBuilder& builder, std::uint64_t seed) {
  const Index clay = surface(builder, "clay", {{0.40F, 0.15F, 0.10F}, {0.95F, 0.62F, 0.45F}}, seed);
  const Index moss =
      surface(builder, "moss", {{0.12F, 0.25F, 0.10F}, {0.70F, 0.85F, 0.48F}}, seed + 1);
  const Index chalk =
      surface(builder, "chalk", {{0.40F, 0.40F, 0.42F}, {0.97F, 0.96F, 0.93F}}, seed + 2);
  builder.place(sphere("ball", 0.32F, 48, 24, {3, 2}), clay, translation({0.55, 1.15, -2.0}));
  builder.place(sphere("near ball", 0.10F, 40, 20, {2, 1}), moss,
                translation({-0.12, 1.38, -0.75}));
  builder.place(sphere("far ball", 0.55F, 48, 24, {2, 1}), chalk, translation({-2.3, 0.55, -3.1}));
  builder.place(box("crate", {0.7F, 0.9F, 0.7F}, tile_size_m(2.8F)), chalk,
                translation({1.7, 0.45, -2.7}) * rotation_y(Degrees{32.0}));
  builder.place(box("table top", {1.1F, 0.05F, 0.6F}, tile_size_m(1.5F)), clay,
                translation({-1.0, 0.85, -1.5}) * rotation_y(Degrees{-20.0}));
  builder.place(torus("ring", 0.30F, 0.06F, 56, 20, {4, 1}), moss,
                translation({-0.75, 1.75, -2.5}) * rotation_x(Degrees{70.0}));
  builder.place(torus("hoop", 0.22F, 0.02F, 56, 12, {6, 1}), clay,
                translation({0.95, 1.75, -1.4}) * rotation_x(Degrees{90.0}));
}

}  // namespace

Scene posts(std::uint64_t seed) {
  SceneBuilder builder("posts");
  add_room(builder, Room{}, seed * 16);
  add_posts(builder, seed * 16 + 4);
  add_objects(builder, seed * 16 + 8);
  builder.add(Light{
      .kind = LightKind::Point, .intensity = Rgb{9.0F, 8.6F, 8.0F}, .position = {0.6, 2.7, -0.6}});

  Settings& settings = builder.settings();
  settings.ambient = Rgb{0.35F, 0.36F, 0.38F};
  settings.ambient_distance_m = 1.5;
  settings.tone.exposure_ev = 0.7F;
  builder.add(
      Camera{"stage", math::look_at({0.0, 1.6, 0.0}, {0.0, 1.35, -2.5}, {0, 1, 0}), Degrees{60.0}});
  return std::move(builder).finish();
}

}  // namespace macula::scene::built_in
