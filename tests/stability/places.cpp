// Scale and distance from the origin: coordinates that floats cannot hold.
#include "server/scene/settle.h"
#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

template <int kPowerOfTen>
Shot scaled_by() {
  const double factor = std::pow(10.0, kPowerOfTen);
  Shot shot = quiet_shot();
  shot.scene = scaled(shot.scene, factor);
  shot.unit_m = factor;
  return shot;
}
/// The geometry grew, its lamps' power did not.
template <int kPowerOfTen>
Shot geometry_scaled_by() {
  Shot shot = scaled_by<kPowerOfTen>();
  for (std::size_t i = 0; i < shot.scene.lights.size(); ++i)
    shot.scene.lights[i].intensity = quiet_room().lights[i].intensity;
  return shot;
}

const DVec3 kFar{1e5 + 0.003, -0.7e5 + 0.001, 0.4e5 + 0.002};

/// As the loader places it.
Shot far_away() {
  Shot shot = quiet_shot();
  shot.scene = moved(shot.scene, kFar);
  shot.scene.settings.scene_from_stage.position = kFar;
  scene::recentre(shot.scene);
  shot.eye.position = kFar - shot.scene.settings.file_from_scene_m;
  return shot;
}
/// As it would be without that.
Shot far_away_in_floats() {
  Shot shot = quiet_shot();
  shot.scene = moved(shot.scene, kFar);
  shot.eye.position = kFar;
  return shot;
}

Shot turned_around() {
  Shot shot = quiet_shot();
  const DMat4 turn = glm::rotate(DMat4{1.0}, 2.0, glm::normalize(DVec3{1, 2, 3}));
  for (scene::Instance& instance : shot.scene.instances)
    instance.parent_from_object = turn * instance.parent_from_object;
  for (scene::Light& light : shot.scene.lights)
    light.position = DVec3(turn * DVec4(light.position, 1.0));
  shot.eye.rotation = glm::angleAxis(2.0, glm::normalize(DVec3{1, 2, 3}));
  return shot;
}
Shot turned_without_the_eye() {
  Shot shot = turned_around();
  shot.eye.rotation = glm::angleAxis(2.01, glm::normalize(DVec3{1, 2, 3}));
  return shot;
}

}  // namespace

std::vector<Extreme> places() {
  return {
      {"AMillionthOfTheSize", quiet_shot, scaled_by<-6>, geometry_scaled_by<-6>},
      {"AMillionTimesTheSize", quiet_shot, scaled_by<6>, geometry_scaled_by<6>},
      {"AHundredKilometersFromTheOrigin", quiet_shot, far_away, far_away_in_floats},
      {"EverythingTurned", quiet_shot, turned_around, turned_without_the_eye, 1e-3, 0.002},
  };
}

}  // namespace macula::stability
