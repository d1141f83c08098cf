// The command line of experiments on several ranks.
#include <CLI/CLI.hpp>
#include <memory>

#include "server/app/launch.h"
#include "tests/bench/command_options.h"
#include "tests/bench/commands.h"
#include "tests/bench/scaling.h"

namespace macula::bench {
Run declare_scaling(CLI::App& command, Pace pace) {
  auto options = std::make_shared<ScalingOptions>();
  if (pace == Pace::Quick) make_quick(*options);
  options->launched_by_mpi = server_app::is_launched_by_mpi();
  command.add_option("--kernels", options->kernels, "What to measure")
      ->delimiter(',')
      ->option_text("ao16,lightcuts,culling,sphere (all)");
  command.add_option("--scene", options->scene, "Instead of each kernel's own")
      ->option_text("NAME (atrium, city, nave, columns)");
  add_size(command, "Of each of the two eyes", options->width_px, options->height_px);
  command.add_option("--gaze", options->gazes, "Where the person looks; may be given again")
      ->option_text("YAW,PITCH (0,0 and 18,-12 degrees)");
  command.add_option("--threads", options->threads, "Of each rank that is measured")
      ->check(CLI::Range(1, 1024))
      ->option_text("N (1)");
  command.add_option("--frames", options->frames, "Of a moving head; medians are told")
      ->check(CLI::Range(1, 1000))
      ->option_text("N (3)");
  command.add_option("--rounds", options->rounds, "How often all take their turn")
      ->check(CLI::Range(1, 100))
      ->option_text("N (3)");
  command.add_option("--model-ranks", options->ranks, "Ranks of the modelled cluster")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096))
      ->option_text("N,... (1,2,4,...,256)");
  command.add_option("--model-threads", options->model_threads, "Threads of each of them")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->option_text("N,... (1,16)");
  command.add_option("--latency-us", options->latency_us, "Of a message there")
      ->check(CLI::Range(0.0, 1e6))
      ->option_text("N (5)");
  command.add_option("--gbit", options->gbit_s, "Of each rank's link there, Gbit/s")
      ->check(CLI::Range(1e-3, 1e4))
      ->option_text("N (25)");
  command.add_option("--copy-gb", options->copy_gb_s, "Into and out of messages there, GB/s")
      ->check(CLI::Range(1e-3, 1e3))
      ->option_text("N (2)");
  add_json(command, options->json);
  add_quick(command, "320x356, the gaze in the middle, two frames once");
  command.footer(
      "Alone it measures one rank; under 'mpirun -n N' 1 to N of them, which take turns. "
      "Simulated\n"
      "rows replay the tiles measured on one rank through a cluster where every rank has a link "
      "of\n"
      "its own and what ranks do each for themselves runs on one thread; those with off_measured\n"
      "model this machine itself, against what it measured. path_ms: processor time of the "
      "slowest\n"
      "rank of each pass, and what rank 0 does besides; it holds on a busy machine, too.\n"
      "imbalance: the slowest rank over the mean. comm_bytes: of a frame, over all links.");
  return [options] { return run_scaling(*options); };
}

}  // namespace macula::bench
