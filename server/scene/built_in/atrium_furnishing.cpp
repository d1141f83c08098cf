#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"
#include "shared/math/hash.h"

namespace macula::scene::built_in::atrium_parts {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// The n-th random number of a seed, in [0, 1).
float random(std::uint64_t seed, std::uint64_t n) {
  return math::unit_float(math::hash_combine(seed, n));
}

}  // namespace

Mesh vase() {
  constexpr std::array<Vec2, 11> kProfile{
      Vec2{0.0F, 0.0F},   Vec2{0.17F, 0.0F},  Vec2{0.19F, 0.04F}, Vec2{0.12F, 0.12F},
      Vec2{0.20F, 0.28F}, Vec2{0.31F, 0.50F}, Vec2{0.28F, 0.72F}, Vec2{0.15F, 0.86F},
      Vec2{0.14F, 0.95F}, Vec2{0.22F, 1.02F}, Vec2{0.20F, 1.04F}};
  return lathe("vase", smooth(kProfile, 4), 44, {2.0F, 1.0F});
}

Mesh pot() {
  constexpr std::array<Vec2, 9> kProfile{Vec2{0.0F, 0.0F},   Vec2{0.26F, 0.0F},  Vec2{0.30F, 0.05F},
                                         Vec2{0.36F, 0.30F}, Vec2{0.41F, 0.52F}, Vec2{0.45F, 0.56F},
                                         Vec2{0.43F, 0.62F}, Vec2{0.38F, 0.58F}, Vec2{0.0F, 0.52F}};
  return lathe("pot", smooth(kProfile, 3), 40, {2.0F, 1.0F});
}

Mesh shrub(int sprigs, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "shrub";
  for (int i = 0; i < sprigs; ++i) {
    const auto n = static_cast<std::uint64_t>(i) * 4;
    const float length = 0.7F + 0.6F * random(seed, n), bend = 0.3F + 1.1F * random(seed, n + 1);
    const float curl = 0.25F * (random(seed, n + 2) - 0.5F);
    const auto surface = [=](float u, float v) {
      const float tilt = bend * v, across = 0.46F * length * (u - 0.5F);
      const float keel = 0.35F * across * across / length;
      return Vec3{across + curl * v * v, length * v * std::cos(0.6F * tilt) + keel,
                  length * v * std::sin(0.6F * tilt) + 0.04F};
    };
    const double azimuth = 360.0 * (i + 0.7 * random(seed, n + 3)) / sprigs;
    append(mesh, tessellate("", surface, {3, 5, Around::Open, {1.0F, 1.0F}}),
           translation({0.0, 0.5, 0.0}) * rotation_y(Degrees{azimuth * 5.0}));
  }
  return mesh;
}

Mesh curtain(float width, float length, std::uint64_t seed) {
  const float phase = 2 * kPi * random(seed, 0), sway = 0.25F * (random(seed, 1) - 0.5F);
  const float folds = 6.0F + std::floor(3.0F * random(seed, 2));
  const auto surface = [=](float u, float v) {
    const float down = 1.0F - v;
    // Gathered at the rail, freer and softer towards the hem.
    const float depth = 0.05F + 0.09F * down;
    const float wave =
        std::sin(2 * kPi * folds * u + phase + 1.5F * down * std::sin(3.0F * u + phase));
    const float second = 0.35F * std::sin(2 * kPi * 2.3F * u + 4.0F * down + 2.0F * phase);
    const float narrowing = 1.0F - 0.12F * std::sin(kPi * down);
    return Vec3{
        width * (u - 0.5F) * narrowing + 0.03F * down * std::cos(2 * kPi * folds * u + phase),
        -length * down + 0.03F * down * wave, depth * (wave + second) + sway * down * down};
  };
  return tessellate("curtain", surface, {88, 44, Around::Open, {1.0F, -length / width}});
}

Mesh chain(float length) {
  constexpr float kPitch = 0.075F;
  // A link is a torus drawn out along its height.
  const auto surface = [](float u, float v) {
    const float azimuth = 2 * kPi * u, around = 2 * kPi * v,
                ring = 0.026F + 0.008F * std::cos(around);
    const float drawn = 0.016F * std::tanh(3.0F * std::sin(azimuth));
    return Vec3{ring * std::cos(azimuth), ring * std::sin(azimuth) + drawn,
                0.008F * std::sin(around)};
  };
  const Mesh link = inside_out(tessellate("", surface, {14, 8, Around::Closed, {1.0F, 1.0F}}));
  Mesh mesh;
  mesh.name = "chain";
  const int links = static_cast<int>(length / kPitch);
  for (int i = 0; i < links; ++i) {
    append(mesh, link,
           translation({0.0, -kPitch * (i + 0.5), 0.0}) * rotation_y(Degrees{90.0 * (i % 2)}));
  }
  return mesh;
}

Mesh lantern_cage() {
  constexpr std::array<Vec2, 6> kRoof{Vec2{0.21F, -0.24F},  Vec2{0.20F, -0.20F},
                                      Vec2{0.10F, -0.12F},  Vec2{0.05F, -0.08F},
                                      Vec2{0.035F, -0.02F}, Vec2{0.0F, 0.0F}};
  Mesh mesh = lathe("lantern", smooth(kRoof, 3), 24);
  append(mesh, torus("", 0.17F, 0.015F, 32, 8), translation({0.0, -0.58, 0.0}));
  for (int i = 0; i < 6; ++i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + 0.5F) / 6.0F;
    std::vector<Vec3> bar;
    for (int k = 0; k <= 8; ++k) {
      const float t = static_cast<float>(k) / 8.0F, r = 0.17F + 0.035F * std::sin(kPi * t);
      bar.emplace_back(r * std::cos(angle), -0.58F + 0.36F * t, r * std::sin(angle));
    }
    append(mesh, tube("", bar, 0.008F, 6));
  }
  return mesh;
}

