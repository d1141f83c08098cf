// The command lines of experiments on the stream: codecs, grids, links, the client's warp.
#include "tests/bench/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "tests/bench/codecs.h"
#include "tests/bench/command_options.h"
#include "tests/bench/maps.h"
#include "tests/bench/reprojection.h"
#include "tests/bench/streaming.h"
#include "tests/bench/warp.h"

namespace macula::bench {

Run declare_reprojection(CLI::App& command, Pace pace) {
  auto options = std::make_shared<ReprojectionOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  add_scenes(command, options->scenes, "posts,atrium,city");
  command.add_option("--traces", options->traces, "Recorded heads; else a made-up one")
      ->delimiter(',')
      ->option_text("FILE.csv,...");
  command.add_option("--latencies", options->latencies_ms, "Milliseconds")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 400.0))
      ->option_text("MS,... (0,20,50,100,150,200)");
  command.add_option("--methods", options->methods, "What to measure")
      ->delimiter(',')
      ->check(
          CLI::IsMember({"stale", "rotation", "rotation_guard", "mesh", "mesh_cut",
                         "mesh_cut_splat", "grid", "predicted", "layered", "layered_predicted"}))
      ->option_text(
          "stale,rotation,rotation_guard,mesh,mesh_cut,mesh_cut_splat,grid,predicted,layered,"
          "layered_predicted (all)");
  command.add_option("--source-scales", options->source_scales, "Cells a pixel along an axis")
      ->delimiter(',')
      ->check(CLI::Range(0.25, 4.0))
      ->option_text("N,... (1,1.5)");
  command.add_option("--codec", options->codec, "Frames as rendered, or through the wire's codecs")
      ->check(CLI::IsMember({"none", "default"}))
      ->option_text("none|default (none)");
  command.add_flag("--foveated", options->foveated, "Frames on the server's foveal grid");
  command.add_option("--rate-model", options->rate_model, "How that grid falls off from the gaze")
      ->option_text("NAME (cortical)");
  command.add_option("--material", options->material, "lambert for the bars; full apart from them")
      ->check(CLI::IsMember({"lambert", "full"}))
      ->option_text("lambert|full (lambert)");
  command.add_option("--side", options->side_px, "Of the display, pixels")
      ->check(CLI::Range(32, 4096))
      ->option_text("N (600)");
  command.add_option("--poses", options->poses, "Of a row")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (10)");
  add_threads(command, options->threads);
  add_resumable_json(command, options->json);
  command.add_option("--pictures", options->pictures, "Of the last pose, with their errors")
      ->option_text("FOLDER");
  add_quick(command, "Two scenes, 0, 50 and 100 ms, scale 1, three poses");
  return [options]() -> Result<void> { return run_reprojection(*options); };
}

Run declare_warp(CLI::App& command, Pace) {
  auto options = std::make_shared<WarpCostOptions>();
  add_scenes(command, options->scenes, "posts,atrium,city");
  command.add_option("--grids", options->grids, "Where frames are sampled")
      ->delimiter(',')
      ->option_text("uniform,foveal (both)");
  command.add_option("--methods", options->methods, "What to measure")
      ->delimiter(',')
      ->check(CLI::IsMember({"every_cell", "full", "bilinear", "grid", "rotation"}))
      ->option_text("every_cell,full,bilinear,grid,rotation (all)");
  add_size(command, "Pixels an eye (1440x1600)", options->width_px, options->height_px);
  command.add_option("--fov", options->vertical_fov_deg, "Vertical field of view, degrees")
      ->check(CLI::Range(10.0, 140.0))
      ->option_text("DEG (90)");
  command.add_option("--guard", options->guard_deg, "Degrees rendered beyond it on every side")
      ->check(CLI::Range(0.0, 30.0))
      ->option_text("DEG (8)");
  command.add_option("--repetitions", options->repetitions, "Of which the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (7)");
  add_json(command, options->json);
  return [options]() -> Result<void> { return run_warp_cost(*options); };
}

Run declare_codecs(CLI::App& command, Pace) {
  auto options = std::make_shared<CodecsOptions>();
  add_scenes(command, options->scenes, "atrium");
  command.add_option("--grids", options->grids, "Where frames are sampled")
      ->delimiter(',')
      ->check(CLI::IsMember({"uniform", "foveal"}))
      ->option_text("uniform,foveal (both)");
  add_size(command, "Pixels of a uniform picture (720x800)", options->width_px, options->height_px);
  command.add_option("--frames", options->frames, "Of a sequence")
      ->check(CLI::Range(2, 10000))
      ->option_text("N (24)");
  command
      .add_option("--coarsest", options->coarsest,
                  "Quantiser offset at the rim, minus it at the gaze")
      ->check(CLI::Range(0.0, 20.0))
      ->option_text("N (5)");
  add_json(command, options->json);
  return [options]() -> Result<void> { return run_codecs(*options); };
}

Run declare_maps(CLI::App& command, Pace pace) {
  auto options = std::make_shared<MapsOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  add_scenes(command, options->scenes, "posts,atrium,city");
  command.add_option("--gazes", options->gazes, "Where the eye looks; give it several times")
      ->option_text("YAW,PITCH ... (0,0 15,-8)");
  command
      .add_option("--ramps", options->ramps,
                  "Our maps: full rate to INNER degrees, falling to FLOOR at OUTER")
      ->option_text("INNER,OUTER,FLOOR ... (10,35,0.05 8,30,0.05 3,28,0.12 2,22,0.12)");
  add_size(command, "Pixels of the display (1440x1600)", options->width_px, options->height_px);
  command.add_option("--fov", options->vertical_fov_deg, "Vertical field of view, degrees")
      ->check(CLI::Range(10.0, 140.0))
      ->option_text("DEG (96)");
  add_quick(command, "One scene, one gaze, half the pixels a side");
  add_json(command, options->json);
  return [options]() -> Result<void> { return run_maps(*options); };
}

Run declare_streaming(CLI::App& command, Pace pace) {
  auto options = std::make_shared<StreamingOptions>();
  if (pace == Pace::Quick) make_quick(*options);
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
  add_size(command, "Pixels of an eye's display (720x800)", options->width_px, options->height_px);
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
  add_quick(command, "20 s a link");
  add_json(command, options->json);
  return [options]() -> Result<void> { return run_streaming(*options); };
}

}  // namespace macula::bench
