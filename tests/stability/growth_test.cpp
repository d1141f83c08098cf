// How errors grow with the size of a scene and its distance from the origin: a table, printed, and
// bounds. README.md in this folder holds a copy.
#include <cmath>
#include <iomanip>
#include <iostream>

#include "server/scene/settle.h"
#include "tests/stability/shot.h"

namespace macula::stability {
namespace {

const std::vector<std::string>& kernel_names() {
  static const std::vector<std::string> names{"ray", "lightcuts", "culling", "brute"};
  return names;
}

void print_row(const char* what, double value, const std::vector<double>& errors) {
  std::cout << what << std::setw(8) << value;
  for (const double error : errors) std::cout << std::setw(12) << std::setprecision(2) << error;
  std::cout << '\n';
}

/// Of every kernel's exact picture.
std::vector<double> errors_of(const Shot& shot) {
  std::vector<double> errors;
  for (const std::string& kernel : kernel_names()) {
    const Picture plain = show(kernel, kernels::Mode::Exact, quiet_shot());
    const Picture got = show(kernel, kernels::Mode::Exact, shot);
    errors.push_back(std::sqrt(difference(plain, got, 1e-4).relative_mse));
  }
  return errors;
}

TEST(ErrorGrowth, IsNoneOverTwelveOrdersOfMagnitudeOfScale) {
  for (int power = -6; power <= 6; ++power) {
    Shot shot = quiet_shot();
    shot.unit_m = std::pow(10.0, power);
    shot.scene = scaled(shot.scene, shot.unit_m);
    const auto errors = errors_of(shot);
    print_row("scale    ", shot.unit_m, errors);
    for (const double error : errors) EXPECT_LT(error, 1e-3);
  }
}

// A float's step at d meters is d 2^-24; what is seen of it grows in proportion. The loader brings
// scenes back from beyond a kilometer, so the last rows are what it saves.
TEST(ErrorGrowth, IsProportionalToTheDistanceThatTheLoaderLeaves) {
  double last = 0.0;
  for (const double distance : {0.0, 1e2, 1e3, 1e4, 1e5, 1e6}) {
    const DVec3 offset = distance * glm::normalize(DVec3{1.0, -0.7, 0.4});
    Shot shot = quiet_shot();
    shot.scene = moved(shot.scene, offset);
    shot.scene.settings.scene_from_stage.position = shot.eye.position = offset;
    const auto left = errors_of(shot);
    print_row("left at  ", distance, left);
    scene::recentre(shot.scene);
    shot.eye.position = offset - shot.scene.settings.file_from_scene_m;
    const auto brought = errors_of(shot);
    print_row("brought  ", distance, brought);
    for (const double error : brought) EXPECT_LT(error, 0.01);
    last = left.front();
  }
  EXPECT_GT(last, 0.1) << "a million meters away floats must fail";
}

}  // namespace
}  // namespace macula::stability
