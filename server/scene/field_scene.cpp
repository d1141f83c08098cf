#include "server/scene/field_scene.h"

#include <cmath>
#include <utility>

#include "server/scene/settle.h"

namespace macula::scene {
namespace {

std::optional<Pattern> pattern_of(const sdf::Material& material) {
  const auto make = [&](PatternKind kind) {
    return Pattern{kind, material.second, material.pattern_size_m};
  };
  switch (material.pattern) {
    case sdf::Pattern::None:
      return std::nullopt;
    case sdf::Pattern::Checker:
      return make(PatternKind::Checker);
    case sdf::Pattern::Noise:
      return make(PatternKind::Noise);
    case sdf::Pattern::Bricks:
      return make(PatternKind::Bricks);
    case sdf::Pattern::Stripes:
      return make(PatternKind::Stripes);
  }
  return std::nullopt;
}

/// A surface as rough as can be is Lambert's: no lobe at all.
Material material_of(const sdf::Material& material) {
  Material out;
  out.name = material.name;
  out.base_color = material.color;
  out.pattern = pattern_of(material);
  out.metallic = material.metallic;
  out.roughness = material.roughness;
  out.specular = material.roughness < 1.0F || material.metallic > 0.0F ? 1.0F : 0.0F;
  out.emission = material.emission;
  return out;
}

/// Eyes of a standing viewer at the field's first camera.
constexpr double kEyeHeight_m = 1.6;

Pose stage_of(const Camera& camera) {
  const DVec3 forward = camera.parent_from_view.transform_direction({0.0, 0.0, -1.0});
  const DVec3 floor = camera.parent_from_view.position - DVec3{0.0, kEyeHeight_m, 0.0};
  return {floor, glm::angleAxis(std::atan2(-forward.x, -forward.z), DVec3{0.0, 1.0, 0.0})};
}

}  // namespace

std::vector<Light> field_lights(const sdf::Field& field, double time_s) {
  std::vector<Light> lights;
  for (const sdf::PointLight& point : field.lights) {
    Light light;
    light.kind = LightKind::Point;
    light.position = field.at(point.position, time_s);
    light.intensity = Rgb(field.at(point.intensity, time_s));
    lights.push_back(light);
  }
  for (const sdf::Sun& sun : field.suns) {
    Light light;
    light.kind = LightKind::Directional;
    light.direction = sun.direction;
    light.intensity = sun.irradiance;
    lights.push_back(light);
  }
  return lights;
}

std::vector<Camera> field_cameras(const sdf::Field& field, double time_s) {
  std::vector<Camera> cameras;
  for (const sdf::Camera& camera : field.cameras)
    cameras.push_back({camera.name, field.pose_of(camera, time_s), camera.vertical_fov, {}});
  return cameras;
}

DVec3 recentre(sdf::Field& field) {
  if (field.cameras.empty()) return DVec3{0.0};
  const DVec3 origin = origin_for_stage(field.at(field.cameras.front().eye, 0.0));
  sdf::translate(field, -origin);
  return origin;
}

Scene scene_of(std::shared_ptr<const sdf::Field> field) {
  Scene scene;
  scene.name = field->name;
  for (const sdf::Material& material : field->materials)
    scene.materials.push_back(material_of(material));
  scene.lights = field_lights(*field, 0.0);
  scene.cameras = field_cameras(*field, 0.0);
  scene.settings.ambient = field->sky;
  scene.settings.tone.exposure_ev = static_cast<float>(field->exposure_ev);
  if (!scene.cameras.empty()) scene.settings.scene_from_stage = stage_of(scene.cameras.front());
  scene.field = std::move(field);
  return scene;
}

}  // namespace macula::scene
