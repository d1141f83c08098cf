// The command lines of experiments on kernels and what they stand on.
#include "tests/bench/commands.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "shared/base/text.h"
#include "tests/bench/command_options.h"
#include "tests/bench/culling.h"
#include "tests/bench/culling_method.h"
#include "tests/bench/light_tree.h"
#include "tests/bench/lightcuts.h"
#include "tests/bench/motion.h"
#include "tests/bench/ray.h"
#include "tests/bench/sphere.h"

namespace macula::bench {

Run declare_culling(CLI::App& command, Pace pace) {
  auto options = std::make_shared<CullingOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  add_scenes(command, options->scenes, "nave,atrium,city");
  command.add_option("--motions", options->motions, "What moves")
      ->delimiter(',')
      ->check(CLI::IsMember({"static", "light", "object", "both"}))
      ->option_text("static,light,object,both (all)");
  command.add_option("--methods", options->methods, "What to measure, see below")
      ->delimiter(',')
      ->option_text(pace == Pace::Quick ? "NAME,... (flc,flc_fast,flc_rays,fir,power,tree,all_vpls)"
                                        : "NAME,... (all)");
  command.add_option("--kept", options->kept, "Virtual lights that are kept")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("K,... (256,512,1024,2048,4096)");
  command
      .add_option("--rivals-kept", options->rivals_kept,
                  "By fir and power; an eighth by flc_rays and tree, which ask in every pixel")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20))
      ->option_text(pace == Pace::Quick ? "K,... (768,2048)" : "K,... (as --kept)");
  command
      .add_option("--knobs", options->knobs,
                  "Settings of the kernel, turned for every method; a wrong one lists them")
      ->option_text("\"name=value ...\"");
  command.add_option("--side", options->side_px, "Of the picture, pixels")
      ->check(CLI::Range(32, 4096))
      ->option_text("N (1024)");
  command
      .add_option("--judged", options->judged,
                  "Pixels that are judged, drawn by chance: so many in the fovea, and outside")
      ->check(CLI::Range(16, 1 << 20))
      ->option_text("N (1024)");
  command
      .add_option("--reference-samples", options->reference_samples,
                  "Paths for each of them, of each half-reference")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (4096)");
  command.add_option("--warm-up", options->warm_up, "Frames before those that are timed")
      ->check(CLI::Range(0, 1000))
      ->option_text("N (8)");
  command.add_option("--frames", options->frames, "That are timed; the last is judged")
      ->check(CLI::Range(2, 1000))
      ->option_text("N (4)");
  command.add_option("--seed", options->seed, "Of all that is drawn: another tells what is chance")
      ->check(CLI::Range(1, 1 << 20))
      ->option_text("N (1)");
  add_threads(command, options->threads);
  add_references(command, options->references);
  command.add_option("--pictures", options->pictures, "Judged pictures")->option_text("FOLDER");
  add_resumable_json(command, options->json);
  add_quick(command, "512x512, both, 1024 lights, 2 x 256 pixels of 2048 paths, 2 frames after 2");
  std::string methods;
  for (const CullingMethod& method : culling_methods())
    methods += base::concat("  ", method.name, std::string(18 - method.name.size(), ' '),
                            method.summary, "\n");
  command.footer(
      "Every surface is diffuse, one lamp hangs above the eye, a red ball before it. Errors are\n"
      "those of exposed light, clipped at 1, at pixels drawn by chance, against paths of one "
      "bounce;\n"
      "rmse_se_pct is what that choice and the paths' noise do to rmse_in150 (reference_se_pct: "
      "the\n"
      "noise alone). from_vpls_ and brightness_error_pct are told against every virtual light.\n"
      "all_vpls is timed at a 64th of the pixels, flc_no_classes at a sixteenth; their time is "
      "that\n"
      "of the whole picture. A second table compares at equal CPU time: the curves of fir, power,\n"
      "flc_rays and tree over what they keep are read at each method's time, straight in "
      "logarithms\n"
      "between points; beyond the last, variance is taken to fall on, which favours them. Above 1 "
      "the\n"
      "method is nearer. Methods:\n" +
      methods);
  return [options]() -> Result<void> { return run_culling(*options); };
}

Run declare_motion(CLI::App& command, Pace) {
  auto options = std::make_shared<MotionOptions>();
  command.add_flag("--quick", options->quick, "Small scenes, a few repetitions");
  add_json(command, options->json);
  command.footer(
      "One row a scene that moves in one way; CPU milliseconds of all threads for one moment:\n"
      "pose, transforms with the top level or refits, the surface table, the light list, all of\n"
      "it by a SceneTimeline, and the triangles built anew for comparison.");
  return [options]() -> Result<void> { return run_motion(*options); };
}

