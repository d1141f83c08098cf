// The command lines of experiments that put the others together.
#include "tests/bench/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "tests/bench/command_options.h"
#include "tests/bench/report_page.h"
#include "tests/bench/tradeoff.h"

namespace macula::bench {

Run declare_tradeoff(CLI::App& command, Pace pace) {
  auto options = std::make_shared<TradeoffOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  command.add_option("--kernels", options->kernels, "What to measure")
      ->delimiter(',')
      ->option_text("ray,lightcuts,culling,sphere (all)");
  add_scenes(command, options->scenes, "three of each kernel's own");
  command
      .add_option("--config", options->configs,
                  "One configuration instead of all, such as \"scale=0.5 samples=4\"; may be "
                  "given again")
      ->option_text("\"NAME=VALUE ...\"");
  command.add_option("--side", options->scale.side_px, "Of the picture, pixels")
      ->check(CLI::Range(32, 4096))
      ->option_text("N (512, quick 160)");
  command
      .add_option("--reference-samples", options->scale.reference_samples,
                  "Paths a pixel of each half-reference")
      ->check(CLI::Range(1, 1 << 16))
      ->option_text("N (256, quick 48)");
  command
      .add_option("--warm-up", options->scale.warm_up,
                  "Frames of a moving head before those measured, for methods that remember")
      ->check(CLI::Range(0, 1000))
      ->option_text("N (16, quick 4)");
  command
      .add_option("--frames", options->scale.frames,
                  "That are measured, the head at rest; two do where one takes long")
      ->check(CLI::Range(2, 1000))
      ->option_text("N (5, quick 3)");
  add_threads(command, options->threads);
  add_references(command, options->references);
  command.add_option("--pictures", options->pictures, "Every configuration's picture, for report")
      ->option_text("FOLDER");
  command.add_option("--ladders", options->ladders, "Write quality ladders, KERNEL.toml each")
      ->option_text("FOLDER");
  add_resumable_json(command, options->json);
  add_quick(command, "Small pictures, without the costliest configurations");
  command.footer(
      "One row a configuration: grid (foveal, uniform), scale, model (a rate model; or a ramp of\n"
      "rates by inner and outer degrees and floor), jpeg and depth (codecs), and the kernel's own\n"
      "knobs; without words it is the server's default. Errors are RMSE of display-linear values\n"
      "in discs of 5, 10 and 25 degrees round the gaze and outside; rmse_ew weighs pixels by what\n"
      "the eye resolves. reference_se is the share of the error that the references' noise may\n"
      "be. on_front: no other row is faster and better (by rmse_ew). uniform_*: what whole\n"
      "pictures of equal time have. Tables below the rows: over how many decades of time foveated\n"
      "rows are better than those; how well errors are estimated on a scene by a ladder made\n"
      "from the others; what the papers say.");
  return [options]() -> Result<void> { return run_tradeoff(*options); };
}

Run declare_report(CLI::App& command, Pace) {
  auto options = std::make_shared<PageOptions>();
  command
      .add_option("reports", options->inputs, "Reports (--json FILE of experiments), or folders")
      ->required()
      ->option_text("FILE|DIR ...");
  command.add_option("--out", options->out, "The page")->option_text("FILE.html (report.html)");
  command.footer(
      "The page needs no other file and nothing from the network: tables beside the papers'\n"
      "numbers, curves with their fronts, pictures under a wipe, the exact commands, the machine,\n"
      "the commit and the scenes' hashes. Pictures are found in the folder that the report names\n"
      "(tradeoff --pictures), or beside it.");
  return [options]() -> Result<void> { return run_report_page(*options); };
}

}  // namespace macula::bench
