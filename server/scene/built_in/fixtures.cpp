#include "server/scene/built_in/fixtures.h"

#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

std::vector<Vec3> sagging(const Vec3& from, const Vec3& to, float sag, int steps) {
  std::vector<Vec3> path;
  for (int i = 0; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    path.push_back(glm::mix(from, to, t) - Vec3{0.0F, 4.0F * sag * t * (1.0F - t), 0.0F});
  }
  return path;
}

std::vector<Vec3> straight(const Vec3& from, const Vec3& to, int steps) {
  return sagging(from, to, 0.0F, steps);
}

/// A ball with bumps, for coals.
Mesh lump(float radius, std::uint64_t seed) {
  const auto surface = [=](float u, float v) {
    const float azimuth = 2 * kPi * u, polar = kPi * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : std::sin(polar);
    const Vec3 unit{ring * std::cos(azimuth), -std::cos(polar), -ring * std::sin(azimuth)};
    return radius * (1.0F + 0.35F * roughness(2.5F * unit + Vec3{7.0F}, seed)) * unit;
  };
  return tessellate("", surface, {12, 8, Around::Closed});
}

}  // namespace

Mesh bulb(float radius, int columns, int rows) {
  const auto surface = [radius](float u, float v) {
    const float azimuth = 2 * kPi * u, polar = kPi * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : std::sin(polar);
    // From the tip upwards; the upper half narrows into the cap.
    const float neck = 1.0F - 0.45F * v * v;
    return radius * Vec3{neck * ring * std::cos(azimuth), -1.35F - 1.35F * std::cos(polar),
                         -neck * ring * std::sin(azimuth)};
  };
  return tessellate("bulb", surface, {columns, rows, Around::Closed});
}

StringOfLights string_of_lights(const Vec3& from, const Vec3& to, const StringShape& shape,
                                std::uint64_t seed) {
  Dice dice(seed);
  StringOfLights result;
  const std::vector<Vec3> path = sagging(from, to, shape.sag, 2 * shape.count);
  result.cable = tube("cable", path, 0.0035F, 5);
  const Mesh one = bulb(shape.bulb_radius, 10, 7);
  constexpr std::array<Vec2, 4> kCap{Vec2{0.0F, -0.010F}, Vec2{0.009F, -0.010F},
                                     Vec2{0.008F, 0.008F}, Vec2{0.0F, 0.012F}};
  const Mesh cap = lathe("", kCap, 8);
  for (int i = 0; i < shape.count; ++i) {
    const Vec3& at = path[static_cast<std::size_t>(2 * i + 1)];
    const DMat4 place = translation(DVec3(at)) * rotation_y(Degrees{360.0 * dice.next()}) *
                        rotation_x(Degrees{24.0 * (dice.next() - 0.5)});
    append(result.bulbs, one, place);
    append(result.cable, cap, place);
  }
  result.bulbs.name = "bulbs";
  return result;
}

Screen screen(float width, float height, int cells) {
  constexpr float kBend = 1.6F;  // m, radius of curvature
  const float foot = 0.16F, half_angle = 0.5F * width / kBend;
  const auto curved = [=](float grow, float depth) {
    return [=](float u, float v) {
      const float angle = (1.0F + grow) * half_angle * (2.0F * u - 1.0F);
      return Vec3{kBend * std::sin(angle),
                  foot + 0.5F * height + (1.0F + grow) * height * (v - 0.5F),
                  kBend * (1.0F - std::cos(angle)) - depth};
    };
  };
  const int rows = static_cast<int>(std::lround(static_cast<float>(cells) * height / width));
  Screen result;
  result.picture =
      tessellate("screen", curved(0.0F, 0.0F), {cells, rows, Around::Open, {1.0F, 1.0F}});
  for (Vec2& texcoord : result.picture.texcoords) texcoord.y = 1.0F - texcoord.y;
  // The case is a shell a little larger, behind; its front shows around the picture.
  result.case_ = tessellate("case", curved(0.04F, 0.006F), {24, 4, Around::Open});
  append(result.case_, inside_out(tessellate("", curved(0.04F, 0.035F), {24, 4, Around::Open})));
  append(result.case_,
         tube("", straight({0, 0.02F, -0.05F}, {0, foot + 0.3F * height, -0.04F}, 4), 0.025F, 12));
  constexpr std::array<Vec2, 5> kFoot{Vec2{0.0F, 0.0F}, Vec2{0.14F, 0.0F}, Vec2{0.14F, 0.012F},
                                      Vec2{0.05F, 0.025F}, Vec2{0.0F, 0.03F}};
  append(result.case_, lathe("", kFoot, 32), translation({0.0, 0.0, -0.05}));
  return result;
}