Mesh lantern_panes() {
  Mesh mesh;
  mesh.name = "lantern panes";
  for (int i = 0; i < 6; ++i) {
    // Facing outwards; counter-clockwise seen from there.
    const Mesh pane =
        parallelogram("", {-0.06F, -0.54F, 0.11F}, {0.12F, 0.0F, 0.0F}, {0.0F, 0.26F, 0.0F});
    append(mesh, pane, rotation_y(Degrees{60.0 * i}));
  }
  return mesh;
}

Mesh cable(const Vec3& from, const Vec3& to, float sag) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 48; ++i) {
    const float t = static_cast<float>(i) / 48.0F;
    path.push_back(glm::mix(from, to, t) - Vec3{0.0F, 4.0F * sag * t * (1.0F - t), 0.0F});
  }
  return tube("cable", path, 0.012F, 8);
}

Mesh pennant(std::uint64_t seed) {
  const float phase = 2 * kPi * random(seed, 0);
  const auto surface = [phase](float u, float v) {
    const float down = 1.0F - v, half = 0.28F * (1.0F - 0.9F * down);
    return Vec3{2.0F * half * (u - 0.5F), -0.6F * down,
                0.06F * down * std::sin(5.0F * u + 3.0F * down + phase)};
  };
  return tessellate("pennant", surface, {10, 12, Around::Open, {0.5F, -0.5F}});
}

Mesh fountain_basin() {
  constexpr std::array<Vec2, 10> kRim{Vec2{1.35F, 0.0F},  Vec2{1.38F, 0.08F}, Vec2{1.28F, 0.14F},
                                      Vec2{1.26F, 0.34F}, Vec2{1.34F, 0.42F}, Vec2{1.40F, 0.47F},
                                      Vec2{1.36F, 0.52F}, Vec2{1.18F, 0.52F}, Vec2{1.14F, 0.46F},
                                      Vec2{1.12F, 0.20F}};
  constexpr std::array<Vec2, 12> kStem{Vec2{0.30F, 0.2F},  Vec2{0.26F, 0.35F}, Vec2{0.12F, 0.50F},
                                       Vec2{0.10F, 0.75F}, Vec2{0.16F, 0.85F}, Vec2{0.14F, 0.92F},
                                       Vec2{0.45F, 1.04F}, Vec2{0.62F, 1.16F}, Vec2{0.63F, 1.20F},
                                       Vec2{0.58F, 1.18F}, Vec2{0.40F, 1.08F}, Vec2{0.0F, 1.04F}};
  Mesh mesh = lathe("fountain", smooth(kRim, 3), 72, {6.0F, 1.0F});
  append(mesh, lathe("", smooth(kStem, 3), 48, {2.0F, 1.0F}));
  return mesh;
}

Mesh fountain_water() {
  const auto surface = [](float u, float v) {
    const float r = 1.15F * (1.0F - v), ripple = 0.012F * std::sin(26.0F * r) * std::exp(-1.2F * r);
    return Vec3{r * std::cos(2 * kPi * u), 0.40F + ripple, -r * std::sin(2 * kPi * u)};
  };
  return tessellate("water", surface, {48, 36, Around::Closed, {1.0F, 1.0F}});
}

Mesh sculpture() {
  std::vector<Vec3> path;
  constexpr int kPoints = 240;
  for (int i = 0; i <= kPoints; ++i) {
    const float t = 2 * kPi * static_cast<float>(i) / kPoints,
                r = 0.30F + 0.12F * std::cos(3.0F * t);
    path.emplace_back(r * std::cos(2.0F * t), 0.42F + 0.26F * std::sin(3.0F * t),
                      r * std::sin(2.0F * t));
  }
  return tube("sculpture", path, 0.045F, 18, {1.0F, 12.0F});
}

Mesh rug(float width, float length, std::uint64_t seed) {
  const float phase = 2 * kPi * random(seed, 0);
  const auto surface = [=](float u, float v) {
    // Ripples of a few millimeters, and edges that curl up.
    const float edge = std::pow(std::abs(2.0F * v - 1.0F), 12.0F);
    const float ripple =
        0.006F * std::sin(9.0F * v + 3.0F * u + phase) * std::sin(5.0F * u + phase);
    return Vec3{length * (u - 0.5F), 0.018F + ripple + 0.03F * edge, width * (0.5F - v)};
  };
  return tessellate("rug", surface, {64, 24, Around::Open, {1.0F, 1.0F}});
}

Mesh bench() {
  const auto seat = [](float u, float v) {
    const float hollow = 0.015F * std::sin(kPi * u) * std::sin(kPi * v);
    return Vec3{1.6F * (u - 0.5F), 0.45F - hollow, 0.42F * (0.5F - v)};
  };
  Mesh mesh = tessellate("bench", seat, {16, 6, Around::Open, {0.8F, 0.21F}});
  append(mesh, box("", {1.6F, 0.05F, 0.42F}, 1.0F), translation({0.0, 0.41, 0.0}));
  constexpr std::array<Vec2, 6> kLeg{Vec2{0.03F, 0.0F},  Vec2{0.045F, 0.05F}, Vec2{0.025F, 0.12F},
                                     Vec2{0.04F, 0.25F}, Vec2{0.05F, 0.33F},  Vec2{0.035F, 0.40F}};
  const Mesh leg = lathe("", smooth(kLeg, 3), 16);
  for (const double x : {-0.7, 0.7}) {
    for (const double z : {-0.15, 0.15}) append(mesh, leg, translation({x, 0.0, z}));
  }
  return mesh;
}

}  // namespace macula::scene::built_in::atrium_parts
