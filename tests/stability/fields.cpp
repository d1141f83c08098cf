// Distance fields: scale, distance, eyes inside, thin things, operators that do nothing.
#include <iomanip>
#include <sstream>

#include "server/scene/field_scene.h"
#include "server/sdf/read.h"
#include "shared/base/text.h"
#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

struct Placement {
  double scale = 1.0;
  DVec3 offset{0.0};
};
std::string vector_text(const DVec3& v) {
  std::ostringstream text;
  text << std::setprecision(17) << '[' << v.x << ", " << v.y << ", " << v.z << ']';
  return text.str();
}

sdf::Field parsed(const std::string& text) {
  auto field = sdf::parse_field(text, "test");
  if (field) return std::move(*field);
  ADD_FAILURE() << field.error().message();
  std::abort();
}

Shot shot_of(sdf::Field field) {
  Shot shot;
  shot.scene = scene::scene_of(std::make_shared<const sdf::Field>(std::move(field)));
  shot.grid = foveation::make_uniform_grid(test::display(32));
  return shot;
}

Shot shot_of(const std::string& text) {
  return shot_of(parsed(text));
}

/// A hall with a ring and a ball under two lamps; `ring` stands for the ring's node.
std::string hall(const std::string& ring, const Placement& placed = {}, double power = 0.1) {
  const auto lamp = [&](const DVec3& at, double intensity) {
    return base::concat("{\"position\": ", vector_text(placed.scale * at + placed.offset),
                        ", \"intensity\": ", power * intensity * placed.scale * placed.scale, "}");
  };
  return base::concat(
      R"({"materials": {"wall": {"color": [0.7, 0.6, 0.5]}, "ball": {"color": [0.2, 0.4, 0.8]}},
      "far": )",
      100.0 * placed.scale, R"(, "scene": {"type": "union", "material": "wall", "scale": )",
      placed.scale, ", \"at\": ", vector_text(placed.offset), R"(, "of": [
      {"type": "plane", "normal": [0, 1, 0], "at": [0, -1, 0]},
      {"type": "plane", "normal": [0, 0, 1], "at": [0, 0, -6.5]},
      {"type": "sphere", "radius": 0.6, "at": [0.8, -0.4, -3.5], "material": "ball"}, )",
      ring, "]}, \"lights\": [", lamp({1.2, 0.8, -1.5}, 2.0), ", ", lamp({-1.4, 1.3, -3.0}, 1.5),
      "]}");
}
const std::string kRing =
    R"({"type": "torus", "radius": 0.9, "tube_radius": 0.2, "at": [-0.9, -0.4, -4], "rotate_deg": [60, 0, 20]})";

Shot plain_hall() {
  return shot_of(hall(kRing));
}
/// Another ring stands a little elsewhere: what an operator that does something would do.
Shot changed_hall() {
  std::string ring = kRing;
  ring.replace(ring.find("-0.9, -0.4"), 10, "-0.8, -0.4");
  return shot_of(hall(ring));
}
Shot wrapped(const std::string& opening) {
  return shot_of(hall("{" + opening + R"(, "of": )" + kRing + "}"));
}

template <int kPowerOfTen>
Shot scaled_hall() {
  const double factor = std::pow(10.0, kPowerOfTen);
  Shot shot = shot_of(hall(kRing, {factor, DVec3{0.0}}));
  shot.unit_m = factor;
  return shot;
}
template <int kPowerOfTen>
Shot geometry_scaled_hall() {
  const double factor = std::pow(10.0, kPowerOfTen);
  Shot shot = shot_of(hall(kRing, {factor, DVec3{0.0}}, 0.12));
  shot.unit_m = factor;
  return shot;
}

