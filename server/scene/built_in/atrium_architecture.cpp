#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/atrium_parts.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in::atrium_parts {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kHalfBay = kBay / 2.0F;

/// Angle of an arch from its left springing (pi) to its right one (0), with u = 1/4 and 3/4 at the
/// corners of the wall above it, so that these are vertices.
float arch_angle(const Storey& storey, float u) {
  const float corner = std::atan2(storey.height - storey.springing, kHalfBay);
  if (u < 0.25F) return kPi - 4.0F * u * corner;
  if (u > 0.75F) return 4.0F * (1.0F - u) * corner;
  return kPi - corner - 2.0F * (u - 0.25F) * (kPi - 2.0F * corner);
}

/// Where a ray at this angle from the springing line's middle leaves the bay's wall.
Vec2 wall_edge(const Storey& storey, float angle) {
  const Vec2 direction{std::cos(angle), std::sin(angle)};
  const float rise = storey.height - storey.springing;
  const float sideways = kHalfBay / std::max(std::abs(direction.x), 1e-6F);  // no unit: a cosine
  const float upwards = rise / std::max(direction.y, 1e-6F);
  return std::min(sideways, upwards) * direction;
}

}  // namespace

Mesh fluted_shaft(float bottom, float top) {
  constexpr int kFlutes = 20;
  const auto surface = [=](float u, float v) {
    // Entasis (a slight belly), then 20 half-round flutes with sharp arrises between them.
    const float radius = 0.26F - 0.035F * v * v;
    const float flute = std::abs(std::sin(kPi * kFlutes * u));
    const float fade = std::min(1.0F, 12.0F * std::min(v, 1.0F - v));
    const float r = radius * (1.0F - 0.075F * fade * flute);
    return Vec3{r * std::cos(2 * kPi * u), bottom + (top - bottom) * v, -r * std::sin(2 * kPi * u)};
  };
  return tessellate("fluted shaft", surface, {kFlutes * 8, 14, Around::Closed, {1.0F, 2.0F}});
}

Mesh twisted_shaft(float bottom, float top) {
  const auto surface = [=](float u, float v) {
    const float height = bottom + (top - bottom) * v;
    const float strands = std::cos(2 * kPi * (3.0F * u + 2.5F * v));
    const float r = 0.135F + 0.028F * strands;
    return Vec3{r * std::cos(2 * kPi * u), height, -r * std::sin(2 * kPi * u)};
  };
  return tessellate("twisted shaft", surface, {42, 40, Around::Closed, {1.0F, 2.0F}});
}

Mesh column_base() {
  constexpr std::array<Vec2, 12> kProfile{
      Vec2{0.36F, 0.12F},   Vec2{0.385F, 0.15F}, Vec2{0.39F, 0.185F}, Vec2{0.37F, 0.22F},
      Vec2{0.325F, 0.235F}, Vec2{0.31F, 0.26F},  Vec2{0.32F, 0.285F}, Vec2{0.335F, 0.30F},
      Vec2{0.335F, 0.33F},  Vec2{0.315F, 0.35F}, Vec2{0.27F, 0.36F},  Vec2{0.255F, 0.40F}};
  Mesh mesh = lathe("column base", smooth(kProfile, 2), 40, {2.0F, 0.5F});
  append(mesh, box("", {0.8F, 0.14F, 0.8F}, kTextureSize), translation({0.0, 0.07, 0.0}));
  return mesh;
}

Mesh capital() {
  // A bell whose rim is drawn out to four corners, with leaves in two tiers as waves on it.
  const auto surface = [](float u, float v) {
    const float flare = 0.225F + 0.12F * v * v * v + 0.02F * std::sin(kPi * v);
    const float corners = 1.0F + 0.12F * v * v * std::cos(8 * kPi * u);
    const float tier = v < 0.5F ? 2.0F * v : 2.0F * v - 1.0F;
    const float leaves = 0.028F * std::sin(kPi * tier) *
                         std::abs(std::cos(kPi * (8.0F * u + (v < 0.5F ? 0.0F : 0.5F))));
    const float r = flare * corners + leaves;
    return Vec3{r * std::cos(2 * kPi * u), 0.37F * v, -r * std::sin(2 * kPi * u)};
  };
  Mesh mesh = tessellate("capital", surface, {64, 20, Around::Closed, {2.0F, 0.5F}});
  append(mesh, box("", {0.64F, 0.08F, 0.64F}, kTextureSize),
         translation({0.0, kCapitalHeight - 0.04, 0.0}));
  return mesh;
}

