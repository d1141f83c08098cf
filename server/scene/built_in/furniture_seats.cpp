#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textiles.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// 0 at a button, 1 between buttons; the buttons stand in a diamond lattice.
float tuft(float x, float y) {
  const float a = std::sin(kPi * (x + y)), b = std::sin(kPi * (x - y));
  return std::pow(std::abs(a * b), 0.5F);
}

Mesh turned_leg(float height, float radius) {
  const std::array<Vec2, 9> profile{Vec2{0.0F, 0.0F},
                                    Vec2{0.5F * radius, 0.0F},
                                    Vec2{0.7F * radius, 0.06F * height},
                                    Vec2{0.4F * radius, 0.16F * height},
                                    Vec2{0.9F * radius, 0.55F * height},
                                    Vec2{0.5F * radius, 0.74F * height},
                                    Vec2{radius, 0.80F * height},
                                    Vec2{0.8F * radius, 0.88F * height},
                                    Vec2{radius, height}};
  return lathe("", smooth(profile, 4), 20, {1.0F, 1.0F});
}

}  // namespace

Armchair armchair(float seat_width) {
  constexpr float kSeatHeight = 0.44F, kDepth = 0.62F, kBackHeight = 0.56F;
  Armchair result;
  Mesh& leather = result.leather;
  leather = cushion({seat_width / 2, 0.10F, kDepth / 2}, 96, 40);
  for (Vec3& position : leather.positions) position.y += kSeatHeight - 0.06F;
  append(leather, box("", {seat_width + 0.2F, 0.22F, kDepth}, 0.5F), translation({0.0, 0.24, 0.0}));
  // The buttoned back: a lattice of dimples on a leaning, rounded panel.
  const float columns = std::round(seat_width / 0.16F);
  const auto back = [=](float u, float v) {
    const float dome = std::pow(std::max(0.0F, std::sin(kPi * v)), 0.5F);
    const float depth = 0.05F * tuft(columns * u, 4.0F * v) * dome + 0.05F * dome;
    return Vec3{(seat_width + 0.16F) * (u - 0.5F), kSeatHeight + kBackHeight * v,
                -kDepth / 2 + 0.06F - 0.16F * v + depth};
  };
  append(leather, tessellate("", back, {140, 100, Around::Open, {2.0F, 1.5F}}));
  const auto rear = [=](float u, float v) {
    return Vec3{(seat_width + 0.16F) * (0.5F - u), 0.2F + (kBackHeight + 0.24F) * v,
                -kDepth / 2 - 0.04F - 0.13F * v - 0.03F * std::sin(kPi * u)};
  };
  append(leather, tessellate("", rear, {32, 16, Around::Open, {2.0F, 1.5F}}));
  // Rolled arms and top: tubes with gathered ends.
  const auto roll = [](float length, float radius) {
    const auto surface = [=](float u, float v) {
      const float end = std::min(1.0F, 14.0F * std::min(v, 1.0F - v));
      const float gather = 1.0F + 0.03F * std::cos(2 * kPi * 18.0F * u) * (1.0F - end);
      const float r = radius * gather * std::sqrt(std::max(0.0F, 1.0F - (1 - end) * (1 - end)));
      return Vec3{r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), length * (v - 0.5F)};
    };
    return tessellate("", surface, {72, 40, Around::Closed, {2.0F, 2.0F}});
  };
  for (const double side : {-1.0, 1.0}) {
    append(leather, roll(kDepth + 0.1F, 0.10F),
           translation({side * (seat_width / 2.0 + 0.08), 0.60, 0.02}));
    append(leather, box("", {0.14F, 0.46F, kDepth}, 0.5F),
           translation({side * (seat_width / 2.0 + 0.08), 0.36, 0.0}));
  }
  append(leather, roll(seat_width + 0.3F, 0.08F),
         translation({0.0, kSeatHeight + kBackHeight, -kDepth / 2.0 - 0.10}) *
             rotation_y(Degrees{90.0}));
  leather.name = "leather";
  for (const double x : {-1.0, 1.0}) {
    for (const double z : {-1.0, 1.0})
      append(result.legs, turned_leg(0.14F, 0.035F),
             translation({x * (seat_width / 2.0 + 0.03), 0.0, z * (kDepth / 2.0 - 0.06)}));
  }
  result.legs.name = "legs";
  return result;
}

Mesh table(float width, float depth, float height) {
  Mesh mesh = box("table", {width, 0.035F, depth}, 0.9F);
  for (Vec3& position : mesh.positions) position.y += height - 0.0175F;
  append(mesh, box("", {width - 0.16F, 0.09F, depth - 0.16F}, 0.9F),
         translation({0.0, height - 0.08, 0.0}));
  for (const double x : {-1.0, 1.0}) {
    for (const double z : {-1.0, 1.0})
      append(mesh, turned_leg(height - 0.035F, 0.045F),
             translation({x * (width / 2.0 - 0.10), 0.0, z * (depth / 2.0 - 0.10)}));
  }
  return mesh;
}

