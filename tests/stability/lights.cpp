// Lights: none, one, as many as trees do not like, all in one place, too weak and too strong.
#include <array>
#include <cmath>
#include <limits>

#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

/// quiet_room() under `count` lamps in one place, which together shine as one.
Shot under(int count, float share_of_the_last = 1.0F) {
  Shot shot = quiet_shot();
  scene::Light lamp = shot.scene.lights.front();
  lamp.intensity = lamp.intensity / static_cast<float>(count);
  shot.scene.lights.assign(static_cast<std::size_t>(count), lamp);
  shot.scene.lights.back().intensity *= share_of_the_last;
  return shot;
}
template <int kCount>
Shot shared_by() {
  return under(kCount);
}
/// One of many shines thrice: what a missing or repeated leaf would do.
template <int kCount>
Shot unevenly_shared_by() {
  return under(kCount, 3.0F);
}
template <int kCount>
Extreme coincident(const char* name, In in = In::BothModes) {
  // 2 / count more light everywhere is the near miss.
  return {name,
          shared_by<1>,
          shared_by<kCount>,
          unevenly_shared_by<kCount>,
          0.5 * std::pow(2.0 / kCount, 2),
          0.0,
          in};
}

Shot without_lamps() {
  Shot shot = quiet_shot();
  shot.scene.lights.clear();
  return shot;
}
template <int kBillionths>
Shot lamps_dimmed_to() {
  Shot shot = quiet_shot();
  for (scene::Light& lamp : shot.scene.lights)
    lamp.intensity *= static_cast<float>(kBillionths) * 1e-9F;
  return shot;
}

/// Lamps in one place of 1e-20, 1e-19 ... 1e20 W/sr.
Shot of_every_power() {
  Shot shot = quiet_shot();
  const scene::Light lamp = shot.scene.lights.front();
  shot.scene.lights.clear();
  for (int power = -20; power <= 20; ++power) {
    shot.scene.lights.push_back(lamp);
    shot.scene.lights.back().intensity = Rgb{std::pow(10.0F, static_cast<float>(power))};
  }
  shot.gain = 1e20F;
  return shot;
}
Shot of_the_sum_of_powers() {
  Shot shot = under(1);
  shot.scene.lights.front().intensity = Rgb{1.0F + 1.0F / 9.0F};
  return shot;
}
Shot without_the_second_strongest() {
  Shot shot = of_every_power();
  shot.scene.lights.erase(shot.scene.lights.end() - 2);
  return shot;
}

template <int kPowerOfTen>
Shot of_power() {
  Shot shot = quiet_shot();
  shot.gain = std::pow(10.0F, static_cast<float>(kPowerOfTen));
  for (scene::Light& lamp : shot.scene.lights) lamp.intensity *= shot.gain;
  return shot;
}
template <int kPowerOfTen>
Shot of_power_and_a_tenth() {
  Shot shot = of_power<kPowerOfTen>();
  for (scene::Light& lamp : shot.scene.lights) lamp.intensity *= 1.1F;
  return shot;
}

/// A floor alone, and a lamp above, on, or below it.
Shot floor_and_lamp(double height) {
  Shot shot = quiet_shot();
  shot.scene.meshes.resize(1), shot.scene.instances.resize(1);
  shot.scene.lights.resize(1);
  shot.scene.lights.front().position = {0.1, -1.0 + height, -2.0};
  return shot;
}
Shot unlit_floor() {
  Shot shot = floor_and_lamp(0.0);
  shot.scene.lights.clear();
  return shot;
}
Shot lamp_on_the_floor() {
  return floor_and_lamp(0.0);
}
Shot lamp_below_the_floor() {
  return floor_and_lamp(-1e-3);
}
Shot lamp_above_the_floor() {
  return floor_and_lamp(1e-3);
}