Lamp shaded_lamp(float height, float shade_radius) {
  const std::array<Vec2, 9> foot{
      Vec2{0.0F, 0.0F},           Vec2{0.14F, 0.0F},           Vec2{0.13F, 0.03F},
      Vec2{0.04F, 0.06F},         Vec2{0.03F, 0.2F * height},  Vec2{0.045F, 0.3F * height},
      Vec2{0.02F, 0.4F * height}, Vec2{0.018F, 0.7F * height}, Vec2{0.0F, 0.78F * height}};
  Lamp lamp;
  lamp.body = lathe("lamp foot", smooth(foot, 3), 24);
  const auto shade = [=](float u, float v) {
    // Pleats that end at both rims.
    const float pleat = 0.012F * std::cos(2 * kPi * 36.0F * u) * std::sin(kPi * v);
    const float r = shade_radius * (1.0F - 0.38F * v) + pleat;
    return Vec3{r * std::cos(2 * kPi * u), height * (0.72F + 0.26F * v),
                -r * std::sin(2 * kPi * u)};
  };
  lamp.glow = tessellate("shade", shade, {144, 6, Around::Closed});
  append(lamp.glow, bulb(0.035F, 20, 12), translation({0.0, 0.92 * height, 0.0}));
  for (const float v : {0.0F, 1.0F})
    append(lamp.body, torus("", shade_radius * (1.0F - 0.38F * v), 0.006F, 72, 6),
           translation({0.0, double{height} * (0.72 + 0.26 * v), 0.0}));
  return lamp;
}

Lamp desk_lamp() {
  Lamp lamp;
  constexpr std::array<Vec2, 5> kFoot{Vec2{0.0F, 0.0F}, Vec2{0.10F, 0.0F}, Vec2{0.10F, 0.02F},
                                      Vec2{0.02F, 0.04F}, Vec2{0.0F, 0.05F}};
  lamp.body = lathe("desk lamp", kFoot, 28);
  append(lamp.body, tube("", straight({0, 0.03F, 0}, {0.0F, 0.36F, -0.12F}, 4), 0.008F, 8));
  append(lamp.body, tube("", straight({0.0F, 0.36F, -0.12F}, {0.0F, 0.50F, 0.16F}, 4), 0.008F, 8));
  append(lamp.body, sphere("", 0.016F, 14, 8), translation({0.0, 0.36, -0.12}));
  constexpr std::array<Vec2, 6> kReflector{Vec2{0.095F, -0.06F}, Vec2{0.085F, -0.02F},
                                           Vec2{0.06F, 0.02F},   Vec2{0.03F, 0.05F},
                                           Vec2{0.02F, 0.08F},   Vec2{0.0F, 0.085F}};
  const Mesh reflector = lathe("", smooth(kReflector, 3), 36);
  const DMat4 head = translation({0.0, 0.47, 0.19}) * rotation_x(Degrees{-20.0});
  append(lamp.body, reflector, head);
  append(lamp.body, inside_out(reflector), head * scaling(DVec3{0.97}));
  lamp.glow = bulb(0.03F, 24, 16);
  Mesh turned;
  turned.name = "bulb";
  append(turned, lamp.glow, head * translation({0.0, 0.04, 0.0}));
  lamp.glow = std::move(turned);
  return lamp;
}

