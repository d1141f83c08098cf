// macula-bench EXPERIMENT [options]: the command line of every experiment, and nothing else of it.
// Exit status: 0 done, 2 bad arguments or input, 1 anything else.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "shared/base/text.h"
#include "tests/bench/arguments.h"
#include "tests/bench/codecs.h"
#include "tests/bench/compare.h"
#include "tests/bench/contact_sheet.h"
#include "tests/bench/culling.h"
#include "tests/bench/culling_method.h"
#include "tests/bench/light_tree.h"
#include "tests/bench/lightcuts.h"
#include "tests/bench/maps.h"
#include "tests/bench/motion.h"
#include "tests/bench/ray.h"
#include "tests/bench/reprojection.h"
#include "tests/bench/sphere.h"
#include "tests/bench/still.h"
#include "tests/bench/streaming.h"
#include "tests/bench/warp.h"

namespace macula::bench {
namespace {

/// What to do once the command line has been read.
using Run = std::function<Result<void>()>;

struct Experiment {
  const char* name;
  const char* summary;
  /// Adds its options to its subcommand.
  Run (*declare)(CLI::App& command);
};

Run declare_compare(CLI::App& command) {
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
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
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
  command.add_option("--json", options.json, "Write a report")->option_text("FILE.json");
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
  command.add_option("--threads", options.threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
}

Run declare_still(CLI::App& command) {
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

Run declare_contact_sheet(CLI::App& command) {
  auto options = std::make_shared<ContactSheetOptions>();
  auto size = std::make_shared<std::string>();
  command.add_option("--scenes", options->scenes, "Names or files, with commas between")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (every built-in scene)");
  command.add_option("--out", options->out, "The sheet")->required()->option_text("FILE.png");
  command.add_option("--singles", options->singles, "Write each picture by itself too")
      ->check(CLI::ExistingDirectory)
      ->option_text("DIR");
  command.add_option("--size", *size, "Of each picture, pixels (480x320)")->option_text("WxH");
  command.add_option("--columns", options->columns, "Pictures in a row")
      ->check(CLI::Range(1, 64))
      ->option_text("N (4)");
  command.add_option("--spp", options->samples_per_cell, "Primary samples per cell")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (16)");
  command.add_option("--lspp", options->light_samples, "Area-light samples per primary sample")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (4)");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  command.footer(
      "Each scene by its first camera. The figures are CPU times of the whole process;\n"
      "resident_mb counts what earlier scenes left behind, so give one scene to measure it.");
  return [options, size]() -> Result<void> {
    if (!size->empty()) {
      const auto parsed = parse_size("--size", *size);
      if (!parsed) return base::forward(parsed);
      options->width_px = parsed->width_px;
      options->height_px = parsed->height_px;
    }
    return run_contact_sheet(*options);
  };
}

Run declare_culling(CLI::App& command) {
  auto options = std::make_shared<CullingOptions>();
  auto quick = std::make_shared<bool>(false);
  command.add_option("--scenes", options->scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (nave,atrium,city)");
  command.add_option("--motions", options->motions, "What moves")
      ->delimiter(',')
      ->check(CLI::IsMember({"static", "light", "object", "both"}))
      ->option_text("static,light,object,both (all)");
  command.add_option("--methods", options->methods, "What to measure (all; see below)")
      ->delimiter(',')
      ->option_text("NAME,...");
  command.add_option("--kept", options->kept, "Virtual lights that are kept")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("K,... (256,512,1024,2048,4096)");
  command.add_option("--side", options->side_px, "Of the picture, pixels")
      ->check(CLI::Range(32, 4096))
      ->option_text("N (1024)");
  command
      .add_option("--reference-samples", options->reference_samples,
                  "Paths a pixel of each half-reference")
      ->check(CLI::Range(1, 1 << 16))
      ->option_text("N (16)");
  command.add_option("--warm-up", options->warm_up, "Frames before those that are timed")
      ->check(CLI::Range(0, 1000))
      ->option_text("N (8)");
  command.add_option("--frames", options->frames, "That are timed; the last is judged")
      ->check(CLI::Range(2, 1000))
      ->option_text("N (4)");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--references", options->references, "Where half-references are kept")
      ->option_text("DIR (~/.cache/macula-bench)");
  command.add_option("--pictures", options->pictures, "Judged pictures")->option_text("FOLDER");
  command.add_option("--json", options->json, "Report; rows it holds already are kept")
      ->option_text("FILE.json");
  command.add_flag("--quick", *quick,
                   "512x512, static and both, 256 and 1024 lights, 8 paths, 3 frames after 4");
  std::string methods;
  for (const CullingMethod& method : culling_methods())
    methods += base::concat("  ", method.name, std::string(18 - method.name.size(), ' '),
                            method.summary, "\n");
  command.footer(
      "Every surface is diffuse, one lamp hangs above the eye, a red ball before it. Errors are\n"
      "those of exposed light, clipped at 1, against paths of one bounce; from_vpls_ against "
      "every\n"
      "virtual light at a sixteenth of the pixels, where brightness_error_pct is told too.\n"
      "all_vpls is rendered there alone and its time is that of the whole picture. Methods:\n" +
      methods);
  return [options, quick, &command]() -> Result<void> {
    if (*quick) {
      const CullingOptions given = *options;
      make_quick(*options);
      if (command.count("--motions") > 0) options->motions = given.motions;
      if (command.count("--kept") > 0) options->kept = given.kept;
      if (command.count("--side") > 0) options->side_px = given.side_px;
      if (command.count("--reference-samples") > 0)
        options->reference_samples = given.reference_samples;
      if (command.count("--warm-up") > 0) options->warm_up = given.warm_up;
      if (command.count("--frames") > 0) options->frames = given.frames;
    }
    return run_culling(*options);
  };
}

Run declare_motion(CLI::App& command) {
  auto options = std::make_shared<MotionOptions>();
  command.add_flag("--quick", options->quick, "Small scenes, a few repetitions");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  command.footer(
      "One row a scene that moves in one way; CPU milliseconds of all threads for one moment:\n"
      "pose, transforms with the top level or refits, the surface table, the light list, all of\n"
      "it by a SceneTimeline, and the triangles built anew for comparison.");
  return [options]() -> Result<void> { return run_motion(*options); };
}

Run declare_lightcuts(CLI::App& command) {
  auto options = std::make_shared<LightcutsOptions>();
  command.add_option("--scene", options->scene, "Built-in scene or scene file, with lights")
      ->required()
      ->option_text("NAME|FILE");
  command.add_option("--frames", options->frames, "Timed and judged, each with a seed of its own")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (4)");
  command.add_option("--warm-up", options->warm_up, "Frames before those, for ours")
      ->check(CLI::Range(0, 1000))
      ->option_text("N (16)");
  command
      .add_option("--reference-nodes", options->reference_nodes,
                  "Of the cuts of the half-references")
      ->check(CLI::Range(1, 1 << 14))
      ->option_text("N (256)");
  command.add_option("--reference-passes", options->reference_passes, "Of each half-reference")
      ->check(CLI::Range(1, 1 << 14))
      ->option_text("N (4)");
  command.add_flag("--quick", options->quick, "360x425, one frame after 6, one pass of 96 nodes");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--pictures", options->pictures, "Maps and pictures of every method")
      ->option_text("FOLDER");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  command.footer(
      "sl asks as many lights in every pixel; its rows are the curve that gains and speeds are\n"
      "read from. lspp is the size that cuts may have; a low-resolution picture comes on top.\n"
      "mse is of display-linear values, relmse of radiance; both may be negative where they lie\n"
      "below the noise of the references.");
  return [options]() -> Result<void> { return run_lightcuts(*options); };
}

Run declare_light_tree(CLI::App& command) {
  auto options = std::make_shared<LightTreeOptions>();
  command.add_flag("--quick", options->quick, "A tenth of the repetitions");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  command.footer(
      "One row a kind and number of moving lights and an instruction set. CPU milliseconds of a\n"
      "moment: joints and lights moved, then the tree made anew. Nanoseconds of a walk from the\n"
      "root to a leaf, against one that weighs one node after another; both by turns.");
  return [options]() -> Result<void> { return run_light_tree(*options); };
}

void add_sphere_axes(CLI::App& command, SphereOptions& options) {
  command
      .add_option("--scenes", options.scenes,
                  "Built-in distance fields, files of them, or primitives-N: N primitives that\n"
                  "cover about the same whatever N")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (temple,columns,primitives)");
  command.add_option("--methods", options.methods, "What to measure")
      ->delimiter(',')
      ->option_text("full,full_best,ipr_paper,ipr,fipr_paper,fipr (all)");
  command.add_option("--fovea", options.fovea_deg, "Radii of the fovea, degrees")
      ->delimiter(',')
      ->check(CLI::Range(0.5, 60.0))
      ->option_text("DEG,... (2.5,5,7.5,10,12.5,15)");
  command.add_option("--ssaa", options.samples, "Samples a pixel")
      ->delimiter(',')
      ->check(CLI::Range(1, 16))
      ->option_text("N,... (1,2,4,8,16)");
  command.add_option("--refresh", options.refresh, "Frames between refreshes outside the fovea")
      ->delimiter(',')
      ->check(CLI::IsMember({1, 2, 4}))
      ->option_text("1,2,4 (all)");
  command.add_option("--edges", options.edges, "What counts as an edge")
      ->delimiter(',')
      ->check(CLI::IsMember({"depth", "albedo", "shaded"}))
      ->option_text("depth,albedo,shaded (depth)");
  command.add_option("--views", options.views, "Eyes")
      ->delimiter(',')
      ->check(CLI::Range(1, 2))
      ->option_text("1,2 (1)");
}

Run declare_sphere(CLI::App& command) {
  auto options = std::make_shared<SphereOptions>();
  auto size = std::make_shared<std::string>();
  auto quick = std::make_shared<bool>(false);
  add_sphere_axes(command, *options);
  command.add_option("--size", *size, "Pixels an eye (2468x2740)")->option_text("WxH");
  command.add_option("--frames", options->frames, "Moving frames of a row")
      ->check(CLI::Range(1, 10000))
      ->option_text("N (16)");
  command.add_option("--key-frames", options->key_frames, "Of them compared with method full")
      ->check(CLI::Range(1, 100))
      ->option_text("N (2)");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--pictures", options->pictures, "Pictures and steps of every row")
      ->option_text("FOLDER");
  command.add_option("--json", options->json, "Report; rows it holds already are kept")
      ->option_text("FILE.json");
  command.add_flag("--quick", *quick,
                   "1234x1370, three foveae, 1 and 16 samples, refresh 1 and 1/4");
  return [options, size, quick, &command]() -> Result<void> {
    if (*quick) {
      const SphereOptions given = *options;
      make_quick(*options);
      if (command.count("--fovea") > 0) options->fovea_deg = given.fovea_deg;
      if (command.count("--ssaa") > 0) options->samples = given.samples;
      if (command.count("--refresh") > 0) options->refresh = given.refresh;
      if (command.count("--key-frames") > 0) options->key_frames = given.key_frames;
    }
    if (!size->empty()) {
      const auto parsed = parse_size("--size", *size);
      if (!parsed) return base::forward(parsed);
      options->width_px = parsed->width_px, options->height_px = parsed->height_px;
    }
    return run_sphere(*options);
  };
}

Run declare_ray(CLI::App& command) {
  auto options = std::make_shared<RayOptions>();
  auto size = std::make_shared<std::string>();
  command.add_option("--scene", options->scene, "Built-in scene or scene file")
      ->required()
      ->option_text("NAME|FILE");
  command.add_option("--lighting", options->lightings, "Which of the paper's, with commas between")
      ->delimiter(',')
      ->option_text("point,area8,ao16");
  command.add_option("--preset", options->presets, "Foveal regions, with commas between")
      ->delimiter(',')
      ->option_text("small,medium,large,full");
  command.add_option("--grid", options->grids, "Where pictures are sampled")
      ->delimiter(',')
      ->check(CLI::IsMember({"uniform", "foveal"}))
      ->option_text("uniform,foveal");
  command.add_option("--size", *size, "Pixels (1182x1464)")->option_text("WxH");
  command.add_option("--frames", options->frames, "Of the moving path, at 75 Hz")
      ->check(CLI::Range(10, 100'000))
      ->option_text("N (48)");
  command.add_option("--key-frames", options->key_frames, "Frames that are judged")
      ->check(CLI::Range(1, 64))
      ->option_text("N (4)");
  command
      .add_option("--reference-samples", options->reference_samples,
                  "Primary samples a pixel of each half-reference")
      ->check(CLI::Range(1, 1 << 16))
      ->option_text("N (64)");
  command.add_flag("--quick", options->quick,
                   "591x732, 24 frames, preset medium on the raster, two key frames");
  command.add_flag("--paper-literal", options->paper_literal, "Every form as the paper prints it");
  command.add_flag("--post-filter", options->post_filter,
                   "Resampled cells take their neighbours' light");
  command.add_option("--seed", options->seed, "Of every random number")->option_text("N (1)");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--references", options->references, "Where half-references are kept")
      ->option_text("DIR (~/.cache/macula-bench)");
  command.add_option("--pictures", options->pictures, "Write the last key frame's pictures here")
      ->option_text("DIR");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  return [options, size]() -> Result<void> {
    if (!size->empty()) {
      const auto pixels = parse_size("--size", *size);
      if (!pixels) return base::forward(pixels);
      options->width_px = pixels->width_px, options->height_px = pixels->height_px;
    }
    return run_ray(*options);
  };
}

Run declare_reprojection(CLI::App& command) {
  auto options = std::make_shared<ReprojectionOptions>();
  auto quick = std::make_shared<bool>(false);
  command.add_option("--scenes", options->scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (posts,atrium,city)");
  command.add_option("--traces", options->traces, "Recorded heads; else a made-up one")
      ->delimiter(',')
      ->option_text("FILE.csv,...");
  command.add_option("--latencies", options->latencies_ms, "Milliseconds")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 400.0))
      ->option_text("MS,... (0,20,50,100,150,200)");
  command.add_option("--methods", options->methods, "What to measure")
      ->delimiter(',')
      ->check(CLI::IsMember({"stale", "rotation", "rotation_guard", "mesh", "mesh_cut",
                             "mesh_cut_splat", "grid", "predicted"}))
      ->option_text(
          "stale,rotation,rotation_guard,mesh,mesh_cut,mesh_cut_splat,grid,predicted (all)");
  command.add_option("--source-scales", options->source_scales, "Cells a pixel along an axis")
      ->delimiter(',')
      ->check(CLI::Range(0.25, 4.0))
      ->option_text("N,... (1,1.5)");
  command.add_option("--material", options->material, "lambert for the bars; full apart from them")
      ->check(CLI::IsMember({"lambert", "full"}))
      ->option_text("lambert|full (lambert)");
  command.add_option("--side", options->side_px, "Of the display, pixels")
      ->check(CLI::Range(32, 4096))
      ->option_text("N (600)");
  command.add_option("--poses", options->poses, "Of a row")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (10)");
  command.add_option("--threads", options->threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
  command.add_option("--json", options->json, "Report; rows it holds already are kept")
      ->option_text("FILE.json");
  command.add_option("--pictures", options->pictures, "Of the last pose, with their errors")
      ->option_text("FOLDER");
  command.add_flag("--quick", *quick, "Two scenes, 0, 50 and 100 ms, scale 1, three poses");
  return [options, quick, &command]() -> Result<void> {
    if (*quick) {
      const ReprojectionOptions given = *options;
      make_quick(*options);
      if (command.count("--scenes") > 0) options->scenes = given.scenes;
      if (command.count("--latencies") > 0) options->latencies_ms = given.latencies_ms;
      if (command.count("--source-scales") > 0) options->source_scales = given.source_scales;
      if (command.count("--poses") > 0) options->poses = given.poses;
    }
    return run_reprojection(*options);
  };
}

Run declare_warp(CLI::App& command) {
  auto options = std::make_shared<WarpCostOptions>();
  auto size = std::make_shared<std::string>();
  command.add_option("--scenes", options->scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (posts,atrium,city)");
  command.add_option("--grids", options->grids, "Where frames are sampled")
      ->delimiter(',')
      ->option_text("uniform,foveal (both)");
  command.add_option("--methods", options->methods, "What to measure")
      ->delimiter(',')
      ->check(CLI::IsMember({"every_cell", "full", "bilinear", "grid", "rotation"}))
      ->option_text("every_cell,full,bilinear,grid,rotation (all)");
  command.add_option("--size", *size, "Pixels an eye (1440x1600)")->option_text("WxH");
  command.add_option("--fov", options->vertical_fov_deg, "Vertical field of view, degrees")
      ->check(CLI::Range(10.0, 140.0))
      ->option_text("DEG (90)");
  command.add_option("--guard", options->guard_deg, "Degrees rendered beyond it on every side")
      ->check(CLI::Range(0.0, 30.0))
      ->option_text("DEG (8)");
  command.add_option("--repetitions", options->repetitions, "Of which the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (7)");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  return [options, size]() -> Result<void> {
    if (!size->empty()) {
      const auto pixels = parse_size("--size", *size);
      if (!pixels) return base::forward(pixels);
      options->width_px = pixels->width_px, options->height_px = pixels->height_px;
    }
    return run_warp_cost(*options);
  };
}

Run declare_codecs(CLI::App& command) {
  auto options = std::make_shared<CodecsOptions>();
  auto size = std::make_shared<std::string>();
  command.add_option("--scenes", options->scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (atrium)");
  command.add_option("--grids", options->grids, "Where frames are sampled")
      ->delimiter(',')
      ->check(CLI::IsMember({"uniform", "foveal"}))
      ->option_text("uniform,foveal (both)");
  command.add_option("--size", *size, "Pixels of a uniform picture (720x800)")->option_text("WxH");
  command.add_option("--frames", options->frames, "Of a sequence")
      ->check(CLI::Range(2, 10000))
      ->option_text("N (24)");
  command.add_option("--coarsest", options->coarsest, "Quantiser offset at the rim, minus it at the gaze")
      ->check(CLI::Range(0.0, 20.0))
      ->option_text("N (5)");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  return [options, size]() -> Result<void> {
    if (!size->empty()) {
      const auto pixels = parse_size("--size", *size);
      if (!pixels) return base::forward(pixels);
      options->width_px = pixels->width_px, options->height_px = pixels->height_px;
    }
    return run_codecs(*options);
  };
}

Run declare_maps(CLI::App& command) {
  auto options = std::make_shared<MapsOptions>();
  auto size = std::make_shared<std::string>();
  auto quick = std::make_shared<bool>(false);
  command.add_option("--scenes", options->scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (posts,atrium,city)");
  command.add_option("--gazes", options->gazes, "Where the eye looks; give it several times")
      ->option_text("YAW,PITCH ... (0,0 15,-8)");
  command.add_option("--size", *size, "Pixels of the display (1440x1600)")->option_text("WxH");
  command.add_option("--fov", options->vertical_fov_deg, "Vertical field of view, degrees")
      ->check(CLI::Range(10.0, 140.0))
      ->option_text("DEG (96)");
  command.add_flag("--quick", *quick, "One scene, one gaze, half the pixels a side");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  return [options, size, quick]() -> Result<void> {
    if (*quick) make_quick(*options);
    if (!size->empty()) {
      const auto pixels = parse_size("--size", *size);
      if (!pixels) return base::forward(pixels);
      options->width_px = pixels->width_px, options->height_px = pixels->height_px;
    }
    return run_maps(*options);
  };
}

Run declare_streaming(CLI::App& command) {
  auto options = std::make_shared<StreamingOptions>();
  auto size = std::make_shared<std::string>();
  auto quick = std::make_shared<bool>(false);
  command.add_option("--source", options->source, "Canned pictures, or a scene by its kernel")
      ->option_text("pattern|NAME|FILE (pattern)");
  command.add_option("--links", options->links, "What lies between server and viewer")
      ->delimiter(',')
      ->check(CLI::IsMember(link_names()))
      ->option_text("NAME,... (all)");
  command
      .add_option("--network", options->network_folder, "A row for each recorded link in a folder")
      ->option_text("DIR");
  command.add_option("--trace", options->trace, "Head and gaze (a made-up viewer)")
      ->option_text("FILE.csv");
  command.add_option("--codec", options->codec, "Colour")
      ->check(CLI::IsMember({"auto", "jpeg", "h264", "lossless"}))
      ->option_text("auto|jpeg|h264|lossless (auto)");
  command.add_option("--effort", options->effort, "Of H.264")
      ->check(CLI::IsMember({"ultrafast", "superfast"}))
      ->option_text("ultrafast|superfast (ultrafast)");
  command.add_option("--grid", options->grid, "Where frames are sampled")
      ->check(CLI::IsMember({"foveal", "uniform"}))
      ->option_text("foveal|uniform (foveal)");
  command.add_option("--size", *size, "Pixels of an eye's display (720x800)")->option_text("WxH");
  command.add_option("--seconds", options->seconds, "Of every link")
      ->check(CLI::Range(1.0, 36000.0))
      ->option_text("S (60)");
  command.add_option("--age-ms", options->age_ms, "The server's goal for ages; 0: none")
      ->check(CLI::Range(0.0, 10000.0))
      ->option_text("MS (100)");
  command.add_option("--quality", options->quality, "Of colour, on JPEG's scale")
      ->check(CLI::Range(1, 100))
      ->option_text("N (85)");
  command
      .add_option("--frame-kb", options->frame_kb,
                  "JPEG of the quality that gives so many kB a frame")
      ->check(CLI::Range(1, 10000))
      ->option_text("N");
  command.add_option("--noise", options->noise_levels, "Grain of the pattern, in levels of 255")
      ->check(CLI::Range(0.0, 64.0))
      ->option_text("N (0)");
  command.add_flag("--quick", *quick, "20 s a link");
  command.add_option("--json", options->json, "Write a report")->option_text("FILE.json");
  return [options, size, quick]() -> Result<void> {
    if (*quick) make_quick(*options);
    if (!size->empty()) {
      const auto pixels = parse_size("--size", *size);
      if (!pixels) return base::forward(pixels);
      options->width_px = pixels->width_px, options->height_px = pixels->height_px;
    }
    return run_streaming(*options);
  };
}

constexpr Experiment kExperiments[] = {
    {"still", "One view of a scene for one eye, as a picture", declare_still},
    {"compare", "Every metric on two pictures", declare_compare},
    {"codecs", "Bytes, quality and cost of colour codecs on frames of a kernel", declare_codecs},
    {"contact-sheet", "A small picture of every scene, with its figures", declare_contact_sheet},
    {"culling", "Kernel culling against its baselines, error and time", declare_culling},
    {"light-tree", "What a tree over moving lights costs, and walks down it", declare_light_tree},
    {"lightcuts", "Methods of kernel lightcuts at equal time and equal error", declare_lightcuts},
    {"maps", "Bytes that foveation maps need for the same picture, to the eye", declare_maps},
    {"motion", "What a moment of a moving scene costs, part by part", declare_motion},
    {"sphere", "Foveated sphere tracing against plain, speed and quality", declare_sphere},
    {"ray", "Foveated ray tracing against the full renderer, along a path", declare_ray},
    {"reprojection", "What each way of hiding latency is worth", declare_reprojection},
    {"streaming", "The stream over links that misbehave: ages, bytes, quality", declare_streaming},
    {"warp", "What the client's warp costs", declare_warp},
};

int complain(const Error& error) {
  std::fprintf(stderr, "macula-bench: %s\n", error.message().c_str());
  return error.exit_status();
}

/// The first word must be an experiment or ask for help.
Result<void> check_experiment(int argc, const char* const* argv) {
  const std::string_view word = argc < 2 ? "" : argv[1];
  if (word == "-h" || word == "--help") return {};
  std::string names;
  for (const Experiment& entry : kExperiments) {
    if (entry.name == word) return {};
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  const std::string what =
      word.empty() ? "which experiment?" : "unknown experiment '" + std::string(word) + "'";
  return base::bad_input(what, {}, "there are: " + names + "; macula-bench --help explains");
}

int run(int argc, const char* const* argv) {
  if (const auto known = check_experiment(argc, argv); !known) return complain(known.error());
  CLI::App app{"Pictures, measurements and comparisons of the Macula renderer.", "macula-bench"};
  app.require_subcommand(1);
  app.get_formatter()->label("SUBCOMMAND", "EXPERIMENT");
  app.footer("macula-bench EXPERIMENT --help explains one of them.");
  std::vector<std::pair<CLI::App*, Run>> commands;
  for (const Experiment& entry : kExperiments) {
    CLI::App* command = app.add_subcommand(entry.name, entry.summary);
    command->group("Experiments");
    commands.emplace_back(command, entry.declare(*command));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return complain({error.what(), {}, "macula-bench --help lists what is allowed"});
  }
  for (const auto& [command, start] : commands) {
    if (!command->parsed()) continue;
    if (const auto done = start(); !done) return complain(done.error());
  }
  if (std::fflush(stdout) != 0)
    return complain({"standard output cannot be written", {}, {}, base::ErrorKind::Runtime});
  return 0;
}

}  // namespace
}  // namespace macula::bench

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error to report, not a way to die
  try {
    return macula::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "macula-bench: unexpected: %s\n", error.what());
  } catch (...) {
    std::fputs("macula-bench: unexpected failure\n", stderr);
  }
  return 1;
}
