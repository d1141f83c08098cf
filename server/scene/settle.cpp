#include "server/scene/settle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <map>
#include <numbers>
#include <sstream>

#include "server/scene/animation.h"

namespace macula::scene {
namespace {

constexpr double kEyeHeight = 1.6;  // m

template <class... Parts>
void note_guess(Scene& scene, const Parts&... parts) {
  std::ostringstream text;
  text << std::setprecision(3);
  (text << ... << parts);
  scene.settings.guesses.push_back(std::move(text).str());
}

/// The same change of every place: of what hangs from a joint, through the joint at the root.
void transform_places(Scene& scene, const DMat4& now_from_before) {
  for (Joint& joint : scene.joints) {
    if (!joint.parent) joint.parent_from_base = now_from_before * joint.parent_from_base;
  }
  for (Instance& instance : scene.instances) {
    if (!instance.joint) {
      instance.parent_from_object = now_from_before * instance.parent_from_object;
    }
  }
  const auto move = [&](DVec3& place) { place = DVec3(now_from_before * DVec4(place, 1.0)); };
  for (Camera& camera : scene.cameras) {
    if (!camera.joint) move(camera.parent_from_view.position);
  }
  for (Light& light : scene.lights) {
    if (!light.joint) move(light.position);
  }
}

/// Lights keep the irradiance they gave in the file's units: intensity goes with length squared.
void scale_to_meters(Scene& scene, double meters_per_unit) {
  scene.settings.meters_per_unit = meters_per_unit;
  transform_places(scene, glm::scale(DMat4{1.0}, DVec3{meters_per_unit}));
  for (Light& light : scene.lights) {
    if (light.kind != LightKind::Directional) {
      light.intensity *= static_cast<float>(meters_per_unit * meters_per_unit);
    }
  }
}

/// An instance at time 0, for questions about its triangles.
struct PlacedMesh {
  const Mesh& mesh;
  std::span<const Vec3> positions;
  const DMat4& world_from_object;

  DVec3 corner(Index vertex) const {
    return DVec3(world_from_object * DVec4(DVec3(positions[vertex]), 1.0));
  }
};

/// Calls visit(mesh, a, b, c) with the world corners of every triangle of the instances that are
/// wanted(placed).
template <class Wanted, class Visit>
void for_each_triangle(const Scene& scene, const Wanted& wanted, const Visit& visit) {
  const ScenePose pose = pose_at(scene, {});
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Index mesh = scene.instances[i].mesh;
    const PlacedMesh placed{scene.meshes[mesh], pose.positions(scene, mesh),
                            pose.world_from_object[i]};
    if (!wanted(placed)) continue;
    for (const UVec3& t : placed.mesh.triangles) {
      visit(placed.mesh, placed.corner(t.x), placed.corner(t.y), placed.corner(t.z));
    }
  }
}

/// The boxes of meshes in object space, each computed at first use.
class MeshBoxes {
 public:
  /// Whether the vertical line through (x, z) passes through the placed mesh's box.
  bool may_meet(const PlacedMesh& placed, double x, double z) {
    const Bounds& box = box_of(placed);
    const DMat4& m = placed.world_from_object;
    const DVec3 centre(m * DVec4(box.centre(), 1.0)), half = 0.5 * box.size();
    const auto reach = [&](int axis) {
      return std::abs(m[0][axis]) * half.x + std::abs(m[1][axis]) * half.y +
             std::abs(m[2][axis]) * half.z;
    };
    // Rounding of a sum of a few products, generously.
    const double slack = 1e-9 * (std::abs(centre.x) + std::abs(centre.z) + reach(0) + reach(2));
    return std::abs(x - centre.x) <= reach(0) + slack && std::abs(z - centre.z) <= reach(2) + slack;
  }

