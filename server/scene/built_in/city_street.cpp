#include "server/scene/built_in/city_street.h"

#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in::city {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A box with round edges: |x/a|^n + |y/b|^n + |z/c|^n = 1 in spherical parameters.
Mesh rounded_box(const Vec3& half, float squareness, int columns, int rows) {
  const auto bent = [squareness](float t) {
    return std::copysign(std::pow(std::abs(t), squareness), t);
  };
  const auto surface = [&](float u, float v) {
    const float azimuth = 2 * kPi * u, polar = kPi * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : bent(std::sin(polar));
    return half * Vec3{ring * bent(std::cos(azimuth)), -bent(std::cos(polar)),
                       -ring * bent(std::sin(azimuth))};
  };
  return tessellate("", surface, {columns, rows, Around::Closed, {1.0F, 1.0F}});
}

Mesh wheel() {
  Mesh mesh = torus("", 0.24F, 0.09F, 28, 10);
  constexpr std::array<Vec2, 5> kHub{Vec2{0.0F, -0.06F}, Vec2{0.2F, -0.05F}, Vec2{0.2F, 0.05F},
                                     Vec2{0.08F, 0.08F}, Vec2{0.0F, 0.06F}};
  append(mesh, lathe("", kHub, 20));
  return mesh;
}

}  // namespace

Car car(float length, float height) {
  Car result;
  const float half = length / 2;
  result.body = rounded_box({0.88F, 0.34F, half}, 0.32F, 48, 28);
  for (Vec3& position : result.body.positions) position.y += 0.62F;
  // The roof stands on the glass house, which narrows upwards.
  const float cabin = height - 0.95F;
  Mesh roof = rounded_box({0.66F, 0.06F, 0.26F * length}, 0.45F, 36, 12);
  append(result.body, roof, translation({0.0, 0.92 + cabin, 0.08 * length}));
  for (const double x : {-0.92, 0.92}) {
    append(result.body, rounded_box({0.10F, 0.07F, 0.06F}, 0.6F, 12, 8),
           translation({x, 0.98, -0.14 * length}));
  }
  result.glass = rounded_box({0.76F, cabin / 2 + 0.06F, 0.34F * length}, 0.5F, 40, 20);
  for (Vec3& position : result.glass.positions) {
    position.y += 0.87F + cabin / 2;
    position.z += 0.07F * length;
  }
  for (const double x : {-0.80, 0.80}) {
    for (const double z : {-0.31, 0.31}) {
      append(result.dark, wheel(),
             translation({x, 0.33, z * length}) * rotation_z(Degrees{x < 0.0 ? 90.0 : -90.0}));
    }
  }
  for (const double end : {-1.0, 1.0}) {
    append(result.dark, rounded_box({0.80F, 0.08F, 0.05F}, 0.4F, 20, 8),
           translation({0.0, 0.42, end * (half - 0.01)}));
  }
  return result;
}

StreetLamp street_lamp() {
  constexpr std::array<Vec2, 10> kPost{Vec2{0.20F, 0.0F}, Vec2{0.20F, 0.12F}, Vec2{0.12F, 0.25F},
                                       Vec2{0.14F, 0.6F}, Vec2{0.07F, 0.85F}, Vec2{0.055F, 2.2F},
                                       Vec2{0.05F, 3.6F}, Vec2{0.09F, 3.7F},  Vec2{0.05F, 3.8F},
                                       Vec2{0.11F, 4.12F}};
  StreetLamp lamp;
  lamp.post = lathe("lamp post", kPost, 16);
  const auto fluted = torus("", 0.12F, 0.02F, 20, 6);
  append(lamp.post, fluted, translation({0.0, 0.86, 0.0}));
  constexpr std::array<Vec2, 5> kHat{Vec2{0.24F, 4.60F}, Vec2{0.18F, 4.70F}, Vec2{0.08F, 4.76F},
                                     Vec2{0.03F, 4.88F}, Vec2{0.0F, 4.92F}};
  append(lamp.post, lathe("", smooth(kHat, 2), 20));
  lamp.globe = sphere("globe", 0.2F, 20, 12);
  for (Vec3& position : lamp.globe.positions) position.y += kLampHeight;
  return lamp;
}

Mesh park_bench() {
  Mesh mesh;
  mesh.name = "bench";
  for (int i = 0; i < 5; ++i)
    append(mesh, box("", {1.7F, 0.03F, 0.07F}), translation({0.0, 0.45, -0.2 + 0.09 * i}));
  for (int i = 0; i < 4; ++i)
    append(mesh, box("", {1.7F, 0.08F, 0.03F}),
           translation({0.0, 0.55 + 0.11 * i, -0.27 - 0.03 * i}));
  for (const float x : {-0.75F, 0.75F}) {
    const std::array foot{Vec3{x, 0.0F, -0.30F}, Vec3{x, 0.25F, -0.18F}, Vec3{x, 0.43F, -0.22F},
                          Vec3{x, 0.70F, -0.31F}, Vec3{x, 0.95F, -0.39F}};
    const std::array front{Vec3{x, 0.0F, 0.22F}, Vec3{x, 0.2F, 0.12F}, Vec3{x, 0.43F, 0.16F}};
    append(mesh, tube("", foot, 0.025F, 8));
    append(mesh, tube("", front, 0.025F, 8));
  }
  return mesh;
}

Mesh bollard() {
  constexpr std::array<Vec2, 8> kProfile{Vec2{0.10F, 0.0F},  Vec2{0.10F, 0.08F}, Vec2{0.07F, 0.14F},
                                         Vec2{0.06F, 0.6F},  Vec2{0.08F, 0.66F}, Vec2{0.06F, 0.72F},
                                         Vec2{0.07F, 0.80F}, Vec2{0.0F, 0.88F}};
  return lathe("bollard", smooth(kProfile, 2), 14);
}

Mesh traffic_light() {
  const std::array pole{Vec3{0, 0, 0}, Vec3{0, 1.5F, 0}, Vec3{0, 3.4F, 0}};
  Mesh mesh = tube("traffic light", pole, 0.05F, 10);
  append(mesh, box("", {0.30F, 0.90F, 0.22F}), translation({0.0, 3.0, 0.12}));
  const auto hood = [](float u, float v) {
    const float angle = kPi * (1.15F - 1.3F * u);
    return Vec3{0.11F * std::cos(angle), 0.11F * std::sin(angle), 0.16F * v};
  };
  for (int i = 0; i < 3; ++i)
    append(mesh, tessellate("", hood, {14, 2, Around::Open}),
           translation({0.0, 2.72 + 0.28 * i, 0.23}));
  return mesh;
}

}  // namespace macula::scene::built_in::city
