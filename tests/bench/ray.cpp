#include "tests/bench/ray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "server/kernels/ray/ray_kernel.h"
#include "server/scene/load.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flicker.h"
#include "tests/bench/progress.h"
#include "tests/bench/ray_quality.h"
#include "tests/bench/ray_raw.h"
#include "tests/bench/ray_reference.h"
#include "tests/bench/ray_setting.h"
#include "tests/bench/report.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using base::forward;
using kernels::ray::Config;
using kernels::ray::RayKernel;

constexpr double kRefresh_hz = 75.0;  // the DK2's
constexpr int kWarmUp = 8;            ///< frames that are not measured
constexpr int kStillFrames = 24;      ///< half of them measured for flicker

/// What one run was asked to compare.
struct Case {
  std::string lighting_name, preset, grid_name;
  foveation::RateModel model;
};

struct Spent {
  double cpu_ms = 0.0, wall_ms = 0.0;
  std::uint64_t rays = 0;
  int frames = 0;

  void add(const Lap& lap, const kernels::FrameReport& report) {
    cpu_ms += lap.cpu_ms, wall_ms += lap.wall_ms;
    rays += report.primary_rays + report.shadow_rays;
    ++frames;
  }
  double mean_cpu_ms() const { return cpu_ms / std::max(frames, 1); }
  double mean_wall_ms() const { return wall_ms / std::max(frames, 1); }
  double mean_rays() const { return static_cast<double>(rays) / std::max(frames, 1); }
};

Config config_of(const RaySetting& setting, const RayOptions& options) {
  Config config;
  config.area_light_samples = 8;
  config.ambient_samples = setting.lighting == PaperLighting::Ao16 ? 16 : 0;
  config.materials = setting.materials;
  if (options.paper_literal) config.foveated = kernels::ray::paper_literal();
  if (options.post_filter) config.foveated.post_filter = kernels::ray::PostFilter::On;
  return config;
}

/// One row: a case run along the path.
class RowRun {
 public:
  RowRun(const RaySetting& setting, const Case& test, const RayOptions& options,
         scheduling::TileScheduler& scheduler, Progress& progress)
      : setting_(setting),
        case_(test),
        options_(options),
        scheduler_(scheduler),
        progress_(progress),
        book_(setting, options.references, options.reference_samples),
        full_(config_of(setting, options)),
        foveated_(with_method(config_of(setting, options))),
        raster_(foveation::make_uniform_grid(setting.display)),
        grid_(test.grid_name == "foveal"
                  ? foveation::make_foveal_grid(setting.display, gaze_, test.model)
                  : raster_) {}

  Fields run() {
    for (int frame = 0; frame < options_.frames; ++frame) {
      const Pose pose = setting_.pose_at(frame / kRefresh_hz);
      const Plane<Rgb> seen = render_foveated(pose, frame);
      if (is_key(frame)) judge(pose, frame, seen);
      progress_.advance();
    }
    measure_flicker();
    return fields();
  }
  /// The references' own share in the errors of a row.
  std::string standard_errors() const {
    return base::concat(case_.lighting_name, " ", case_.preset, " ", case_.grid_name,
                        ": standard error of rmse from the references, F10 ",
                        percent(foveated_errors_.f10), " ring ", percent(foveated_errors_.ring),
                        " full F10 ", percent(full_errors_.f10));
  }