 private:
  const Bounds& box_of(const PlacedMesh& placed) {
    Bounds& box = boxes_[&placed.mesh];
    if (box.empty()) {
      for (const Vec3& position : placed.positions) box.include(DVec3(position));
    }
    return box;
  }
  std::map<const Mesh*, Bounds> boxes_;
};

/// Heights at which the vertical line through (x, z) meets the scene, ascending.
std::vector<double> heights_at(const Scene& scene, double x, double z) {
  constexpr std::size_t kEnough = 1'000'000;  // no honest place lies under so many surfaces
  std::vector<double> heights;
  MeshBoxes boxes;
  const auto side = [x, z](const DVec3& a, const DVec3& b) {
    return (b.x - a.x) * (z - a.z) - (b.z - a.z) * (x - a.x);
  };
  for_each_triangle(
      scene, [&](const PlacedMesh& placed) { return boxes.may_meet(placed, x, z); },
      [&](const Mesh&, const DVec3& a, const DVec3& b, const DVec3& c) {
        const double wa = side(b, c), wb = side(c, a), wc = side(a, b), sum = wa + wb + wc;
        const bool inside = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
        if (inside && sum != 0.0 && heights.size() < kEnough) {
          heights.push_back((wa * a.y + wb * b.y + wc * c.y) / sum);
        }
      });
  std::sort(heights.begin(), heights.end());
  return heights;
}

/// The lowest surface with room for a person above it.
double floor_among(const std::vector<double>& heights, double otherwise) {
  constexpr double kHeadroom = 2.0;  // m
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (i + 1 == heights.size() || heights[i + 1] - heights[i] >= kHeadroom) return heights[i];
  }
  return otherwise;
}

Pose upright(const DVec3& position, double yaw_rad) {
  return {position, glm::angleAxis(yaw_rad, DVec3{0.0, 1.0, 0.0})};
}

void guess_stage_from_camera(Scene& scene) {
  const Camera& camera = scene.cameras.front();
  const Pose world_from_view = pose_at(scene, {}).world_from_view.front();
  const DVec3 forward = world_from_view.transform_direction({0.0, 0.0, -1.0});
  const DVec3& eye = world_from_view.position;
  scene.settings.scene_from_stage =
      upright({eye.x, eye.y - kEyeHeight, eye.z}, std::atan2(-forward.x, -forward.z));
  note_guess(scene, "the viewer's eyes are at the camera '", camera.name, "'");
}

void guess_stage_from_shape(Scene& scene, const Bounds& bounds) {
  const DVec3 centre = bounds.centre(), size = bounds.size();
  const double floor = floor_among(heights_at(scene, centre.x, centre.z), bounds.minimum.y);
  const bool along_x = size.x > size.z;
  scene.settings.scene_from_stage =
      upright({centre.x, floor, centre.z}, along_x ? -std::numbers::pi / 2.0 : 0.0);
  note_guess(scene, "the viewer stands in the middle, floor at y = ", floor, " m, looking along ",
             along_x ? "+x" : "-z");
}

/// Nothing overhead at the viewer's place: light can come from the sky.
bool open_to_the_sky(const Scene& scene) {
  const DVec3& stage = scene.settings.scene_from_stage.position;
  const std::vector<double> heights = heights_at(scene, stage.x, stage.z);
  return heights.empty() || heights.back() < stage.y + kEyeHeight;
}

bool is_lit(const Scene& scene) {
  return !scene.lights.empty() || scene.emissive_triangle_count() > 0 ||
         image::luminance(scene.settings.ambient) > 0.0F || scene.environment.has_value();
}

void give_default_light(Scene& scene) {
  Settings& settings = scene.settings;
  settings.ambient = Rgb{0.45F, 0.50F, 0.58F};
  settings.ambient_distance_m = 4.0;
  if (open_to_the_sky(scene)) {
    const Vec3 direction = normalize(Vec3{0.25F, -1.0F, 0.35F});
    scene.lights.push_back({.kind = LightKind::Directional,
                            .intensity = Rgb{5.0F, 4.6F, 4.0F},
                            .direction = direction});
    note_guess(scene, "the file has no light: a sun and a sky are assumed");
  } else {
    const DVec3 lamp = settings.scene_from_stage.position + DVec3{0.0, 2.2, 0.0};
    scene.lights.push_back(
        {.kind = LightKind::Point, .intensity = Rgb{6.0F, 5.6F, 5.0F}, .position = lamp});
    note_guess(scene,
               "the file has no light: a lamp over the viewer and ambient light are assumed");
  }
}

/// Radiant power over pi: emitting triangles as Lambertian sources, point lights over the sphere.
double emitted_flux_over_pi(const Scene& scene) {
  double flux = 0.0;
  const auto emits = [&scene](const PlacedMesh& placed) {
    return scene.materials[placed.mesh.material].emits();
  };
  for_each_triangle(scene, emits,
                    [&](const Mesh& mesh, const DVec3& a, const DVec3& b, const DVec3& c) {
                      const Rgb& emission = scene.materials[mesh.material].emission;
                      flux += image::luminance(emission) * 0.5 * glm::length(cross(b - a, c - a));
                    });
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::Directional) flux += 4.0 * image::luminance(light.intensity);
  }
  return flux;
}