const DVec3 kFar{1e5 + 0.003, -0.7e5 + 0.001, 0.4e5 + 0.002};
/// A camera there tells where the viewer stands.
sdf::Field field_far_away() {
  std::string text = hall(kRing, {1.0, kFar});
  text.replace(text.rfind('}'), 1,
               ", \"cameras\": [{\"eye\": " + vector_text(kFar) +
                   ", \"target\": " + vector_text(kFar + DVec3{0, 0, -1}) + "}]}");
  return parsed(text);
}
/// As the loader places it.
Shot far_hall() {
  sdf::Field field = field_far_away();
  const DVec3 origin = scene::recentre(field);
  Shot shot = shot_of(std::move(field));
  shot.eye.position = kFar - origin;
  return shot;
}
/// As it would be without that, by an eye whose coordinates are floats.
Shot far_hall_in_floats() {
  Shot shot = shot_of(field_far_away());
  shot.eye.position = DVec3(Vec3(kFar));
  return shot;
}

Shot inside(double radius) {
  return shot_of(base::concat(R"({"scene": {"type": "sphere", "radius": )", radius,
                              R"(}, "lights": [{"position": [0, 3, 0], "intensity": 9}]})"));
}
Shot inside_a_ball() {
  return inside(2.0);
}
Shot inside_a_pebble() {
  return inside(1e-5);
}
Shot before_a_ball() {
  Shot shot = inside(2.0);
  shot.eye.position.z = 4.0;
  return shot;
}

Shot twice() {
  return shot_of(hall(kRing + ", " + kRing));
}
Shot wide(double fov_deg, bool tilted) {
  Shot shot = shot_of(base::concat(
      R"({"scene": {"type": "plane", "normal": [0, )", tilted ? 0.1 : 0.0,
      R"(, 1], "at": [0, 0, -1], "material": "wall"}, "materials": {"wall": {"emission": [1, 1, 1], "color": 0}}})"));
  shot.grid = foveation::make_uniform_grid(
      foveation::Display{math::symmetric_fov(Degrees{fov_deg}, 1.0), 24, 24});
  return shot;
}

}  // namespace

std::vector<Extreme> fields() {
  return {
      {"AFieldAMillionthOfTheSize", plain_hall, scaled_hall<-6>, geometry_scaled_hall<-6>, 2e-3,
       0.004},
      {"AFieldAMillionTimesTheSize", plain_hall, scaled_hall<6>, geometry_scaled_hall<6>, 2e-3,
       0.004},
      {"AFieldAHundredKilometersAway", plain_hall, far_hall, far_hall_in_floats, 2e-3, 0.004},
      {"AnEyeInASolid", inside_a_ball, inside_a_pebble, before_a_ball, 0.0},
      {"TheSameRingTwice", plain_hall, twice, changed_hall, 1e-4, 0.004},
      {"ATwistOfNothing", plain_hall,
       [] { return wrapped(R"("type": "twist", "deg_per_m": 0, "within_radius": 9)"); },
       changed_hall, 1e-3, 0.004},
      {"ABendOfNothing", plain_hall,
       [] { return wrapped(R"("type": "bend", "deg_per_m": 0, "within_radius": 9)"); },
       changed_hall, 1e-3, 0.004},
      {"AMirrorOfNoAxis", plain_hall,
       [] { return wrapped(R"("type": "mirror", "axes": [0, 0, 0])"); }, changed_hall, 1e-3, 0.004},
      {"ARepetitionOfOne", plain_hall,
       [] { return wrapped(R"("type": "repeat", "period": 1000)"); }, changed_hall, 1e-3, 0.004},
      {"WavesOfNoHeight", plain_hall,
       [] { return wrapped(R"("type": "waves", "amplitude": 0, "wavelength": 1)"); }, changed_hall,
       1e-3, 0.004},
      {"NoiseOfNoHeight", plain_hall,
       [] { return wrapped(R"("type": "noise", "amplitude": 0, "cell": 1)"); }, changed_hall, 1e-3,
       0.004},
      {"ABlendOfNoWidth", plain_hall,
       [] { return shot_of(hall(R"({"type": "union", "smooth": 1e-9, "of": [)" + kRing + "]}")); },
       changed_hall, 1e-3, 0.004},
      {"AFieldOverAHundredSeventyDegrees", [] { return wide(60.0, false); },
       [] { return wide(170.0, false); }, [] { return wide(170.0, true); }, 1e-4, 0.0,
       In::BothModes, 3e-2},
  };
}

}  // namespace macula::stability
