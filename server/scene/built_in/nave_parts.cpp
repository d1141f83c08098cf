#include "server/scene/built_in/nave_parts.h"

#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in::nave_parts {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Half a circle from (radius, 0) to (-radius, 0) over the top.
Vec2 half_circle(float radius, float t) {
  return radius * Vec2{std::cos(kPi * t), std::sin(kPi * t)};
}

/// The outline of a round-headed window from its right foot to its left one, t in [0, 1].
Vec2 arch_outline(float half_width, float straight, float t) {
  if (t < 0.25F) return {half_width, straight * 4.0F * t};
  if (t > 0.75F) return {-half_width, straight * 4.0F * (1.0F - t)};
  return Vec2{0.0F, straight} + half_circle(half_width, 2.0F * (t - 0.25F));
}

std::vector<Vec3> arch_path(float half_width, float straight, float depth) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 64; ++i)
    path.emplace_back(arch_outline(half_width, straight, static_cast<float>(i) / 64.0F), depth);
  return path;
}

std::vector<Vec3> circle_path(const Vec3& centre, float radius, int steps) {
  std::vector<Vec3> path;
  for (int i = 0; i <= steps; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / static_cast<float>(steps);
    path.push_back(centre + radius * Vec3{std::cos(a), std::sin(a), 0.0F});
  }
  return path;
}

constexpr float kWindowHalfWidth = 1.25F, kWindowSill = 0.5F, kWindowStraight = 1.5F;

}  // namespace

Mesh clustered_pier(float radius, float height) {
  const auto surface = [=](float u, float v) {
    // Eight shafts around a core, and rings where the drums of stone meet.
    const float shafts = std::pow(std::abs(std::cos(8.0F * kPi * u)), 0.7F);
    const float joint =
        0.985F + 0.015F * std::min(1.0F, 20.0F * std::abs(std::sin(5.0F * kPi * v)));
    const float r = radius * (0.80F + 0.20F * shafts) * joint;
    return Vec3{r * std::cos(2 * kPi * u), height * v, -r * std::sin(2 * kPi * u)};
  };
  return tessellate("pier", surface, {96, 40, Around::Closed, {2.0F, height / 2.0F}});
}

Mesh wall_shaft(float bottom, float top) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 8; ++i)
    path.emplace_back(0.0F, glm::mix(bottom, top, static_cast<float>(i) / 8.0F), 0.0F);
  Mesh mesh = tube("wall shaft", path, 0.13F, 16);
  for (const float y : {bottom + 0.1F, kArcadeTop, kClerestory, top - 0.1F})
    append(mesh, torus("", 0.14F, 0.05F, 24, 8), translation({0.0, double{y}, 0.0}));
  return mesh;
}

Mesh window_wall() {
  constexpr float kHeight = kVaultSpringing - kClerestory, kHalf = kBay / 2.0F, kDepth = 0.35F;
  const auto edge = [](const Vec2& inner) {
    // Away from the middle of the opening to the rectangle of the bay.
    const Vec2 middle{0.0F, kWindowSill + kWindowStraight};
    const Vec2 away = inner - middle;
    const float sideways = kHalf / std::max(std::abs(away.x), 1e-5F);  // no unit: a ratio
    // Beyond the bay's top and bottom, behind its courses, so that no corner is cut off.
    constexpr float kHidden = 0.4F;
    const float reach = kHidden + (away.y > 0.0F ? kHeight - middle.y : middle.y);
    const float upwards = reach / std::max(std::abs(away.y), 1e-5F);
    return middle + std::min(sideways, upwards) * away;
  };
  // All around the opening, the sill included.
  const auto opening = [](float u) {
    if (u < 0.2F) return Vec2{kWindowHalfWidth * (10.0F * u - 1.0F), kWindowSill};
    return Vec2{0.0F, kWindowSill} +
           arch_outline(kWindowHalfWidth, kWindowStraight, (u - 0.2F) / 0.8F);
  };
  const auto face = [&](float u, float v) {
    const Vec2 inner = opening(u);
    return Vec3{glm::mix(edge(inner), inner, v), kDepth};
  };
  Mesh mesh = tessellate("clerestory", face, {80, 2, Around::Open, {1.0F, 1.0F}});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.texcoords[i] = Vec2{mesh.positions[i].x, -mesh.positions[i].y} / 2.0F;
  const Mesh front = mesh;
  append(mesh, front, rotation_y(Degrees{180.0}));
  // The splay between both faces.
  append(mesh, tessellate("",
                          [&](float u, float v) {
                            return Vec3{opening(u), glm::mix(kDepth, -kDepth, v)};
                          },
                          {80, 2, Around::Open, {4.0F, 0.35F}}));
  return mesh;
}