/// Puts the expected mean radiance at middle grey: flux spread evenly over the walls of the scene's
/// box, half of it reflected. Direct lighting of cornell_box comes out within a third of a stop.
void guess_exposure(Scene& scene, const Bounds& bounds) {
  constexpr double kMiddleGrey = 0.18, kReflectance = 0.5;
  const DVec3 size = bounds.size();
  const double walls = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
  double radiance = kReflectance * image::luminance(scene.settings.ambient);
  if (scene.environment) radiance += kReflectance * image::luminance(scene.environment->mean());
  if (walls > 0.0) radiance += kReflectance * emitted_flux_over_pi(scene) / walls;
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::Directional) continue;
    // A sun reaches about a fifth of what is seen.
    radiance += 0.2 * kReflectance * image::luminance(light.intensity) / std::numbers::pi;
  }
  const double ev =
      radiance > 0.0 ? std::clamp(std::log2(kMiddleGrey / radiance), -12.0, 12.0) : 0.0;
  // Tenths of a stop, so that the printed value can be copied into a side file.
  scene.settings.tone.exposure_ev = static_cast<float>(std::round(10.0 * ev) / 10.0);
  note_guess(scene, "exposure_ev = ", scene.settings.tone.exposure_ev);
}

void settle_unit(Scene& scene, const SideFile& side) {
  if (side.meters_per_unit) return scale_to_meters(scene, *side.meters_per_unit);
  const DVec3 size = scene.bounds().size();
  const double extent = std::max({size.x, size.y, size.z});
  const double guess = guess_meters_per_unit(extent);
  scale_to_meters(scene, guess);
  if (guess != 1.0)
    note_guess(scene, "meters_per_unit = ", guess, ", as the scene is ", extent, " units long");
}

void settle_stage(Scene& scene, const SideFile& side, const Bounds& bounds) {
  if (side.scene_from_stage) {
    scene.settings.scene_from_stage = *side.scene_from_stage;
  } else if (!scene.cameras.empty()) {
    guess_stage_from_camera(scene);
  } else {
    guess_stage_from_shape(scene, bounds);
  }
}

void settle_light(Scene& scene, const SideFile& side) {
  scene.lights.insert(scene.lights.end(), side.lights.begin(), side.lights.end());
  if (side.ambient) scene.settings.ambient = *side.ambient;
  if (!is_lit(scene)) give_default_light(scene);
  if (side.ambient_distance_m) scene.settings.ambient_distance_m = *side.ambient_distance_m;
}

void settle_tone(Scene& scene, const SideFile& side, const Bounds& bounds) {
  scene.settings.tone.curve = side.tone_curve.value_or(image::ToneCurve::Filmic);
  if (side.exposure_ev) {
    scene.settings.tone.exposure_ev = *side.exposure_ev;
  } else {
    guess_exposure(scene, bounds);
  }
}

}  // namespace

double guess_meters_per_unit(double extent) {
  if (extent > 50'000.0) return 1e-3;
  if (extent > 500.0) return 1e-2;
  return 1.0;
}

DVec3 origin_for_stage(const DVec3& stage) {
  constexpr double kNear = 1000.0;  // m
  return glm::length(stage) <= kNear ? DVec3{0.0} : glm::round(stage);
}

void recentre(Scene& scene) {
  const DVec3 origin = origin_for_stage(scene.settings.scene_from_stage.position);
  if (origin == DVec3{0.0}) return;
  transform_places(scene, glm::translate(DMat4{1.0}, -origin));
  scene.settings.scene_from_stage.position -= origin;
  scene.settings.file_from_scene_m += origin;
  note_guess(scene, "the scene lies ", glm::length(origin) / 1000.0,
             " km from its file's origin and was brought to it");
}

void settle(Scene& scene, const SideFile& side) {
  settle_unit(scene, side);
  const Bounds bounds = scene.bounds();
  settle_stage(scene, side, bounds);
  settle_light(scene, side);
  settle_tone(scene, side, bounds);
}

}  // namespace macula::scene
