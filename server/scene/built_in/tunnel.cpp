// One bent tunnel twice, after the study scenes of Weier et al. 2016 (section 6): as displaced
// geometry, where every second panel of the lining stands out with hard edges and every surface is
// rough, and as maps, where the same panels are a black-and-white checkerboard painted on a smooth
// lining, the hardest case for sparse sampling.
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"

namespace macula::scene::built_in {
namespace {

constexpr float kLength = 80.0F;           // m along the axis
constexpr float kRadius = 2.2F;            // m
constexpr float kCentreHeight = 1.4F;      // m, of the lining's circle
constexpr int kAround = 20, kAlong = 160;  // panels of about 0.5 m
constexpr int kSegment = 20;               // panels along in one mesh
/// Where the circle meets the floor, below the horizontal.
const float kFloorAngle = std::asin(kCentreHeight / kRadius);
const float kHalfFloor = kRadius * std::cos(kFloorAngle);

/// The axis at `along` meters: it bends both ways and never shows its end.
struct Station {
  Vec3 centre, right;
};
Station station(float along) {
  constexpr float kSwing = 7.0F, kBend = 0.075F;  // m, 1/m
  const float slope = kSwing * kBend * std::sin(kBend * along);
  return {{kSwing * (1.0F - std::cos(kBend * along)), 0.0F, -along},
          normalize(Vec3{1.0F, 0.0F, slope})};
}

/// u from the right foot over the crown to the left one, `inwards` meters off the lining.
Vec3 lining(float u, float along, float inwards) {
  const Station s = station(along);
  const float angle = glm::mix(-kFloorAngle, std::numbers::pi_v<float> + kFloorAngle, u);
  const float r = kRadius - inwards;
  return s.centre + r * std::cos(angle) * s.right +
         Vec3{0.0F, kCentreHeight + r * std::sin(angle), 0.0F};
}

Vec3 floor_at(float u, float along, float up) {
  const Station s = station(along);
  return s.centre + kHalfFloor * (2.0F * u - 1.0F) * s.right + Vec3{0.0F, up, 0.0F};
}

float fine_roughness(const Vec3& at, std::uint64_t seed) {
  return 0.022F * roughness(4.0F * at, seed) + 0.010F * roughness(11.0F * at, seed + 1);
}

/// One panel, rough; a raised one has four sides that reach down behind the others' roughness.
Mesh panel(int i, int j, float height, std::uint64_t seed) {
  constexpr int kSteps = 6;
  constexpr float kFoot = -0.06F;  // m, deeper than any roughness
  const float u0 = static_cast<float>(i) / kAround, du = 1.0F / kAround;
  const float s0 = kLength * static_cast<float>(j) / kAlong, ds = kLength / kAlong;
  const auto face = [=](float u, float v) {
    const Vec3 flat = lining(u0 + du * u, s0 + ds * v, height);
    return lining(u0 + du * u, s0 + ds * v, height + fine_roughness(flat, seed));
  };
  Mesh mesh = tessellate("", face, {kSteps, kSteps, Around::Open, {0.25F, 0.25F}});
  if (height <= 0.0F) return mesh;
  const auto side = [&](const auto& edge) {
    // From the foot up to the face along one of its edges.
    append(mesh, tessellate("",
                            [&](float t, float up) {
                              const Vec2 at = edge(t);
                              return glm::mix(lining(u0 + du * at.x, s0 + ds * at.y, kFoot),
                                              face(at.x, at.y), up);
                            },
                            {kSteps, 1, Around::Open, {0.25F, 0.25F}}));
  };
  side([](float t) { return Vec2{t, 0.0F}; });
  side([](float t) { return Vec2{1.0F, t}; });
  side([](float t) { return Vec2{1.0F - t, 1.0F}; });
  side([](float t) { return Vec2{0.0F, 1.0F - t}; });
  return mesh;
}

void add_panels(SceneBuilder& b, Index raised, Index flush, std::uint64_t seed) {
  for (int first = 0; first < kAlong; first += kSegment) {
    Mesh standing, lying;
    standing.name = "raised panels", lying.name = "flush panels";
    for (int j = first; j < first + kSegment; ++j) {
      for (int i = 0; i < kAround; ++i) {
        const bool stands = (i + j) % 2 == 0;
        Dice dice(math::hash_combine(seed, static_cast<std::uint64_t>(j * kAround + i)));
        append(stands ? standing : lying, panel(i, j, stands ? dice.in(0.05F, 0.20F) : 0.0F, seed));
      }
    }
    b.place(std::move(standing), raised);
    b.place(std::move(lying), flush);
  }
}

void add_gravel(SceneBuilder& b, Index material, std::uint64_t seed) {
  constexpr int kRowsPerMeter = 12, kPart = 10;  // m a mesh
  for (int part = 0; part * kPart < static_cast<int>(kLength); ++part) {
    const auto first = static_cast<float>(part * kPart);
    const auto surface = [=](float u, float v) {
      const float along = first + kPart * v;
      const Vec3 flat = floor_at(u, along, 0.0F);
      const float stones = std::abs(roughness(9.0F * flat, seed + 7));
      // The path sinks towards the middle and rises into the walls' feet.
      const float bowl = 0.10F * (2.0F * u - 1.0F) * (2.0F * u - 1.0F) - 0.04F;
      return floor_at(u, along, bowl + 0.05F * stones);
    };
    b.place(tessellate("gravel", surface,
                       {48, kRowsPerMeter * kPart, Around::Open, {2.0F, kPart / 2.0F}}),
            material);
  }
}

void add_smooth_lining(SceneBuilder& b, Index lining_material, Index floor_material) {
  const auto wall = [](float u, float v) { return lining(u, kLength * v, 0.0F); };
  // One repeat of the picture is 2 x 2 panels.
  b.place(tessellate("lining", wall,
                     {4 * kAround, kAlong, Around::Open, {kAround / 2.0F, kAlong / 2.0F}}),
          lining_material);
  const auto path = [](float u, float v) { return floor_at(u, kLength * v, 0.0F); };
  b.place(tessellate("path", path, {8, kAlong, Around::Open, {2.0F, kLength / 2.0F}}),
          floor_material);
}

/// Walls that close both ends, facing inwards.
void add_ends(SceneBuilder& b, Index material) {
  for (const float along : {0.0F, kLength}) {
    const Station s = station(along);
    const float inwards = along > 0.0F ? 1.0F : -1.0F;
    const Vec3 across = inwards * 2.0F * kRadius * s.right;
    b.place(parallelogram("end", s.centre - 0.5F * across - Vec3{0.0F, 0.2F, 0.0F}, across,
                          {0.0F, 4.2F, 0.0F}, {4.0F, 4.0F}),
            material);
  }
}

/// Lamps under the crown, one every 8 m: a glowing glass with a point light below it.
void add_lamps(SceneBuilder& b, float below_crown) {
  const Index glass = b.add(lamp("lamp glass", {24.0F, 21.0F, 16.0F}));
  const Index iron = b.add(metal("iron", {0.25F, 0.24F, 0.23F}, 0.5F));
  const Index bulb = b.add(sphere("lamp", 0.09F, 20, 12), glass);
  const Index ring = b.add(torus("lamp ring", 0.095F, 0.010F, 28, 8), iron);
  for (float along = 4.0F; along < kLength; along += 8.0F) {
    const DVec3 at(lining(0.5F, along, below_crown));
    b.place(bulb, translation(at));
    b.place(ring, translation(at));
    b.place(tube("cord", {{Vec3(at), lining(0.5F, along, 0.0F)}}, 0.008F, 6), iron);
    b.add(Light{.kind = LightKind::Point,
                .intensity = Rgb{9.0F, 8.0F, 6.2F},
                .position = at - DVec3{0.0, 0.13, 0.0}});
  }
}

void set_the_scene(SceneBuilder& b) {
  Settings& settings = b.settings();
  // Light that has bounced between the walls, as far as it reaches into corners.
  settings.ambient = Rgb{0.09F, 0.085F, 0.075F};
  settings.ambient_distance_m = 1.2;
  settings.tone = {.exposure_ev = 0.8F, .curve = image::ToneCurve::Filmic};
  const auto eye = [](float along) { return DVec3(floor_at(0.5F, along, 1.6F)); };
  settings.scene_from_stage.position = DVec3(floor_at(0.5F, 6.0F, 0.05F));
  b.add(Camera{"walk", math::look_at(eye(6.0F), eye(12.0F), {0, 1, 0}), Degrees{70.0}});
  b.add(Camera{"bend", math::look_at(eye(30.0F), eye(38.0F), {0, 1, 0}), Degrees{70.0}});
}

}  // namespace

Scene tunnel_geometry(std::uint64_t seed) {
  SceneBuilder b("tunnel-geometry");
  const Index raised = b.add(lambert("raised", {0.62F, 0.58F, 0.52F}));
  const Index flush = b.add(lambert("flush", {0.42F, 0.40F, 0.38F}));
  const Index gravel = b.add(lambert("gravel", {0.36F, 0.33F, 0.29F}));
  add_panels(b, raised, flush, seed * 100);
  add_gravel(b, gravel, seed * 100 + 10);
  add_ends(b, flush);
  add_lamps(b, 0.45F);
  set_the_scene(b);
  return std::move(b).finish();
}

Scene tunnel_maps(std::uint64_t seed) {
  SceneBuilder b("tunnel-maps");
  const Index checks = b.add(textured(
      "checkerboard", b.add(checkerboard("checkerboard", 512, 2, {Vec3{0.06F}, Vec3{0.94F}}))));
  Field field = noise(1024, {.cells = 8, .octaves = 7, .gain = 0.7F}, seed * 100);
  for (float& value : field.pixels()) value = 0.5F + 0.8F * value;
  const Index grain =
      b.add(textured("noise", b.add(colored("noise", field, {Vec3{0.10F}, Vec3{0.85F}}))));
  add_smooth_lining(b, checks, grain);
  add_ends(b, grain);
  add_lamps(b, 0.3F);
  set_the_scene(b);
  return std::move(b).finish();
}

}  // namespace macula::scene::built_in