Mesh spandrel(const Storey& storey) {
  const auto surface = [&storey](float u, float v) {
    const float angle = arch_angle(storey, u);
    const Vec2 inner = kArchRadius * Vec2{std::cos(angle), std::sin(angle)};
    const Vec2 at = glm::mix(inner, wall_edge(storey, angle), v);
    return Vec3{at.x, storey.springing + at.y, kWallThickness / 2.0F};
  };
  Mesh front = tessellate("spandrel", surface, {16, 2, Around::Open, {1.0F, 1.0F}});
  for (std::size_t i = 0; i < front.positions.size(); ++i) {
    front.texcoords[i] = Vec2{front.positions[i].x, -front.positions[i].y} / kTextureSize;
  }
  Mesh both = front;
  append(both, front, rotation_y(Degrees{180.0}));
  return both;
}

Mesh intrados(const Storey& storey) {
  const auto surface = [&storey](float u, float v) {
    // Shallow coffers: the band between two ribs lies a little deeper.
    const float angle = kPi * (1.0F - u);
    const float coffer = 0.035F * std::abs(std::sin(12.0F * angle)) * std::sin(kPi * v);
    const float r = kArchRadius + coffer;
    return Vec3{r * std::cos(angle), storey.springing + r * std::sin(angle),
                kWallThickness * (v - 0.5F)};
  };
  return tessellate("intrados", surface, {48, 6, Around::Open, {2.0F, 0.25F}});
}

Mesh archivolt(const Storey& storey) {
  Mesh mesh;
  for (const auto& [offset, radius] : {std::pair{0.06F, 0.045F}, std::pair{0.17F, 0.03F}}) {
    std::vector<Vec3> path;
    for (int i = 0; i <= 28; ++i) {
      const float angle = kPi * static_cast<float>(i) / 28.0F, r = kArchRadius + offset;
      path.emplace_back(r * std::cos(angle), storey.springing + r * std::sin(angle),
                        kWallThickness / 2.0F);
    }
    append(mesh, tube("", path, radius, 10, {1.0F, 4.0F}));
  }
  mesh.name = "archivolt";
  return mesh;
}

Mesh vault(const Storey& storey) {
  const auto surface = [&storey](float u, float v) {
    // Equal angles along both elliptical arches; their complements multiply to a groin.
    const float across = std::sin(kPi * u), along = std::sin(kPi * v);
    const float rise = 1.3F * (1.0F - (1.0F - across) * (1.0F - along));
    return Vec3{-kHalfBay * std::cos(kPi * u), storey.springing + rise,
                -kHalfBay * std::cos(kPi * v)};
  };
  return tessellate("vault", surface, {20, 20, Around::Open, {1.5F, 1.5F}});
}

Mesh moulding() {
  Mesh mesh = box("moulding", {kBay, 0.10F, kWallThickness + 0.24F}, kTextureSize);
  append(mesh, box("", {kBay, 0.06F, kWallThickness + 0.36F}, kTextureSize),
         translation({0.0, 0.17, 0.0}));
  const Mesh egg = sphere("", 1.0F, 8, 6);
  constexpr int kEggs = 12;
  for (int i = 0; i < kEggs; ++i) {
    const double x = kBay * ((i + 0.5) / kEggs - 0.5);
    append(mesh, egg, translation({x, 0.095, kWallThickness / 2.0 + 0.11}) * scaling(DVec3{0.055}));
    append(mesh, egg,
           translation({x + kBay / kEggs / 2.0, 0.11, kWallThickness / 2.0 + 0.12}) *
               scaling(DVec3{0.022}));
  }
  return mesh;
}

Mesh balusters() {
  constexpr std::array<Vec2, 9> kProfile{
      Vec2{0.05F, 0.0F},   Vec2{0.055F, 0.05F}, Vec2{0.03F, 0.10F},
      Vec2{0.055F, 0.20F}, Vec2{0.07F, 0.28F},  Vec2{0.05F, 0.42F},
      Vec2{0.028F, 0.56F}, Vec2{0.035F, 0.64F}, Vec2{0.055F, 0.70F}};
  const Mesh one = lathe("", smooth(kProfile, 2), 14, {1.0F, 1.0F});
  Mesh mesh;
  mesh.name = "balusters";
  constexpr int kCount = 9;
  for (int i = 0; i < kCount; ++i) {
    append(mesh, one, translation({2.4 * ((i + 0.5) / kCount - 0.5), 0.12, 0.0}));
  }
  return mesh;
}

Mesh rails() {
  Mesh mesh = box("rails", {kBay - 0.3F, 0.12F, 0.22F}, kTextureSize);
  for (Vec3& position : mesh.positions) position.y += 0.06F;
  // The hand rail is round and a little worn in the middle.
  const auto surface = [](float u, float v) {
    const float wear = 1.0F - 0.06F * std::sin(kPi * v), angle = 2 * kPi * u;
    return Vec3{(kBay - 0.3F) * (v - 0.5F), 0.88F + 0.07F * wear * std::sin(angle),
                -0.13F * wear * std::cos(angle)};
  };
  append(mesh, tessellate("", surface, {18, 24, Around::Closed, {0.3F, 1.3F}}));
  return mesh;
}

}  // namespace macula::scene::built_in::atrium_parts