Mesh tracery() {
  Mesh mesh;
  mesh.name = "tracery";
  const auto at = [](float x, float y) { return Vec3{x, kWindowSill + y, 0.0F}; };
  for (const float x : {-kWindowHalfWidth / 3.0F, kWindowHalfWidth / 3.0F}) {
    const std::array path{at(x, 0.0F), at(x, 0.9F), at(x, kWindowStraight + 0.2F)};
    append(mesh, tube("", path, 0.045F, 10));
  }
  for (const float y : {0.55F, 1.1F}) {
    const std::array path{at(-kWindowHalfWidth, y), at(0.0F, y), at(kWindowHalfWidth, y)};
    append(mesh, tube("", path, 0.02F, 8));
  }
  append(mesh, tube("", circle_path(at(0.0F, kWindowStraight + 0.55F), 0.42F, 40), 0.045F, 10));
  for (const float x : {-0.72F, 0.72F})
    append(mesh, tube("", circle_path(at(x, kWindowStraight + 0.1F), 0.3F, 32), 0.04F, 10));
  return mesh;
}

Mesh barrel_bay() {
  const auto surface = [](float u, float v) {
    const float along = std::abs(std::sin(3.0F * kPi * v)),
                around = std::abs(std::sin(9.0F * kPi * u));
    const float coffer = 0.12F * std::min(1.0F, 3.0F * std::min(along, around));
    const Vec2 at = half_circle(kHalfWidth + coffer, u);
    return Vec3{at.x, kVaultSpringing + at.y, kBay * (0.5F - v)};
  };
  return tessellate("barrel vault", surface, {180, 60, Around::Open, {7.0F, 2.5F}});
}

Mesh transverse_rib() {
  Mesh mesh;
  mesh.name = "rib";
  for (const auto& [offset, z, radius] :
       {std::array{0.20F, 0.0F, 0.17F}, std::array{0.05F, 0.22F, 0.10F},
        std::array{0.05F, -0.22F, 0.10F}}) {
    std::vector<Vec3> path;
    for (int i = 0; i <= 72; ++i) {
      const Vec2 at = half_circle(kHalfWidth - offset, static_cast<float>(i) / 72.0F);
      path.emplace_back(at.x, kVaultSpringing + at.y, z);
    }
    append(mesh, tube("", path, radius, 12, {1.0F, 8.0F}));
  }
  return mesh;
}

Mesh arched_pane(float half_width, float straight) {
  constexpr int kCorners = 41;
  Mesh mesh;
  mesh.name = "pane";
  mesh.positions.emplace_back(0.0F, straight, 0.0F);
  for (int i = 0; i < kCorners; ++i) {
    const float t = static_cast<float>(i) / (kCorners - 1);
    mesh.positions.emplace_back(arch_outline(half_width, straight, t), 0.0F);
  }
  for (Index i = 1; i <= kCorners; ++i) mesh.triangles.emplace_back(0, i, i % kCorners + 1);
  mesh.normals.assign(mesh.positions.size(), Vec3{0.0F, 0.0F, 1.0F});
  const float height = straight + half_width;
  for (const Vec3& p : mesh.positions)
    mesh.texcoords.emplace_back(0.5F + p.x / height, 1.0F - p.y / height);
  return mesh;
}

Mesh arched_surround(float half_width, float straight) {
  Mesh mesh = tube("surround", arch_path(half_width + 0.05F, straight, 0.02F), 0.10F, 12);
  append(mesh, tube("", arch_path(half_width - 0.08F, straight, 0.03F), 0.03F, 8));
  for (int i = 1; i <= static_cast<int>(straight / 0.55F); ++i) {
    const float y = 0.55F * static_cast<float>(i);
    const std::array bar{Vec3{-half_width, y, 0.03F}, Vec3{0.0F, y, 0.03F},
                         Vec3{half_width, y, 0.03F}};
    append(mesh, tube("", bar, 0.015F, 6));
  }
  append(mesh, box("", {2.0F * half_width + 0.5F, 0.12F, 0.3F}), translation({0.0, -0.06, 0.0}));
  return mesh;
}

Mesh rose_window(float radius) {
  const auto surface = [radius](float u, float v) {
    const float r = radius * (1.0F - v);
    return Vec3{r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), 0.0F};
  };
  Mesh mesh = tessellate("rose", surface, {64, 6, Around::Closed});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.texcoords[i] = 0.5F + 0.5F * Vec2{mesh.positions[i].x, -mesh.positions[i].y} / radius;
  return mesh;
}

