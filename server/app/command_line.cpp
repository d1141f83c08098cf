#include "server/app/command_line.h"

#include <CLI/CLI.hpp>
#include <string>

#include "server/kernels/registry.h"

namespace macula::server_app {
namespace {

constexpr const char* kExamples = R"(Examples:
  macula-server                                 a built-in scene for clients on this machine
  macula-server --scene model.gltf --explain    what a scene needs, without serving it
  macula-server pair                            let a client of another machine in, by a code
  macula-server --bind tcp://*:7788             serve clients elsewhere
  macula-server clients list                    who may connect; clients revoke NAME takes it back
  macula-server --target-ms 25                  hold a frame time by the kernel's quality ladder
  mpirun -n 4 --hostfile hosts macula-server    one frame by several machines
  macula-server --quality 4 --color-quality 75  spend less on rays and on bytes
)";

// Each option says its form and, in parentheses, its default; the library's own forms read badly.

std::string kernel_names() {
  std::string names = "auto";
  for (const kernels::KernelEntry& entry : kernels::kernel_table())
    names += "|" + std::string(entry.name);
  return names + " (auto)";
}

void declare_scene(CLI::App& app, Options& options) {
  app.option_defaults()->group("Scene and kernel");
  app.add_option(
         "--scene", options.scene,
         "Built-in scene or a file: .gltf .glb .obj .ply .stl .off .fbx .dae .3ds .sdf.json")
      ->option_text("NAME|FILE (cornell)");
  app.add_flag("--list-scenes", options.list_scenes, "List the built-in scenes and end");
  app.add_option("--kernel", options.kernel, "What makes the picture; auto: what suits the scene")
      ->option_text(kernel_names());
  app.add_option("--knobs", options.knobs,
                 "Of the kernel, such as \"budget=0.2 k_min=0.1\" of ray with --reuse; an unknown "
                 "name answers with the list")
      ->option_text("\"NAME=VALUE ...\"");
  app.add_flag("--explain", options.explain,
               "Print the kernel and passes chosen, with reasons, and end");
  app.add_option("--area-samples", options.area_samples,
                 "Samples of emissive surfaces a primary sample")
      ->option_text("N (8)");
  app.add_option("--ambient-samples", options.ambient_samples,
                 "Samples of ambient light a primary sample")
      ->option_text("N (4)");
  app.add_flag("--reuse", options.reuse,
               "Kernel ray: trace as densely as --rate-model asks, remember the other cells");
  app.add_flag("--perceived-lights", options.perceived_lights,
               "Kernel lightcuts: as many lights as the eye would see the difference, up to 48");
  app.add_option("--bounced-rays", options.bounced_rays,
                 "Kernel lightcuts: rays from the lamps for light that surfaces reflect once, each "
                 "a virtual light at most, such as 120000; 0: none. Anew whenever the scene moves")
      ->option_text("N (0)")
      ->check(CLI::Range(0, 1'000'000));
}

void declare_quality(CLI::App& app, Options& options) {
  app.option_defaults()->group("Speed against quality");
  app.add_option("--target-ms", options.target_ms,
                 "Render time to hold by lowering quality; samples and knobs set by hand stay: "
                 "then the periphery alone gives way")
      ->option_text("MS");
  app.add_option("--quality", options.quality,
                 "0 (fast) to 10 (good) on the kernel's measured ladder; with --target-ms at most")
      ->option_text("NUMBER");
  app.add_option("--max-error", options.max_error,
                 "RMSE of display values from 0 to 1, as the eye weighs it, that quality never "
                 "goes beyond; without --target-ms no better than that")
      ->option_text("NUMBER");
  app.add_option("--ladders", options.ladders, "Quality ladders, KERNEL.toml each")
      ->option_text("DIR (those installed)");
  app.add_option("--threads", options.threads, "Render threads of each process; 0: every core")
      ->option_text("N (0)");
}

void declare_views(CLI::App& app, Options& options) {
  app.option_defaults()->group("Foveation and latency");
  app.add_option("--rate-model", options.rate_model,
                 "How sampling falls off from the gaze; an unknown name lists them")
      ->option_text("NAME (cortical)");
  app.add_option("--oversampling", options.oversampling, "Cells per display pixel at the gaze")
      ->option_text("1|1.5|2|3|4 (1)");
  app.add_option("--guard-deg", options.guard_deg,
                 "Rendered beyond the display on every side, for turns of the head, 0 to 15")
      ->option_text("DEGREES (4)");
  app.add_option("--predict-ms", options.predict_ms,
                 "Render at most this far ahead of the head, for as long as frames take, 0 to 200; "
                 "0 also keeps the guard band as it is set")
      ->option_text("MS (0)");
  app.add_option("--view-cell-cm", options.view_cell_cm,
                 "With --predict-ms: also send what near surfaces hide along their outlines, for "
                 "eyes that move up to so far until a frame is seen, 0 to 20; 0: do not")
      ->option_text("CM (5)");
}

void declare_wire(CLI::App& app, Options& options) {
  app.option_defaults()->group("Clients and the wire");
  app.add_option("--bind", options.bind, "Where to serve; port 0 takes a free one")
      ->option_text("ENDPOINT (tcp://127.0.0.1:7788)");
  app.add_option("--keys", options.keys, "Key folder")
      ->option_text("DIR ($XDG_CONFIG_HOME/macula)");
  app.add_option("--codec", options.codec, "Colour; auto: the best that both ends know")
      ->option_text("auto|jpeg|h264|lossless (auto)");
  app.add_option("--color-quality", options.color_quality,
                 "Quality of colour on JPEG's scale, 1 to 100; H.264's quantiser is 56 - 0.4 of it")
      ->option_text("N (85)");
  app.add_option("--age-ms", options.age_ms,
                 "How old a frame may be when it is shown: slower links get fewer bytes; 0: full "
                 "quality on any link")
      ->option_text("MS (100)");
}

void declare_ranks(CLI::App& app, Options& options) {
  app.option_defaults()->group("Under mpirun");
  app.add_option("--balance", options.balance, "Who runs which tile")
      ->option_text("predicted|stripes|dynamic (predicted)");
  app.add_option("--rank-timeout-ms", options.rank_timeout_ms,
                 "How long others wait for a rank before the server ends")
      ->option_text("MS (5000)");
}

void declare_records(CLI::App& app, Options& options) {
  app.option_defaults()->group("What is told and kept");
  app.add_option("--report", options.report,
                 "Folder for frames.csv, each frame's stage times and bytes, and report.json")
      ->option_text("DIR");
  app.add_option("--metrics", options.metrics,
                 "Where Prometheus may read rates and times, such as 127.0.0.1:9464; plain HTTP "
                 "for whoever reaches it")
      ->option_text("ADDRESS:PORT");
  app.add_option("--record", options.record,
                 "Keep what arrives and when, to make the same frames again")
      ->option_text("FILE");
  app.add_option("--replay", options.replay,
                 "Make a recording's frames again, print each one's bytes and digest, and end")
      ->option_text("FILE");
  app.add_flag("--verbose", options.verbose, "Log sessions and, every 5 s, rates and stage times");
}

}  // namespace

void declare_options(CLI::App& app, Options& options) {
  app.footer(kExamples);
  app.set_help_flag("-h,--help", "Print this text and end");
  app.set_version_flag("--version", "macula-server " MACULA_VERSION);
  app.add_option("--config", options.config, "Settings (TOML); options here win over them")
      ->option_text("FILE");
  declare_scene(app, options);
  declare_quality(app, options);
  declare_views(app, options);
  declare_wire(app, options);
  declare_ranks(app, options);
  declare_records(app, options);
  app.option_defaults()->group("Options");
}

}  // namespace macula::server_app
