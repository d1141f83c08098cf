// The command lines of everyday tools: one picture, a sheet of them, two compared.
#include "tests/bench/commands.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/arguments.h"
#include "tests/bench/command_options.h"
#include "tests/bench/compare.h"
#include "tests/bench/contact_sheet.h"
#include "tests/bench/still.h"

namespace macula::bench {

Run declare_compare(CLI::App& command, Pace) {
  auto options = std::make_shared<CompareOptions>();
  auto gaze = std::make_shared<std::string>();
  command.add_option("REF", options->reference, "The reference: .png (sRGB) or .exr (linear)")
      ->required()
      ->option_text("FILE");
  command.add_option("TEST", options->test, "The picture to judge, of the same size")
      ->required()
      ->option_text("FILE");
  command
      .add_option("--ppd", options->pixels_per_degree,
                  "Pixels per degree of the viewer's eye; a headset has about 20")
      ->check(CLI::Range(0.01, 1000.0))
      ->option_text("N (67.0206)");
  command.add_option("--gaze", *gaze, "Where the eye looks, pixels from the top left (the middle)")
      ->option_text("X,Y");
  command
      .add_option("--exposure", options->exposure_ev,
                  "Brightens .exr pictures before a display shows them")
      ->check(CLI::Range(-64.0, 64.0))
      ->option_text("EV (0)");
  add_json(command, options->json);
  command.add_option("--map", options->map, "Write the FLIP error in false colour")
      ->option_text("FILE.png");
  command.footer(
      "Prints one row. mse, rmse and relmse are in linear light; psnr_db, ssim (luma, border of\n"
      "5 px left out), ew_psnr_db and gp_psnr_db on display values; flip is HDR-FLIP when both\n"
      "pictures are .exr. ew_ and gp_ forgive what the eye cannot resolve away from the gaze.");
  return [options, gaze]() -> Result<void> {
    if (!gaze->empty()) {
      const auto point = parse_pair("--gaze", *gaze);
      if (!point) return base::forward(point);
      options->gaze_px = *point;
    }
    return run_compare(*options);
  };
}

namespace {

/// Options of `still` that are words on the command line and something better in StillOptions.
struct StillWords {
  std::string mode = "exact", material, grid = "uniform", camera, size, gaze;
  std::vector<std::string> planes;
};

struct PlaneName {
  const char* name;
  StillPlane plane;
};
constexpr PlaneName kPlaneNames[] = {
    {"depth", StillPlane::Depth},   {"normal", StillPlane::Normal},
    {"albedo", StillPlane::Albedo}, {"id", StillPlane::Id},
    {"rate", StillPlane::Rate},     {"samples", StillPlane::Samples},
    {"steps", StillPlane::Steps},   {"variance", StillPlane::Variance},
};

Result<StillOptions> still_options(StillOptions options, const StillWords& words) {
  options.mode = words.mode == "fast" ? StillMode::Fast : StillMode::Exact;
  options.grid = words.grid == "foveal" ? StillGrid::Foveal : StillGrid::Uniform;
  if (words.material == "lambert") options.material = StillMaterial::Lambert;
  for (const std::string& word : words.planes) {
    options.planes.push_back(std::ranges::find(kPlaneNames, word, &PlaneName::name)->plane);
  }
  if (words.camera.find(';') == std::string::npos) {
    options.camera_name = words.camera;
  } else {
    const auto camera = parse_camera("--camera", words.camera);
    if (!camera) return base::forward(camera);
    options.camera = *camera;
  }
  if (!words.size.empty()) {
    const auto size = parse_size("--size", words.size);
    if (!size) return base::forward(size);
    options.width_px = size->width_px;
    options.height_px = size->height_px;
  }
  if (!words.gaze.empty()) {
    const auto gaze = parse_gaze("--gaze", words.gaze);
    if (!gaze) return base::forward(gaze);
    options.gaze = *gaze;
  }
  return options;
}

void add_still_picture(CLI::App& command, StillOptions& options, StillWords& words) {
  std::vector<std::string> planes;
  for (const PlaneName& entry : kPlaneNames) planes.emplace_back(entry.name);
  command.add_option("--scene", options.scene, "Built-in scene or scene file")
      ->required()
      ->option_text("NAME|FILE");
  command.add_option("--out", options.out, "The picture: linear .exr or tone-mapped .png")
      ->required()
      ->option_text("FILE");
  command.add_option("--camera", words.camera, "In the scene file's own units (its first camera)")
      ->option_text("NAME|\"ex,ey,ez;tx,ty,tz;ux,uy,uz;vfov_deg\"");
  command.add_option("--size", words.size, "Pixels (512x512)")->option_text("WxH");
  command.add_option("--time", options.time_s, "Seconds on the clock of a scene that moves")
      ->check(CLI::Range(-1e6, 1e6))
      ->option_text("SECONDS (0)");
  command
      .add_option("--gaze", words.gaze, "Degrees to the right and upwards of the view axis (0,0)")
      ->option_text("YAW,PITCH");
  command.add_option("--grid", words.grid, "Where the picture is sampled")
      ->check(CLI::IsMember({"uniform", "foveal"}))
      ->option_text("uniform|foveal (uniform)");
  command.add_option("--aov", words.planes, "Further planes, with commas between")
      ->delimiter(',')
      ->check(CLI::IsMember(planes))
      ->option_text("depth,normal,albedo,id,rate,samples,steps,variance");
  add_json(command, options.json);
}

void add_still_method(CLI::App& command, StillOptions& options, StillWords& words) {
  command.add_option("--kernel", options.kernel, "How light is computed")
      ->option_text("NAME (auto)");
  command.add_option("--mode", words.mode, "Unbiased, or with every shortcut")
      ->check(CLI::IsMember({"exact", "fast"}))
      ->option_text("exact|fast (exact)");
  command.add_option("--lspp", options.light_samples, "Area-light samples per primary sample")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (8)");
  command.add_flag("--perceived-lights", options.perceived_lights,
                   "Kernel lightcuts, mode fast: as many as the eye would see, up to 48");
  command.add_option("--knobs", options.knobs, "Settings of the kernel; a wrong one lists them")
      ->option_text("\"name=value ...\"");
  command.add_option("--spp", options.samples_per_cell, "Primary samples per cell")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (1)");
  command.add_option("--material", words.material, "Replace every material by its base colour")
      ->check(CLI::IsMember({"lambert"}))
      ->option_text("lambert");
  command.add_option("--bounces", options.bounces, "Diffuse bounces of indirect light")
      ->check(CLI::Range(0, 1))
      ->option_text("0|1 (1 for kernel culling, else 0)");
  command.add_option("--rate-model", options.rate_model, "How sampling falls off from the gaze")
      ->option_text("NAME (cortical)");
  command.add_option("--seed", options.seed, "Of every random number")->option_text("N (1)");
  add_threads(command, options.threads);
}

}  // namespace

Run declare_still(CLI::App& command, Pace) {
  auto options = std::make_shared<StillOptions>();
  auto words = std::make_shared<StillWords>();
  add_still_picture(command, *options, *words);
  add_still_method(command, *options, *words);
  return [options, words]() -> Result<void> {
    const auto parsed = still_options(*options, *words);
    if (!parsed) return base::forward(parsed);
    return run_still(*parsed);
  };
}

Run declare_contact_sheet(CLI::App& command, Pace) {
  auto options = std::make_shared<ContactSheetOptions>();
  command.add_option("--scenes", options->scenes, "Names or files, with commas between")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (every built-in scene)");
  command.add_option("--out", options->out, "The sheet")->required()->option_text("FILE.png");
  command.add_option("--singles", options->singles, "Write each picture by itself too")
      ->check(CLI::ExistingDirectory)
      ->option_text("DIR");
  add_size(command, "Of each picture, pixels (480x320)", options->width_px, options->height_px);
  command.add_option("--columns", options->columns, "Pictures in a row")
      ->check(CLI::Range(1, 64))
      ->option_text("N (4)");
  command.add_option("--spp", options->samples_per_cell, "Primary samples per cell")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (16)");
  command.add_option("--lspp", options->light_samples, "Area-light samples per primary sample")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (4)");
  add_threads(command, options->threads);
  add_json(command, options->json);
  command.footer(
      "Each scene by its first camera. The figures are CPU times of the whole process;\n"
      "resident_mb counts what earlier scenes left behind, so give one scene to measure it.");
  return [options]() -> Result<void> { return run_contact_sheet(*options); };
}

}  // namespace macula::bench