Mesh rose_tracery(float radius) {
  Mesh mesh = tube("rose tracery", circle_path(Vec3{0.0F}, radius + 0.05F, 96), 0.16F, 12);
  append(mesh, tube("", circle_path(Vec3{0.0F}, 0.35F * radius, 64), 0.07F, 10));
  constexpr int kPetals = 12;
  for (int i = 0; i < kPetals; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / kPetals;
    const Vec3 out{std::cos(a), std::sin(a), 0.0F};
    const std::array spoke{0.35F * radius * out, 0.7F * radius * out, radius * out};
    append(mesh, tube("", spoke, 0.05F, 8));
    const float half = a + kPi / kPetals;
    const Vec3 petal = 0.80F * radius * Vec3{std::cos(half), std::sin(half), 0.0F};
    append(mesh, tube("", circle_path(petal, 0.17F * radius, 28), 0.045F, 8));
  }
  return mesh;
}

Mesh panelled_door() {
  Mesh mesh = box("door", {3.0F, 4.4F, 0.12F}, 1.5F);
  for (Vec3& position : mesh.positions) position.y += 2.2F;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 4; ++column) {
      // A raised panel: a pyramid's frustum, soft at its edges.
      const auto surface = [](float u, float v) {
        const float rim = std::min(std::min(u, 1.0F - u), std::min(v, 1.0F - v));
        return Vec3{0.60F * (u - 0.5F), 0.72F * (v - 0.5F), 0.06F * std::min(1.0F, 6.0F * rim)};
      };
      append(mesh, tessellate("", surface, {12, 12, Around::Open, {0.4F, 0.5F}}),
             translation({-1.08 + 0.72 * column, 0.52 + 0.84 * row, 0.06}));
    }
  }
  return mesh;
}

Mesh apse_wall() {
  const auto surface = [](float u, float v) {
    const Vec2 at = half_circle(kHalfWidth, u);
    return Vec3{at.x, kVaultSpringing * v, -at.y};
  };
  return inside_out(tessellate("apse", surface, {96, 30, Around::Open, {7.0F, -7.5F}}));
}

Mesh half_dome() {
  const auto surface = [](float u, float v) {
    const float ring = v >= 1.0F ? 0.0F : std::cos(0.5F * kPi * v);
    const float coffer = 0.08F * std::min(1.0F, 3.0F * std::abs(std::sin(12.0F * kPi * u))) *
                         std::min(1.0F, 3.0F * std::abs(std::sin(6.0F * kPi * v)));
    const Vec2 at = half_circle((kHalfWidth + coffer) * ring, u);
    return Vec3{at.x, kVaultSpringing + (kHalfWidth + coffer) * std::sin(0.5F * kPi * v), -at.y};
  };
  return inside_out(tessellate("half dome", surface, {144, 72, Around::Open, {7.0F, 3.5F}}));
}

Mesh apse_floor() {
  const auto surface = [](float u, float v) {
    const Vec2 at = half_circle(kHalfWidth * (1.0F - v), u);
    return Vec3{at.x, 0.0F, -at.y};
  };
  Mesh mesh = tessellate("apse floor", surface, {48, 1, Around::Open});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.texcoords[i] = Vec2{mesh.positions[i].x, mesh.positions[i].z} / 3.2F;
  return mesh;
}

Mesh altar_cloth() {
  const auto surface = [](float u, float v) {
    const float x = 2.6F * (u - 0.5F), z = 2.2F * (0.5F - v);
    const float over = std::max(0.0F, std::abs(z) - 0.5F);
    const float fold = 0.03F * std::sin(22.0F * x) * std::min(1.0F, 4.0F * over);
    // Falls straight from the edge of the table, a little outwards so that it stays a surface.
    const float across = std::abs(z) > 0.5F ? std::copysign(0.52F + 0.1F * over + fold, z) : z;
    return Vec3{x, -over, across};
  };
  return tessellate("altar cloth", surface, {96, 60, Around::Open, {3.0F, 2.0F}});
}

Mesh crucifix() {
  constexpr std::array<Vec2, 8> kFoot{Vec2{0.0F, 0.0F},   Vec2{0.22F, 0.0F},  Vec2{0.23F, 0.04F},
                                      Vec2{0.14F, 0.09F}, Vec2{0.06F, 0.16F}, Vec2{0.07F, 0.22F},
                                      Vec2{0.03F, 0.28F}, Vec2{0.0F, 0.34F}};
  Mesh mesh = lathe("crucifix", smooth(kFoot, 3), 32);
  const std::array post{Vec3{0, 0.3F, 0}, Vec3{0, 0.8F, 0}, Vec3{0, 1.5F, 0}};
  const std::array arm{Vec3{-0.4F, 1.15F, 0}, Vec3{0, 1.15F, 0}, Vec3{0.4F, 1.15F, 0}};
  append(mesh, tube("", post, 0.035F, 16));
  append(mesh, tube("", arm, 0.035F, 16));
  const Mesh knob = sphere("", 0.06F, 16, 10);
  for (const DVec3& at : {DVec3{-0.4, 1.15, 0}, DVec3{0.4, 1.15, 0}, DVec3{0, 1.5, 0}})
    append(mesh, knob, translation(at));
  append(mesh, torus("", 0.16F, 0.018F, 40, 8),
         translation({0.0, 1.15, 0.0}) * rotation_x(Degrees{90.0}));
  return mesh;
}

