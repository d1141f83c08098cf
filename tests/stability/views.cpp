// Views: fields of view up to a half-space, pictures of one cell, a row or a column, eyes that look
// nowhere in the picture, frame numbers and seeds at their ends.
#include <cmath>
#include <limits>

#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

Shot in_the_box(double fov_deg, int width, int height) {
  Shot shot;
  shot.scene = glowing_box();
  const foveation::Display display{math::symmetric_fov(Degrees{fov_deg}, 1.0), width, height};
  shot.grid = foveation::make_uniform_grid(display);
  return shot;
}
/// One wall is missing.
Shot in_the_open_box(double fov_deg, int width, int height) {
  Shot shot = in_the_box(fov_deg, width, height);
  shot.scene.meshes.erase(shot.scene.meshes.begin());
  shot.scene.instances.pop_back();
  return shot;
}
/// The same shape of picture of a wall across the view that glows: depth 1, radiance 1.
Shot before_a_wall(double fov_deg, int width, int height) {
  Shot shot = in_the_box(fov_deg, width, height);
  shot.scene.meshes.resize(1), shot.scene.instances.resize(1);
  shot.scene.meshes[0].positions = {
      {-1e4F, -1e4F, -1}, {1e4F, -1e4F, -1}, {1e4F, 1e4F, -1}, {-1e4F, 1e4F, -1}};
  return shot;
}
template <int kTenthsOfDegrees, int kWidth, int kHeight>
Shot wall() {
  return before_a_wall(kTenthsOfDegrees / 10.0, kWidth, kHeight);
}
template <int kTenthsOfDegrees, int kWidth, int kHeight>
Shot tilted_wall() {
  Shot shot = wall<kTenthsOfDegrees, kWidth, kHeight>();
  shot.scene.meshes[0].positions[0].z -= 10.0F;
  return shot;
}

/// By an eye that sees well within 5 degrees and a tenth as well beyond 20.
Shot looking(const Vec3& gaze) {
  Shot shot = quiet_shot();
  shot.rate = {foveation::RateCurve::Ray, Degrees{5.0}, Degrees{20.0}, 0.1};
  shot.gaze.direction = glm::normalize(gaze);
  return shot;
}
Shot looking_beside_the_picture() {
  return looking({5, 0, -1});
}
Shot looking_behind() {
  return looking({0, 0, 1});
}
Shot looking_up() {
  return looking({0, 1, 0});
}

template <foveation::RateCurve kCurve, int kInner, int kOuter, int kFloorInPercent>
Shot rated() {
  Shot shot = quiet_shot();
  shot.rate = {kCurve, Degrees{kInner}, Degrees{kOuter}, kFloorInPercent / 100.0};
  return shot;
}
constexpr auto kRamp = foveation::RateCurve::Ray;
Shot everywhere() {
  return rated<foveation::RateCurve::Uniform, 0, 0, 100>();
}

Shot with_a_narrow_fovea() {
  Shot shot = rated<kRamp, 0, 1, 10>();
  shot.rate.outer = Degrees{1e-9};
  return shot;
}
Shot with_a_narrow_rim() {
  Shot shot = rated<kRamp, 10, 11, 10>();
  shot.rate.outer = Degrees{10.0 + 1e-9};
  return shot;
}
template <Shot (*kMake)()>
Shot without_a_lamp() {
  Shot shot = kMake();
  shot.scene.lights.pop_back();
  return shot;
}

template <std::uint64_t kFrame>
Shot from_frame() {
  Shot shot = everywhere();
  shot.frame = kFrame;
  return shot;
}
Shot of_the_last_seed() {
  Shot shot = everywhere();
  shot.seed = std::numeric_limits<std::uint64_t>::max();
  return shot;
}

/// Relative MSE of a picture of mode Fast against one of other random numbers: within 25 degrees of
/// the gaze many samples are hardly smoothed.
constexpr double kOtherNoise = 0.02;

}  // namespace

std::vector<Extreme> views() {
  constexpr std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();
  constexpr std::uint64_t kHalf = std::numeric_limits<std::uint32_t>::max();
  return {
      {"AHundredSeventyNineDegrees", wall<600, 24, 24>, wall<1790, 24, 24>,
       tilted_wall<1790, 24, 24>},
      {"AThousandthOfADegree", wall<600, 24, 24>, [] { return before_a_wall(1e-3, 24, 24); },
       [] { return in_the_open_box(1e-3, 24, 24); }},
      {"OneCell", wall<600, 1, 1>, wall<1790, 1, 1>, tilted_wall<1790, 1, 1>},
      {"OneColumn", wall<600, 1, 64>, wall<1700, 1, 64>, tilted_wall<1700, 1, 64>},
      {"OneRow", wall<600, 64, 1>, wall<1700, 64, 1>, tilted_wall<1700, 64, 1>},
      {"AGazeStraightUp", looking_beside_the_picture, looking_up,
       without_a_lamp<looking_beside_the_picture>, 1e-3, 0.0, In::BothModes, 1e-4, kOtherNoise},
      {"AGazeBehindTheHead", looking_beside_the_picture, looking_behind,
       without_a_lamp<looking_beside_the_picture>, 1e-3, 0.0, In::BothModes, 1e-4, kOtherNoise},
      {"FrameNumbersThatOutgrow32Bits", everywhere, from_frame<kHalf - 1>,
       without_a_lamp<everywhere>, 1e-3, 0.0, In::BothModes, 1e-4, kOtherNoise},
      {"TheLastFrameNumbers", everywhere, from_frame<kLast - 1>, without_a_lamp<everywhere>, 1e-3,
       0.0, In::BothModes, 1e-4, kOtherNoise},
      {"TheLastSeed", everywhere, of_the_last_seed, without_a_lamp<everywhere>, 1e-3, 0.0,
       In::BothModes, 1e-4, kOtherNoise},
      {"AFoveaOfNoWidth", with_a_narrow_fovea, rated<kRamp, 0, 0, 10>,
       without_a_lamp<with_a_narrow_fovea>},
      {"AFoveaWithoutARim", with_a_narrow_rim, rated<kRamp, 10, 10, 10>,
       without_a_lamp<with_a_narrow_rim>},
      {"AFoveaAllAround", everywhere, rated<kRamp, 180, 400, 10>, without_a_lamp<everywhere>},
      {"ARateThatNeverFalls", everywhere, rated<kRamp, 5, 10, 100>, without_a_lamp<everywhere>},
  };
}

}  // namespace macula::stability
