#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

Mesh keyboard() {
  Mesh mesh = box("keyboard", {0.44F, 0.012F, 0.14F});
  for (Vec3& position : mesh.positions) position.y += 0.006F;
  // A key: a dished top on slanted sides.
  const auto cap = [](float u, float v) {
    const float x = 2.0F * u - 1.0F, z = 1.0F - 2.0F * v;
    const float edge = std::max(std::abs(x), std::abs(z));
    const float height =
        0.008F * std::min(1.0F, 5.0F * (1.0F - edge)) - 0.001F * (1.0F - edge * edge);
    const float slant =
        1.0F - 0.18F * std::min(1.0F, 5.0F * (1.0F - edge)) * (edge > 0.6F ? 1.0F : 0.0F);
    return Vec3{0.0085F * x * slant, height, 0.0085F * z * slant};
  };
  const Mesh key = tessellate("", cap, {8, 8, Around::Open});
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 22; ++column)
      append(mesh, key, translation({-0.2 + 0.019 * column, 0.012, -0.05 + 0.02 * row}));
  }
  return mesh;
}

Mesh globe_ball() {
  // Land stands a little out of the sea.
  const auto surface = [](float u, float v) {
    const float azimuth = 2 * kPi * u, polar = kPi * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : std::sin(polar);
    const Vec3 unit{ring * std::cos(azimuth), -std::cos(polar), -ring * std::sin(azimuth)};
    const float land = roughness(1.9F * unit, 5) + 0.5F * roughness(4.3F * unit, 6);
    return 0.2F * (1.0F + 0.02F * std::clamp(4.0F * land, 0.0F, 1.0F)) * unit;
  };
  return tessellate("globe", surface, {160, 80, Around::Closed, {1.0F, 1.0F}});
}

Mesh globe_stand() {
  constexpr std::array<Vec2, 7> kFoot{Vec2{0.0F, 0.0F},   Vec2{0.16F, 0.0F},  Vec2{0.15F, 0.03F},
                                      Vec2{0.03F, 0.07F}, Vec2{0.04F, 0.14F}, Vec2{0.015F, 0.2F},
                                      Vec2{0.0F, 0.22F}};
  Mesh mesh = lathe("globe stand", smooth(kFoot, 4), 32);
  append(mesh, torus("", 0.225F, 0.007F, 80, 8),
         translation({0.0, 0.44, 0.0}) * rotation_z(Degrees{23.0}) * rotation_x(Degrees{90.0}));
  append(mesh, torus("", 0.232F, 0.010F, 80, 8), translation({0.0, 0.44, 0.0}));
  return mesh;
}

Mesh picture_frame(float width, float height) {
  // A moulding around the picture: mitred by running the profile along each side.
  Mesh mesh;
  mesh.name = "picture frame";
  const auto side = [&](float length, const DMat4& at) {
    const auto surface = [length](float u, float v) {
      const float across = 0.06F * v;  // outwards
      const float bead =
          0.006F * std::abs(std::sin(kPi * length / 0.03F * u)) * (v < 0.3F ? 1.0F : 0.0F);
      const float profile = 0.012F + 0.018F * std::sin(kPi * std::sqrt(v)) + bead;
      return Vec3{(length + 2.0F * across) * (u - 0.5F), across, profile};
    };
    append(mesh, tessellate("", surface, {64, 12, Around::Open, {1.0F, 1.0F}}), at);
  };
  side(width, translation({0.0, height / 2.0, 0.0}));
  side(width, rotation_z(Degrees{180.0}) * translation({0.0, height / 2.0, 0.0}));
  side(height, rotation_z(Degrees{90.0}) * translation({0.0, width / 2.0, 0.0}));
  side(height, rotation_z(Degrees{-90.0}) * translation({0.0, width / 2.0, 0.0}));
  return mesh;
}