Mesh desk() {
  constexpr float kWidth = 1.8F, kDepth = 0.85F, kTop = 0.76F;
  Mesh mesh = box("desk", {kWidth, 0.04F, kDepth}, 0.9F);
  for (Vec3& position : mesh.positions) position.y += kTop - 0.02F;
  constexpr std::array<Vec2, 7> kKnob{
      Vec2{0.0F, 0.0F},     Vec2{0.008F, 0.0F},   Vec2{0.006F, 0.012F}, Vec2{0.014F, 0.02F},
      Vec2{0.016F, 0.026F}, Vec2{0.010F, 0.032F}, Vec2{0.0F, 0.033F}};
  const Mesh knob = lathe("", smooth(kKnob, 3), 20);
  for (const double side : {-1.0, 1.0}) {
    const DMat4 pedestal = translation({side * 0.64, 0.0, 0.0});
    append(mesh, box("", {0.46F, kTop - 0.10F, kDepth - 0.08F}, 0.9F),
           pedestal * translation({0.0, 0.39, 0.0}));
    append(mesh, box("", {0.50F, 0.06F, kDepth - 0.04F}, 0.9F),
           pedestal * translation({0.0, 0.03, 0.0}));
    for (int drawer = 0; drawer < 3; ++drawer) {
      // A drawer's front: a raised field within a bevelled frame.
      const auto front = [](float u, float v) {
        const float rim = std::min(0.40F * std::min(u, 1.0F - u), 0.19F * std::min(v, 1.0F - v));
        const float bevel = std::clamp((rim - 0.015F) / 0.012F, 0.0F, 1.0F);
        return Vec3{0.40F * (u - 0.5F), 0.19F * (v - 0.5F), 0.014F * bevel};
      };
      const DMat4 at = pedestal * translation({0.0, 0.18 + 0.21 * drawer, kDepth / 2.0 - 0.03});
      append(mesh, tessellate("", front, {60, 30, Around::Open, {0.45F, 0.2F}}), at);
      append(mesh, knob, at * translation({0.0, 0.0, 0.012}) * rotation_x(Degrees{90.0}));
    }
  }
  append(mesh, box("", {0.84F, 0.10F, 0.02F}, 0.9F), translation({0.0, 0.67, 0.38}));
  append(mesh, box("", {0.84F, 0.5F, 0.02F}, 0.9F), translation({0.0, 0.45, -0.38}));
  return mesh;
}

Chair chair() {
  Chair result;
  Mesh& wood = result.wood;
  wood.name = "bentwood", result.seat.name = "cane";
  const auto bent = [&wood](std::span<const Vec2> flat, float z, float radius) {
    std::vector<Vec3> path;
    for (const Vec2& p : smooth(flat, 6))
      path.emplace_back(p.x, p.y, z - 0.12F * std::max(0.0F, p.y - 0.46F));
    append(wood, tube("", path, radius, 10));
  };
  // Back legs and back are one bow, with a smaller one inside it.
  constexpr std::array kBow{Vec2{-0.20F, 0.0F},  Vec2{-0.19F, 0.45F}, Vec2{-0.19F, 0.75F},
                            Vec2{-0.10F, 0.90F}, Vec2{0.10F, 0.90F},  Vec2{0.19F, 0.75F},
                            Vec2{0.19F, 0.45F},  Vec2{0.20F, 0.0F}};
  constexpr std::array kInner{Vec2{-0.11F, 0.47F}, Vec2{-0.11F, 0.68F}, Vec2{0.0F, 0.80F},
                              Vec2{0.11F, 0.68F}, Vec2{0.11F, 0.47F}};
  bent(kBow, -0.19F, 0.016F);
  bent(kInner, -0.19F, 0.011F);
  for (const double x : {-0.17, 0.17})
    append(wood, turned_leg(0.45F, 0.02F), translation({x, 0.0, 0.17}));
  append(wood, torus("", 0.21F, 0.018F, 72, 10), translation({0.0, 0.46, 0.0}));
  append(wood, torus("", 0.17F, 0.009F, 64, 8), translation({0.0, 0.22, 0.0}));
  // Cane: strands both ways, over and under.
  constexpr int kStrands = 17;
  for (int way = 0; way < 2; ++way) {
    for (int i = 0; i < kStrands; ++i) {
      const float across = 0.4F * ((static_cast<float>(i) + 0.5F) / kStrands - 0.5F);
      const float half = std::sqrt(std::max(0.0F, 0.21F * 0.21F - across * across));
      std::vector<Vec3> strand;
      for (int k = 0; k <= 34; ++k) {
        const float t = static_cast<float>(k) / 34.0F, along = half * (2.0F * t - 1.0F);
        const float weave =
            0.0035F * std::cos(kPi * (along / 0.4F * kStrands + static_cast<float>(i + way)));
        strand.emplace_back(way == 0 ? along : across, 0.466F + weave, way == 0 ? across : along);
      }
      append(result.seat, tube("", strand, 0.003F, 5));
    }
  }
  return result;
}

}  // namespace macula::scene::built_in