Run declare_lightcuts(CLI::App& command, Pace) {
  auto options = std::make_shared<LightcutsOptions>();
  command
      .add_option("--scenes,--scene", options->scenes,
                  "Built-in scenes or scene files, with lights; NAME@CAMERA: seen by that one;\n"
                  "NAME-vpl: and 120,000 virtual ones")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (cornell-lights@stage,study,room,yard)");
  command.add_option("--gazes", options->gazes_deg, "Degrees to the right of the view axis")
      ->delimiter(',')
      ->check(CLI::Range(-40.0, 40.0))
      ->option_text("N,... (0,20)");
  command.add_option("--methods", options->methods, "What to measure (all)")
      ->delimiter(',')
      ->option_text("sl,sl_denoised,sl_as,paper_no_reuse,paper,paper_denoised,ours_exact,ours");
  command.add_flag("--alphas", options->alphas,
                   "The paper's Table 4 and Figure 7: its method at five thresholds");
  command.add_option("--frames", options->frames, "Timed and judged, each with a seed of its own")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (4)");
  command
      .add_option("--warm-up", options->warm_up,
                  "Frames of a swaying head before those, for methods that remember")
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
  add_references(command, options->references);
  command.add_flag_callback(
      "--no-gloss", [options] { options->gloss = kernels::lightcuts::Gloss::No; },
      "Direct light alone: without what glossy surfaces reflect");
  command.add_flag("--stereo", options->stereo,
                   "Pairs of eyes: cost and error of the second, lit by itself and by what the\n"
                   "first has found; methods sl_denoised,paper,paper_denoised,ours");
  command.add_flag(
      "--quick", options->quick,
      "360x425, --gazes 0, one frame (of pairs: four) after 4, one pass of 64 nodes;\n"
      "curves end where they have reached every method's time and error, or at 32\n"
      "samples; sl_denoised with 1, 4, 8 and 32; paper_denoised if named; stages of one\n"
      "tile in four");
  add_threads(command, options->threads);
  command
      .add_option("--pictures", options->pictures,
                  "Maps and pictures of every method, and labelled sheets: errors.png, maps.png,\n"
                  "stages.png and, of --alphas, alphas.png")
      ->option_text("FOLDER");
  add_json(command, options->json);
  command.footer(
      "sl asks as many lights in every pixel; its rows are the curve that gains and speeds are\n"
      "read from. lspp is the size that cuts may have; a low-resolution picture comes on top.\n"
      "tree, cut and sample (walks) are measured apart, of one thread on the same points; sample\n"
      "less what other pixels had drawn; glossy (rays that glossy surfaces send on) is apart, "
      "too;\n"
      "shade is what remains: all other rays, materials, what lights send, low resolution; trace\n"
      "is wall time within visibility queries. msed and mseg: mse of the pixels that show matt\n"
      "and glossy surfaces.\n"
      "mse is of display-linear values, relmse of radiance; both may be negative where they lie\n"
      "below the noise of the references. gain: the baseline's error at equal time over the\n"
      "method's; speed: its time at equal error in F25; plain_gain: against sl, whatever the\n"
      "baseline. Each is read off the baseline at its best, between points that were measured;\n"
      "not_read: how many of these lie beyond a curve that was measured, where nothing\n"
      "is told. ours is held against sl_denoised, which has the same denoiser and memory.");
  return [options]() -> Result<void> { return run_lightcuts(*options); };
}

Run declare_light_tree(CLI::App& command, Pace) {
  auto options = std::make_shared<LightTreeOptions>();
  command.add_flag("--quick", options->quick, "A tenth of the repetitions");
  add_json(command, options->json);
  command.footer(
      "One row a kind and number of moving lights and an instruction set. CPU milliseconds of a\n"
      "moment: joints and lights moved, then the tree made anew. Nanoseconds of a walk from the\n"
      "root to a leaf, against one that weighs one node after another; both by turns.");
  return [options]() -> Result<void> { return run_light_tree(*options); };
}

namespace {

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

}  // namespace

Run declare_sphere(CLI::App& command, Pace pace) {
  auto options = std::make_shared<SphereOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  add_sphere_axes(command, *options);
  add_size(command, "Pixels an eye (2468x2740)", options->width_px, options->height_px);
  command.add_option("--frames", options->frames, "Moving frames of a row")
      ->check(CLI::Range(1, 10000))
      ->option_text("N (16)");
  command.add_option("--key-frames", options->key_frames, "Of them compared with method full")
      ->check(CLI::Range(1, 100))
      ->option_text("N (2)");
  add_threads(command, options->threads);
  command.add_option("--pictures", options->pictures, "Pictures and steps of every row")
      ->option_text("FOLDER");
  add_resumable_json(command, options->json);
  add_quick(command, "1234x1370, three foveae, 1 and 16 samples, refresh 1 and 1/4");
  return [options]() -> Result<void> { return run_sphere(*options); };
}

Run declare_ray(CLI::App& command, Pace) {
  auto options = std::make_shared<RayOptions>();
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
  add_size(command, "Pixels (1182x1464)", options->width_px, options->height_px);
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
  command.add_flag("--paper-literal", options->paper_literal,
                   "Every form as the paper prints it, Phong's lobes among them");
  command.add_flag("--phong", options->phong, "Phong's lobes alone");
  command.add_flag("--post-filter", options->post_filter,
                   "Resampled cells take their neighbours' light");
  command.add_option("--seed", options->seed, "Of every random number")->option_text("N (1)");
  add_threads(command, options->threads);
  add_references(command, options->references);
  command.add_option("--pictures", options->pictures, "Write the last key frame's pictures here")
      ->option_text("DIR");
  add_json(command, options->json);
  return [options]() -> Result<void> { return run_ray(*options); };
}

}  // namespace macula::bench