 private:
  static Config with_method(Config config) {
    config.foveated.method = kernels::ray::Method::Foveated;
    return config;
  }
  static std::string percent(const CrossError& error) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f %%", 100.0 * error.relative_standard_error());
    return text;
  }

  /// Key frames at even distances, the last frame among them.
  bool is_key(int frame) const {
    const int step = std::max((options_.frames - kWarmUp) / options_.key_frames, 1);
    return frame >= kWarmUp && (options_.frames - 1 - frame) % step == 0 &&
           (options_.frames - 1 - frame) / step < options_.key_frames;
  }

  struct Made {
    Plane<Rgb> radiance;
    kernels::FrameReport report;
    Lap lap;
  };
  Made render(const RayKernel& kernel, const Pose& pose, const PixelGrid& grid,
              const foveation::Display& display, int frame, kernels::History& history) {
    const kernels::View view{pose, grid, gaze_, setting_.tone};
    const FoveationMap map({{grid, gaze_, display.pixel_tangent()}}, case_.model);
    Stopwatch watch;
    Made made;
    made.report = kernel.render({{&view, 1}, map, static_cast<std::uint64_t>(frame), options_.seed},
                                *setting_.scene, history, scheduler_, buffers_);
    made.lap = watch.lap();
    made.radiance = buffers_.views.front().radiance;
    return made;
  }

  Plane<Rgb> render_foveated(const Pose& pose, int frame) {
    Made made = render(foveated_, pose, grid_, setting_.display, frame, history_);
    if (frame >= kWarmUp) {
      foveated_spent_.add(made.lap, made.report);
      stages_ += made.report;
    }
    return std::move(made.radiance);
  }

  void judge(const Pose& pose, int frame, const Plane<Rgb>& seen) {
    const Judge judge(setting_, gaze_, book_.at(pose, scheduler_));
    kernels::History none;
    const Made full = render(full_, pose, raster_, setting_.display, frame, none);
    full_spent_.add(full.lap, full.report);
    const kernels::View view{pose, raster_, gaze_, setting_.tone};
    raw_mrays_.push_back(raw_mrays_per_s(setting_, view, scheduler_));
    const Plane<Rgb> shown = on_raster(seen, grid_, setting_.display);
    judge.add_errors(full.radiance, full_errors_);
    judge.add_errors(shown, foveated_errors_);
    judge.add_errors(uniform_at_equal_cost(pose, frame), uniform_errors_);
    gp_full_.push_back(judge.gp_psnr_db(full.radiance));
    gp_foveated_.push_back(judge.gp_psnr_db(shown));
    psnr_foveated_.push_back(judge.psnr_db(shown));
    psnr_support_.push_back(judge.psnr_db(support_alone(pose, frame)));
    if (!options_.pictures.empty() && frame + 1 == options_.frames) {
      write_pictures(judge, full.radiance, shown);
    }
  }

  /// Fewer, larger pixels everywhere for the CPU time of the foveated frames so far.
  Plane<Rgb> uniform_at_equal_cost(const Pose& pose, int frame) {
    const double share = foveated_spent_.mean_cpu_ms() / full_spent_.mean_cpu_ms();
    return coarse(pose, frame, std::sqrt(std::min(share, 1.0)));
  }
  Plane<Rgb> support_alone(const Pose& pose, int frame) {
    return coarse(pose, frame, 1.0 / kernels::ray::FoveatedConfig{}.support_spacing);
  }
  Plane<Rgb> coarse(const Pose& pose, int frame, double scale) {
    foveation::Display small = setting_.display;
    small.width_px = std::max(static_cast<int>(std::lround(scale * small.width_px)), 1);
    small.height_px = std::max(static_cast<int>(std::lround(scale * small.height_px)), 1);
    const PixelGrid grid = foveation::make_uniform_grid(small);
    kernels::History none;
    return on_raster(render(full_, pose, grid, small, frame, none).radiance, grid,
                     setting_.display);
  }

  /// Nothing moves any more: whatever changes is the method's own.
  void measure_flicker() {
    const Pose pose = setting_.pose_at((options_.frames - 1) / kRefresh_hz);
    metrics::FlickerMeter meter;
    Plane<float> nothing(setting_.display.width_px, setting_.display.height_px, 0.0F);
    for (int k = 0; k < kStillFrames; ++k) {
      const Made made =
          render(foveated_, pose, grid_, setting_.display, options_.frames + k, history_);
      if (k >= kStillFrames / 2) {
        meter.add(nothing, metrics::luma(display_encoded(
                               setting_.tone, on_raster(made.radiance, grid_, setting_.display))));
      }
      progress_.advance();
    }
    flicker_ = meter.rms();
  }

  void write_pictures(const Judge& judge, const Plane<Rgb>& full, const Plane<Rgb>& foveated) {
    const std::filesystem::path folder(options_.pictures);
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    const std::string stem =
        base::concat(case_.lighting_name, "-", case_.preset, "-", case_.grid_name, "-");
    const auto write = [&](const char* name, const Plane<Rgb>& radiance) {
      Plane<Rgb8> codes;
      image::encode(setting_.tone, radiance, codes);
      if (const auto done = image::write_png((folder / (stem + name)).string(), codes); !done) {
        std::fprintf(stderr, "macula-bench: %s\n", done.error().message().c_str());
      }
    };
    write("full.png", full);
    write("foveated.png", foveated);
    write("reference.png", judge.reference());
  }

  static double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
  }

  Fields fields() const {
    const auto per_frame = [&](double ms) { return ms / std::max(foveated_spent_.frames, 1); };
    const double cpu_full = full_spent_.mean_cpu_ms(), cpu_foveated = foveated_spent_.mean_cpu_ms();
    return {{"scene", std::filesystem::path(options_.scene).stem().string()},
            {"lighting", case_.lighting_name},
            {"preset", case_.preset},
            {"grid", case_.grid_name},
            {"width_px", std::int64_t{setting_.display.width_px}},
            {"height_px", std::int64_t{setting_.display.height_px}},
            {"rays_full", full_spent_.mean_rays()},
            {"rays_foveated", foveated_spent_.mean_rays()},
            {"mrays_s_full", full_spent_.mean_rays() / (1e3 * cpu_full)},
            {"mrays_s_raw", mean(raw_mrays_)},
            {"cpu_full_ms", cpu_full},
            {"cpu_foveated_ms", cpu_foveated},
            {"wall_full_ms", full_spent_.mean_wall_ms()},
            {"wall_foveated_ms", foveated_spent_.mean_wall_ms()},
            {"reproject_ms", per_frame(stages_.reproject_ms + stages_.mask_ms)},
            {"trace_ms", per_frame(stages_.sample_ms)},
            {"cache_ms", per_frame(stages_.cache_ms)},
            {"merge_ms", per_frame(stages_.merge_ms)},
            {"post_ms", per_frame(stages_.post_ms)},
            {"speedup", cpu_full / cpu_foveated},
            {"rmse_f10_full", full_errors_.f10.rmse()},
            {"rmse_f10_foveated", foveated_errors_.f10.rmse()},
            {"rmse_ring_full", full_errors_.ring.rmse()},
            {"rmse_ring_foveated", foveated_errors_.ring.rmse()},
            {"rmse_ring_uniform", uniform_errors_.ring.rmse()},
            {"rmse_out25_foveated", foveated_errors_.out25.rmse()},
            {"gp_psnr_full_db", mean(gp_full_)},
            {"gp_psnr_foveated_db", mean(gp_foveated_)},
            {"psnr_support_db", mean(psnr_support_)},
            {"psnr_foveated_db", mean(psnr_foveated_)},
            {"flicker_t1", flicker_}};
  }

  const RaySetting& setting_;
  const Case& case_;
  const RayOptions& options_;
  scheduling::TileScheduler& scheduler_;
  Progress& progress_;
  const Gaze gaze_;  ///< straight ahead, as in the paper's benchmark
  ReferenceBook book_;
  RayKernel full_, foveated_;
  PixelGrid raster_, grid_;
  kernels::History history_;
  kernels::FrameBuffers buffers_;
  Spent full_spent_, foveated_spent_;
  kernels::FrameReport stages_;
  RegionErrors full_errors_, foveated_errors_, uniform_errors_;
  std::vector<double> raw_mrays_, gp_full_, gp_foveated_, psnr_support_, psnr_foveated_;
  double flicker_ = 0.0;
};

