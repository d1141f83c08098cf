// A shot: a small scene and the view of it, and what a kernel makes of both through its public
// interface.
#pragma once

#include <string>

#include "tests/conformance/test_scenes.h"

namespace macula::stability {

struct Shot {
  scene::Scene scene;
  Pose eye;
  PixelGrid grid;
  Gaze gaze;
  foveation::RateModel rate;
  std::uint64_t frame = 0;  ///< number of the first frame
  std::uint64_t seed = 1;
  double unit_m = 1.0;  ///< what a meter of the plain scene measures in this one
  float gain =
      1.0F;  ///< radiance here is that of the plain scene times this; the exposure is for it
};

/// Picture and depth of a shot, in the units of the plain scene.
struct Picture {
  image::Plane<Rgb> radiance;
  image::Plane<float> depth_m;
  std::uint64_t non_finite_samples = 0;  ///< that the kernel itself replaced by black
};

/// Exact: one sample a cell at its middle, direct light alone. Fast: three frames of an eye at
/// rest, with everything that the kernel remembers and foveates.
Picture show(const std::string& kernel, kernels::Mode mode, const Shot& shot);

/// How two pictures of the same grid differ.
struct Difference {
  double relative_mse =
      0.0;  ///< against the square of the first, floored at a hundredth of its mean's
  double strange_depths =
      0.0;             ///< share of cells whose depth differs by more than `depth_error` of it
  bool finite = true;  ///< of the second
};
Difference difference(const Picture& wanted, const Picture& got, double depth_error);

/// A room open to the viewer at the origin: floor, wall, glossy ball, two lamps, no other light: a
/// picture without noise.
scene::Scene quiet_room();
/// quiet_room() seen by 32 x 32 cells of 60 degrees.
Shot quiet_shot();
/// A closed box of radiance 1 about the origin, black itself.
scene::Scene glowing_box();
/// Everything of a scene moved by an offset in meters.
scene::Scene moved(scene::Scene scene, const DVec3& offset);
/// A scene `factor` times as large that looks the same.
scene::Scene scaled(scene::Scene scene, double factor);

}  // namespace macula::stability