Mesh fireplace() {
  Mesh mesh;
  mesh.name = "fireplace";
  const auto block = [&](const Vec3& size, const DVec3& at) {
    append(mesh, box("", size, 0.7F), translation(at));
  };
  block({1.9F, 0.08F, 0.55F}, {0.0, 1.24, -0.12});
  block({1.8F, 0.16F, 0.42F}, {0.0, 1.12, -0.14});
  block({2.0F, 0.05F, 0.9F}, {0.0, 0.005, 0.15});
  block({1.3F, 1.1F, 0.04F}, {0.0, 0.55, -0.38});
  // Twisted columns carry the mantel.
  const auto column = [](float u, float v) {
    const float strands = std::cos(2 * kPi * (3.0F * u + 2.0F * v));
    const float r = 0.075F + 0.016F * strands;
    return Vec3{r * std::cos(2 * kPi * u), 0.12F + 0.84F * v, -r * std::sin(2 * kPi * u)};
  };
  for (const double x : {-0.72, 0.72}) {
    block({0.30F, 1.04F, 0.30F}, {x, 0.52, -0.22});
    block({0.24F, 0.10F, 0.24F}, {x, 0.07, 0.0});
    block({0.24F, 0.08F, 0.24F}, {x, 1.0, 0.0});
    append(mesh, tessellate("", column, {48, 48, Around::Closed, {1.0F, 2.0F}}),
           translation({x, 0.0, 0.0}));
  }
  // A frieze of waves under the mantel.
  const auto frieze = [](float u, float v) {
    const float wave = std::sin(2 * kPi * 9.0F * u) * std::sin(kPi * v);
    return Vec3{1.3F * (u - 0.5F), 1.04F + 0.16F * v, 0.07F + 0.012F * wave};
  };
  append(mesh, tessellate("", frieze, {144, 12, Around::Open, {1.3F, 0.2F}}));
  return mesh;
}

Mesh fire_irons() {
  Mesh mesh;
  mesh.name = "grate";
  for (int i = 0; i < 9; ++i) {
    const float x = -0.32F + 0.08F * static_cast<float>(i);
    const std::array bar{Vec3{x, 0.06F, -0.2F}, Vec3{x, 0.03F, 0.0F}, Vec3{x, 0.06F, 0.16F},
                         Vec3{x, 0.16F, 0.2F}};
    append(mesh, tube("", bar, 0.007F, 8));
  }
  for (const float x : {-0.36F, 0.36F}) {
    const std::array dog{Vec3{x, 0.0F, 0.24F}, Vec3{x, 0.1F, 0.2F}, Vec3{x, 0.3F, 0.2F}};
    append(mesh, tube("", dog, 0.014F, 10));
    append(mesh, sphere("", 0.03F, 20, 12), translation({double{x}, 0.32, 0.2}));
  }
  return mesh;
}

Mesh leafy_plant(int leaves, float size, std::uint64_t seed) {
  Dice dice(seed);
  Mesh mesh;
  mesh.name = "plant";
  for (int i = 0; i < leaves; ++i) {
    const float azimuth = 2 * kPi * (0.382F * static_cast<float>(i) + 0.1F * dice.next());
    const float lean = dice.in(0.25F, 1.0F),
                tall = size * dice.in(0.45F, 1.0F) * (1.1F - 0.5F * lean);
    const Vec3 out{std::cos(azimuth), 0.0F, std::sin(azimuth)};
    const Vec3 tip = size * 0.6F * lean * out + Vec3{0.0F, tall, 0.0F};
    const std::array stalk{Vec3{0.02F * out.x, 0.0F, 0.02F * out.z},
                           0.35F * tip + Vec3{0.0F, 0.18F * tall, 0.0F}, tip};
    append(mesh, tube("", stalk, 0.005F, 6));
    // A leaf: keeled, wavy at its edge, drooping from the stalk's end.
    const float length = size * dice.in(0.25F, 0.42F), droop = dice.in(0.2F, 0.9F);
    const auto blade = [=](float u, float v) {
      const float wide = 0.42F * length * std::sin(kPi * std::pow(v, 0.75F)) + 1e-4F;
      const float x = wide * (2.0F * u - 1.0F);
      const float edge = std::abs(2.0F * u - 1.0F);
      const float wave = 0.03F * length * edge * std::sin(14.0F * v + 3.0F * u);
      return Vec3{x, 0.25F * std::abs(x) + wave - droop * length * v * v, -length * v};
    };
    append(
        mesh, tessellate("", blade, {10, 18, Around::Open, {1.0F, 1.0F}}),
        translation(DVec3(tip)) * rotation_y(Radians{-double{azimuth} - 0.5 * std::numbers::pi}));
  }
  return mesh;
}