Mesh candlestick() {
  constexpr std::array<Vec2, 9> kProfile{
      Vec2{0.0F, 0.0F},    Vec2{0.11F, 0.0F},  Vec2{0.10F, 0.03F},
      Vec2{0.03F, 0.07F},  Vec2{0.04F, 0.16F}, Vec2{0.02F, 0.24F},
      Vec2{0.035F, 0.34F}, Vec2{0.06F, 0.40F}, Vec2{0.0F, 0.42F}};
  return lathe("candlestick", smooth(kProfile, 3), 24);
}

Mesh candle() {
  const std::array<Vec2, 6> profile{
      Vec2{0.022F, 0.0F},          Vec2{0.021F, 0.10F},
      Vec2{0.020F, 0.20F},         Vec2{0.021F, kCandleHeight - 0.01F},
      Vec2{0.015F, kCandleHeight}, Vec2{0.0F, kCandleHeight - 0.01F}};
  return lathe("candle", profile, 16);
}

Mesh candle_flame() {
  constexpr std::array<Vec2, 6> kProfile{Vec2{0.0F, 0.0F},    Vec2{0.009F, 0.008F},
                                         Vec2{0.012F, 0.02F}, Vec2{0.008F, 0.04F},
                                         Vec2{0.003F, 0.06F}, Vec2{0.0F, 0.07F}};
  return lathe("flame", kProfile, 8);
}

Mesh chandelier() {
  Mesh mesh = torus("chandelier", kChandelierRadius, 0.035F, 96, 10);
  append(mesh, torus("", 0.45F, 0.025F, 64, 8), translation({0.0, 0.3, 0.0}));
  constexpr std::array<Vec2, 5> kCup{Vec2{0.0F, 0.0F}, Vec2{0.02F, 0.01F}, Vec2{0.05F, 0.05F},
                                     Vec2{0.055F, 0.07F}, Vec2{0.0F, 0.06F}};
  const Mesh cup = lathe("", kCup, 14);
  for (int k = 0; k < kChandelierCandles; ++k) {
    append(mesh, cup,
           rotation_y(Degrees{360.0 * k / kChandelierCandles}) *
               translation({double{kChandelierRadius}, 0.02, 0.0}));
  }
  for (int k = 0; k < 4; ++k) {
    const float a = 0.5F * kPi * (static_cast<float>(k) + 0.5F);
    const Vec3 out{std::cos(a), 0.0F, std::sin(a)};
    const std::array rod{kChandelierRadius * out, 0.45F * out + Vec3{0.0F, 0.3F, 0.0F},
                         Vec3{0.0F, 0.55F, 0.0F}};
    append(mesh, tube("", rod, 0.014F, 8));
  }
  return mesh;
}

Mesh pew() {
  constexpr float kLength = 2.7F;
  // Seat and back are boards hollowed for people.
  const auto seat = [](float u, float v) {
    const float hollow = 0.02F * std::sin(kPi * v) * std::abs(std::sin(4.0F * kPi * u));
    return Vec3{kLength * (u - 0.5F), 0.46F - hollow, 0.42F * (0.5F - v)};
  };
  Mesh mesh = tessellate("pew", seat, {32, 8, Around::Open, {1.4F, 0.2F}});
  append(mesh, box("", {kLength, 0.04F, 0.42F}, 1.2F), translation({0.0, 0.43, 0.0}));
  append(mesh, box("", {kLength, 0.50F, 0.03F}, 1.2F),
         translation({0.0, 0.74, 0.24}) * rotation_x(Degrees{10.0}));
  append(mesh, box("", {kLength, 0.05F, 0.14F}, 1.2F), translation({0.0, 1.0, 0.30}));
  // Ends with a scroll on top.
  for (const double x : {-kLength / 2.0 - 0.03, kLength / 2.0 + 0.03}) {
    append(mesh, box("", {0.06F, 0.98F, 0.55F}, 1.2F), translation({x, 0.49, 0.05}));
    append(mesh, torus("", 0.07F, 0.035F, 24, 10),
           translation({x, 1.0, 0.24}) * rotation_z(Degrees{90.0}));
  }
  return mesh;
}

}  // namespace macula::scene::built_in::nave_parts