RayOptions quickened(RayOptions options) {
  if (!options.quick) return options;
  options.width_px = 591, options.height_px = 732;
  options.frames = 24, options.key_frames = 2, options.reference_samples = 16;
  options.presets = {"medium"}, options.grids = {"uniform"};
  return options;
}

shading::MaterialModel materials_of(const RayOptions& options) {
  const bool phong = options.phong || options.paper_literal;
  return phong ? shading::MaterialModel::Phong : shading::MaterialModel::AsInScene;
}

Fields effective(const RayOptions& options) {
  return {{"scene", options.scene},
          {"frames", std::int64_t{options.frames}},
          {"key_frames", std::int64_t{options.key_frames}},
          {"reference_samples", std::int64_t{2 * options.reference_samples}},
          {"paper_literal", options.paper_literal},
          {"phong", materials_of(options) == shading::MaterialModel::Phong},
          {"post_filter", options.post_filter},
          {"seed", static_cast<std::int64_t>(options.seed)}};
}

Result<std::vector<Case>> list_cases(const RayOptions& options) {
  std::vector<Case> cases;
  for (const std::string& lighting : options.lightings) {
    if (const auto known = find_lighting(lighting); !known) return forward(known);
    for (const std::string& preset : options.presets) {
      const auto model = foveation::find_rate_model("ray-" + preset);
      if (!model) {
        return base::bad_input("unknown preset '" + preset + "'", "--preset",
                               "allowed: small, medium, large, full");
      }
      for (const std::string& grid : options.grids) {
        // At rate 1 a foveal grid is the raster itself.
        if (grid == "foveal" && preset == "full") continue;
        cases.push_back({lighting, preset, grid, *model});
      }
    }
  }
  return cases;
}

}  // namespace

Result<void> run_ray(const RayOptions& asked) {
  const RayOptions options = quickened(asked);
  const auto cases = list_cases(options);
  if (!cases) return forward(cases);
  const auto scene = scene::load_scene(options.scene);
  if (!scene) return forward(scene);
  scheduling::TileScheduler scheduler(options.threads);
  Report report{"ray", effective(options), {}};
  std::optional<RaySetting> setting;
  std::string lit_by;
  Progress progress("ray",
                    static_cast<std::int64_t>(cases->size()) * (options.frames + kStillFrames));
  for (const Case& test : *cases) {
    if (lit_by != test.lighting_name) {
      setting.reset();
      auto made = RaySetting::make(*scene, *find_lighting(test.lighting_name),
                                   materials_of(options), options.width_px, options.height_px);
      if (!made) return forward(made);
      setting.emplace(std::move(*made));
      lit_by = test.lighting_name;
    }
    RowRun row(*setting, test, options, scheduler, progress);
    report.rows.push_back(row.run());
    std::fprintf(stderr, "%s\n", row.standard_errors().c_str());
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
