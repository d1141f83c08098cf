// The Cornell box lit by what stands in it: 110,000 triangles, nearly all of them lights (the scale
// of the Cornellbox of the foveated stochastic lightcuts paper: 110.5k of each). Glowing knots,
// burrs and beads, each of its own colour and shape, so that light comes from everywhere and every
// surface point sees other triangles.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/cornell_box.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

/// A (p, q) torus knot as a tube, about one meter across.
Mesh knot(int p, int q, float tube_radius, int steps, int columns) {
  std::vector<Vec3> path;
  for (int i = 0; i <= steps; ++i) {
    const float t = kTurn * static_cast<float>(i) / static_cast<float>(steps);
    const float r = 0.34F + 0.13F * std::cos(static_cast<float>(q) * t);
    path.emplace_back(r * std::cos(static_cast<float>(p) * t),
                      0.16F * std::sin(static_cast<float>(q) * t),
                      r * std::sin(static_cast<float>(p) * t));
  }
  return tube("knot", path, tube_radius, columns);
}

/// A ball with lobes: a harmonic of degree `lobes` on a sphere of radius 0.3 m.
Mesh lobed_ball(int lobes, int columns, int rows) {
  const auto surface = [lobes](float u, float v) {
    const float azimuth = kTurn * u, polar = 0.5F * kTurn * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : std::sin(polar);
    const float wave = std::cos(static_cast<float>(lobes) * azimuth) * ring * ring;
    const float r = 0.3F * (1.0F + 0.38F * wave * std::cos(static_cast<float>(lobes) * polar));
    return r * Vec3{ring * std::cos(azimuth), -std::cos(polar), -ring * std::sin(azimuth)};
  };
  return tessellate("lobed ball", surface, {columns, rows, Around::Closed});
}

/// Beads on a string that sags between two points.
Mesh beads(const Vec3& from, const Vec3& to, float sag, int count) {
  const Mesh bead = sphere("", 0.018F, 12, 8);
  Mesh mesh;
  mesh.name = "beads";
  for (int i = 0; i < count; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const Vec3 at = glm::mix(from, to, t) - Vec3{0.0F, 4.0F * sag * t * (1.0F - t), 0.0F};
    append(mesh, bead, translation(DVec3(at)));
  }
  return mesh;
}

/// Hue in turns; the largest channel is 1.
Rgb hue(float h) {
  const auto channel = [h](float shift) { return 0.5F + 0.5F * std::cos(kTurn * (h - shift)); };
  const Rgb color{channel(0.0F), channel(1.0F / 3.0F), channel(2.0F / 3.0F)};
  return color / std::max({color.x, color.y, color.z});
}

void add_glowing(SceneBuilder& b, std::uint64_t seed) {
  Dice dice(seed);
  const auto glow = [&b](float h, float radiance) {
    return b.add(lamp("glow", radiance * glm::mix(hue(h), Rgb{1.0F}, 0.06F)));
  };
  const auto turned = [&dice](const DVec3& at, double size) {
    return translation(at) * rotation_y(Degrees{360.0 * dice.next()}) *
           rotation_x(Degrees{70.0 * dice.next()}) * scaling(DVec3{size});
  };
  b.place(knot(2, 3, 0.055F, 360, 20), glow(0.02F, 1.2F), turned({-0.62, 1.72, -1.55}, 0.75));
  b.place(knot(3, 5, 0.035F, 420, 14), glow(0.55F, 1.5F), turned({0.55, 1.60, -1.2}, 0.80));
  b.place(knot(2, 5, 0.040F, 400, 16), glow(0.12F, 1.4F), turned({0.66, 0.62, -0.55}, 0.62));
  b.place(lobed_ball(7, 120, 72), glow(0.08F, 2.4F), turned({-0.05, 2.02, -0.75}, 0.62));
  b.place(lobed_ball(5, 110, 64), glow(0.85F, 1.3F), turned({-0.75, 0.24, -0.62}, 0.75));
  b.place(knot(3, 2, 0.05F, 360, 18), glow(0.38F, 1.4F), turned({0.02, 0.30, -0.42}, 0.55));
  for (int i = 0; i < 4; ++i) {
    const float z = -0.35F - 0.6F * static_cast<float>(i);
    b.place(beads({-1.18F, 2.25F, z}, {1.18F, 2.25F, z - 0.2F}, 0.25F + 0.06F * dice.next(), 40),
            glow(dice.next(), 2.2F));
  }
}

}  // namespace

Scene cornell_lights(std::uint64_t seed) {
  SceneBuilder b("cornell-lights");
  const CornellMaterials materials = add_cornell_room(b);
  add_cornell_blocks(b, materials.white);
  add_glowing(b, seed * 100);
  Settings& settings = b.settings();
  settings.scene_from_stage.position = {0.0, 0.0, 0.9};
  settings.tone = {.exposure_ev = 0.0F, .curve = image::ToneCurve::Filmic};
  settings.ambient = Rgb{0.03F};
  settings.ambient_distance_m = 1.0;
  b.add(Camera{"front", math::look_at({0.0, 1.2, 3.4}, {0.0, 1.2, 0.0}, {0, 1, 0}), Degrees{39.0}});
  b.add(
      Camera{"stage", math::look_at({0.0, 1.6, 0.9}, {0.0, 1.1, -1.2}, {0, 1, 0}), Degrees{70.0}});
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
