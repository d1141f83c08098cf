// NAME.macula.toml.
#include "server/scene/side_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {

void try_input(Input input) {
  static InputFile file("scene.macula.toml");
  (void)scene::read_side_file(file.write(as_text(input)));
}

std::vector<std::string> seeds() {
  return {
      "meters_per_unit = 0.01\nexposure_ev = 1.0\ntone_curve = \"filmic\"\n"
      "ambient = [0.3, 0.35, 0.4]\nambient_distance_m = 3.0\nenvironment = \"sky.exr\"\n"
      "environment_yaw_deg = 90.0\nenvironment_scale = 1.0\n"
      "[scene_from_stage]\nposition_m = [0.0, 0.0, 2.0]\nyaw_deg = 90.0\n"
      "[[light]]\nkind = \"point\"\nposition_m = [0.0, 3.0, 0.0]\nintensity = [10.0, 10.0, 10.0]\n"
      "[[light]]\nkind = \"spot\"\nposition_m = [0, 3, 0]\ndirection = [0.0, -1.0, 0.0]\n"
      "intensity = [1, 2, 3]\ninner_cone_deg = 20.0\nouter_cone_deg = 30.0\n",
      "[scene_from_stage]\nrotation = [0, 0.6, 0, 0.8]\n", "environment = [1, 2, 3]\n"};
}

}  // namespace macula::fuzz