Mesh plant_pot(float radius) {
  const std::array<Vec2, 9> profile{
      Vec2{0.0F, 0.0F},
      Vec2{0.68F * radius, 0.0F},
      Vec2{0.75F * radius, 0.1F * radius},
      Vec2{0.95F * radius, 1.2F * radius},
      Vec2{1.05F * radius, 1.3F * radius},
      Vec2{1.05F * radius, 1.5F * radius},
      Vec2{0.95F * radius, 1.5F * radius},
      Vec2{0.92F * radius, 1.3F * radius},
      Vec2{0.0F, 1.3F * radius},
  };
  return lathe("pot", profile, 48, {3.0F, 1.0F});
}

Mesh plate() {
  constexpr std::array<Vec2, 8> kProfile{
      Vec2{0.0F, 0.0F},     Vec2{0.08F, 0.0F},   Vec2{0.085F, 0.006F}, Vec2{0.13F, 0.018F},
      Vec2{0.132F, 0.021F}, Vec2{0.09F, 0.012F}, Vec2{0.08F, 0.007F},  Vec2{0.0F, 0.006F}};
  return lathe("plate", smooth(kProfile, 3), 64);
}

Mesh wine_glass() {
  constexpr std::array<Vec2, 12> kProfile{
      Vec2{0.0F, 0.0F},    Vec2{0.036F, 0.0F},  Vec2{0.034F, 0.003F}, Vec2{0.005F, 0.012F},
      Vec2{0.004F, 0.07F}, Vec2{0.008F, 0.09F}, Vec2{0.034F, 0.12F},  Vec2{0.036F, 0.15F},
      Vec2{0.030F, 0.19F}, Vec2{0.028F, 0.19F}, Vec2{0.032F, 0.13F},  Vec2{0.0F, 0.095F}};
  return lathe("glass", smooth(kProfile, 4), 48);
}

Mesh bowl() {
  constexpr std::array<Vec2, 8> kProfile{
      Vec2{0.0F, 0.0F},   Vec2{0.06F, 0.0F},    Vec2{0.065F, 0.015F}, Vec2{0.12F, 0.06F},
      Vec2{0.15F, 0.10F}, Vec2{0.146F, 0.103F}, Vec2{0.11F, 0.065F},  Vec2{0.0F, 0.02F}};
  return lathe("bowl", smooth(kProfile, 4), 64, {4.0F, 1.0F});
}

Mesh piano() {
  Mesh mesh = box("piano", {1.5F, 1.2F, 0.32F}, 1.0F);
  for (Vec3& position : mesh.positions) position += Vec3{0.0F, 0.6F, -0.18F};
  const auto block = [&](const Vec3& size, const DVec3& at) {
    append(mesh, box("", size, 1.0F), translation(at));
  };
  block({1.5F, 0.10F, 0.34F}, {0.0, 0.64, 0.12});
  block({1.56F, 0.04F, 0.36F}, {0.0, 1.22, -0.17});
  for (const double x : {-0.72, 0.72}) {
    block({0.08F, 0.18F, 0.34F}, {x, 0.76, 0.12});
    const auto console = [](float u, float v) {
      const float r = 0.035F + 0.015F * std::sin(2 * kPi * v);
      return Vec3{r * std::cos(2 * kPi * u), 0.6F * v, 0.22F - r * std::sin(2 * kPi * u)};
    };
    append(mesh, tessellate("", console, {24, 30, Around::Closed}), translation({x, 0.0, 0.0}));
  }
  return mesh;
}

Mesh white_keys() {
  Mesh mesh;
  mesh.name = "white keys";
  for (int i = 0; i < 52; ++i)
    append(mesh, box("", {0.0225F, 0.02F, 0.15F}), translation({0.0235 * (i - 25.5), 0.70, 0.20}));
  return mesh;
}

Mesh black_keys() {
  Mesh mesh;
  mesh.name = "black keys";
  for (int i = 0; i < 51; ++i) {
    // None between B and C, none between E and F; the first key is an A.
    if (i % 7 == 1 || i % 7 == 4) continue;
    append(mesh, box("", {0.012F, 0.02F, 0.09F}), translation({0.0235 * (i - 25.0), 0.715, 0.17}));
  }
  return mesh;
}

}  // namespace macula::scene::built_in