/// The lamp as far away as `distance_m`, as bright as if it were directional.
Shot under_a_star(double distance_m) {
  Shot shot = quiet_shot();
  scene::Light star = shot.scene.lights.front();
  star.position = distance_m * glm::normalize(DVec3{1, 2, 1});
  star.intensity = Rgb{3.0F * static_cast<float>(distance_m * distance_m)};
  shot.scene.lights = {star};
  return shot;
}
Shot under_a_sun() {
  Shot shot = under_a_star(1.0);
  scene::Light& sun = shot.scene.lights.front();
  sun.kind = scene::LightKind::Directional;
  sun.direction = -Vec3(glm::normalize(DVec3{1, 2, 1}));
  sun.intensity = Rgb{3.0F};
  return shot;
}
Shot under_a_distant_star() {
  return under_a_star(1e12);
}
Shot under_a_near_star() {
  return under_a_star(30.0);
}

/// A spot as wide as a hemisphere that looks at everything, or as narrow as nothing.
Shot under_spots(double inner_deg, double outer_deg) {
  Shot shot = quiet_shot();
  for (scene::Light& lamp : shot.scene.lights) {
    lamp.kind = scene::LightKind::Spot;
    lamp.direction = {0.0F, -1.0F, 0.0F};
    lamp.position.y = 30.0;
    lamp.intensity *= 900.0F;
    lamp.inner_cone = Degrees{inner_deg}, lamp.outer_cone = Degrees{outer_deg};
  }
  return shot;
}
Shot under_points_far_above() {
  Shot shot = under_spots(0.0, 45.0);
  for (scene::Light& lamp : shot.scene.lights) lamp.kind = scene::LightKind::Point;
  return shot;
}
Shot under_the_widest_spots() {
  return under_spots(89.0, 90.0);
}
Shot under_sharp_spots() {
  return under_spots(45.0, 45.0);
}
Shot under_soft_spots() {
  return under_spots(0.0, 3.0);
}
Shot under_closed_spots() {
  return under_spots(0.0, 0.0);
}
Shot under_nearly_closed_spots() {
  return under_spots(4.0, 5.0);
}

}  // namespace

std::vector<Extreme> lights() {
  return {
      coincident<2>("TwoInOnePlace"),
      coincident<3>("ThreeInOnePlace"),
      coincident<7>("SevenInOnePlace"),
      coincident<8>("EightInOnePlace"),
      coincident<9>("NineInOnePlace"),
      coincident<127>("AHundredTwentySevenInOnePlace", In::Exact),
      coincident<128>("AHundredTwentyEightInOnePlace", In::Exact),
      coincident<129>("AHundredTwentyNineInOnePlace", In::Exact),
      {"AllOfNoPower", without_lamps, lamps_dimmed_to<0>, lamps_dimmed_to<50'000'000>, 0.0},
      {"FromTenToTheMinusTwentyToTenToTheTwenty", of_the_sum_of_powers, of_every_power,
       without_the_second_strongest, 1e-6, 0.0, In::Exact},
      {"OfTenToTheMinusTwenty", quiet_shot, of_power<-20>, of_power_and_a_tenth<-20>, 1e-3, 0.0,
       In::Exact},
      {"OfTenToTheMinusFifteen", quiet_shot, of_power<-15>, of_power_and_a_tenth<-15>},
      {"OfTenToTheTwenty", quiet_shot, of_power<20>, of_power_and_a_tenth<20>, 1e-3, 0.0,
       In::Exact},
      {"OfTenToTheFifteen", quiet_shot, of_power<15>, of_power_and_a_tenth<15>},
      {"ALampInTheFloor", unlit_floor, lamp_on_the_floor, lamp_above_the_floor, 0.0},
      {"ALampJustBelowTheFloor", unlit_floor, lamp_below_the_floor, lamp_above_the_floor, 0.0},
      {"AStarATerameterAway", under_a_sun, under_a_distant_star, under_a_near_star, 1e-5, 0.0,
       In::Exact},
      {"SpotsAsWideAsAHemisphere", under_points_far_above, under_the_widest_spots, under_soft_spots,
       1e-3, 0.0, In::BothModes, 1e-4, 0.1},
      {"SpotsWithoutASoftRim", under_points_far_above, under_sharp_spots, under_soft_spots, 1e-3,
       0.0, In::BothModes, 1e-4, 0.1},
      {"SpotsOfNoWidth", without_lamps, under_closed_spots, under_nearly_closed_spots, 0.0},
  };
}

}  // namespace macula::stability