Lamp chandelier(float drop, int arms) {
  Lamp lamp;
  lamp.body.name = "chandelier", lamp.glow.name = "candle bulbs";
  constexpr std::array<Vec2, 9> kStem{Vec2{0.0F, -0.30F},  Vec2{0.03F, -0.27F}, Vec2{0.06F, -0.2F},
                                      Vec2{0.03F, -0.12F}, Vec2{0.07F, -0.05F}, Vec2{0.04F, 0.03F},
                                      Vec2{0.02F, 0.15F},  Vec2{0.03F, 0.24F},  Vec2{0.0F, 0.27F}};
  const DMat4 hub = translation({0.0, -double{drop}, 0.0});
  append(lamp.body, lathe("", smooth(kStem, 3), 28), hub);
  append(lamp.body, tube("", straight({0, 0, 0}, {0, -drop + 0.26F, 0}, 6), 0.006F, 6));
  std::vector<Vec3> curve;
  for (int i = 0; i <= 20; ++i) {
    const float t = static_cast<float>(i) / 20.0F;
    curve.emplace_back(0.05F + 0.4F * t, -0.05F - 0.14F * std::sin(kPi * t) + 0.1F * t * t, 0.0F);
  }
  const Mesh arm = tube("", curve, 0.011F, 10);
  constexpr std::array<Vec2, 5> kCup{Vec2{0.0F, 0.0F}, Vec2{0.05F, 0.015F}, Vec2{0.02F, 0.03F},
                                     Vec2{0.014F, 0.10F}, Vec2{0.0F, 0.105F}};
  const Mesh cup = lathe("", kCup, 18);
  const Mesh flame = bulb(0.02F, 22, 16);
  // Bulbs stand on their candles.
  const DMat4 upright = rotation_x(Degrees{180.0});
  for (int i = 0; i < arms; ++i) {
    const DMat4 turn = hub * rotation_y(Degrees{360.0 * i / arms});
    append(lamp.body, arm, turn);
    append(lamp.body, cup, turn * translation({0.45, 0.05, 0.0}));
    append(lamp.glow, flame, turn * translation({0.45, 0.155, 0.0}) * upright);
  }
  return lamp;
}

Lamp pendant(float drop, float radius) {
  Lamp lamp;
  const auto dome = [radius](float u, float v) {
    const float polar = 0.5F * kPi * v, ring = v >= 1.0F ? 0.0F : std::cos(polar);
    return radius *
           Vec3{ring * std::cos(2 * kPi * u), std::sin(polar), -ring * std::sin(2 * kPi * u)};
  };
  const Mesh outer = tessellate("pendant", dome, {48, 16, Around::Closed});
  const DMat4 hung = translation({0.0, -double{drop}, 0.0});
  append(lamp.body, outer, hung);
  append(lamp.body, inside_out(outer), hung * scaling(DVec3{0.97}));
  append(lamp.body, tube("", straight({0, 0, 0}, {0, -drop + radius, 0}, 6), 0.005F, 6));
  append(lamp.glow, bulb(0.32F * radius, 40, 24), hung * translation({0.0, 0.75 * radius, 0.0}));
  lamp.body.name = "pendant", lamp.glow.name = "bulb";
  return lamp;
}

Mesh embers(float radius, int count, std::uint64_t seed) {
  Dice dice(seed);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const float r = radius * std::sqrt(dice.next()), angle = 2 * kPi * dice.next();
    const float height = 0.55F * (radius - r) * dice.next();
    append(mesh, lump(dice.in(0.015F, 0.04F), seed + static_cast<std::uint64_t>(i)),
           translation({r * std::cos(angle), height + 0.02, 0.6 * r * std::sin(angle)}));
  }
  mesh.name = "embers";
  return mesh;
}

Lamp candles(int count, float spread, std::uint64_t seed) {
  Dice dice(seed);
  Lamp result;
  constexpr std::array<Vec2, 7> kFlame{
      Vec2{0.0F, 0.0F},     Vec2{0.006F, 0.004F}, Vec2{0.010F, 0.014F}, Vec2{0.009F, 0.024F},
      Vec2{0.006F, 0.036F}, Vec2{0.002F, 0.048F}, Vec2{0.0F, 0.052F}};
  const Mesh flame = lathe("", kFlame, 12);
  for (int i = 0; i < count; ++i) {
    const float tall = dice.in(0.06F, 0.2F), r = dice.in(0.018F, 0.035F);
    const std::array<Vec2, 6> wax{
        Vec2{0.0F, 0.0F},      Vec2{r, 0.0F},         Vec2{0.97F * r, 0.5F * tall},
        Vec2{r, 0.96F * tall}, Vec2{0.85F * r, tall}, Vec2{0.0F, tall - 0.012F}};
    const DMat4 at =
        translation({spread * (dice.next() - 0.5), 0.0, 0.5 * spread * (dice.next() - 0.5)});
    append(result.body, lathe("", smooth(wax, 2), 24), at);
    append(result.glow, flame, at * translation({0.0, double{tall} + 0.002, 0.0}));
  }
  result.body.name = "candles", result.glow.name = "flames";
  return result;
}

}  // namespace macula::scene::built_in
