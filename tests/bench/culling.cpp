#include "tests/bench/culling.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "server/kernels/culling/knobs.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/guide.h"
#include "server/kernels/ray/tile.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flicker.h"
#include "tests/bench/culling_method.h"
#include "tests/bench/culling_setting.h"
#include "tests/bench/curve.h"
#include "tests/bench/lit_scene.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

using base::forward;
using kernels::culling::Config;
using kernels::culling::CullingHistory;
using kernels::culling::StageTimes;
using scheduling::TileScheduler;

constexpr std::uint64_t kSeed = 1;

/// One frame, what it cost, and where the time went.
struct Rendered {
  Plane<Rgb> radiance;
  Lap lap;
  StageTimes stages;
  std::uint64_t shadow_rays = 0;
  std::size_t made = 0, kept = 0;
};

/// Frames of one session.
class Session {
 public:
  Session(const CullingSetting& setting, const Config& config, TileScheduler& scheduler)
      : setting_(setting), kernel_(config), scheduler_(scheduler) {}

  Result<Rendered> frame(int index) {
    const auto scene = setting_.frame(index);
    if (!scene) return forward(scene);
    const kernels::FrameRequest request{
        {&setting_.view(), 1}, setting_.map(), static_cast<std::uint64_t>(index), kSeed};
    Stopwatch watch;
    const auto report = kernel_.render(request, **scene, history_, scheduler_, buffers_);
    Rendered rendered;
    rendered.lap = watch.lap();
    rendered.radiance = buffers_.views.front().radiance;
    rendered.shadow_rays = report.shadow_rays;
    const auto& memory = kernels::record_of<CullingHistory>(history_);
    rendered.stages = memory.stages, rendered.made = memory.made, rendered.kept = memory.kept;
    return rendered;
  }

 private:
  const CullingSetting& setting_;
  kernels::culling::CullingKernel kernel_;
  TileScheduler& scheduler_;
  kernels::History history_;
  kernels::FrameBuffers buffers_;
};

/// Every virtual light, at some of the pixels.
class AllLights {
 public:
  AllLights(const CullingSetting& setting, const Config& config, TileScheduler& scheduler)
      : setting_(setting),
        config_(config),
        scheduler_(scheduler),
        pixels_(sample_of_blocks(setting.display())) {}

  /// Of `asked` lights a pixel, drawn by what they would bring; 0: of all.
  Result<Rendered> frame(int index, int asked) const {
    const auto scene = setting_.frame(index);
    if (!scene) return forward(scene);
    Stopwatch watch;
    const auto all = kernels::culling::all_lights(**scene, config_, 0, scheduler_);
    const lights::VirtualLightTable table(all.lights, 1, static_cast<float>(all.least_m));
    kernels::ray::Config lit = config_.ray;
    lit.virtual_lights = {&table, asked};
    kernels::FrameBuffers out;
    kernels::prepare_buffers({&setting_.view(), 1}, out);
    const kernels::FrameRequest request{
        {&setting_.view(), 1}, setting_.map(), static_cast<std::uint64_t>(index), kSeed + 1};
    const kernels::ray::ViewContext context(setting_.view(), **scene, lit, request, 0);
    constexpr std::size_t kStep = 256;  // pixels of a tile
    const std::size_t tiles = (pixels_.size() + kStep - 1) / kStep;
    std::vector<kernels::FrameReport> parts(tiles);
    scheduler_.run(tiles, [&](std::size_t tile) {
      const std::size_t first = tile * kStep, count = std::min(kStep, pixels_.size() - first);
      parts[tile] = kernels::ray::render_cells(context, std::span(pixels_).subspan(first, count),
                                               out.views.front());
    });
    Rendered rendered;
    rendered.lap = watch.lap();
    rendered.radiance = std::move(out.views.front().radiance);
    for (const auto& part : parts) rendered.shadow_rays += part.shadow_rays;
    rendered.made = rendered.kept = all.made;
    return rendered;
  }

  std::span<const image::Pixel> pixels() const { return pixels_; }
  /// Of the whole picture over what is rendered.
  double pixel_ratio() const {
    const auto& display = setting_.display();
    return static_cast<double>(display.width_px) * display.height_px /
           static_cast<double>(pixels_.size());
  }

 private:
  const CullingSetting& setting_;
  const Config& config_;
  TileScheduler& scheduler_;
  std::vector<image::Pixel> pixels_;
};

/// Luma of some pixels, encoded for a display, as one row.
Plane<float> encoded_luma(const image::Tone& tone, const Plane<Rgb>& radiance,
                          std::span<const image::Pixel> pixels) {
  Plane<Rgb> listed(static_cast<int>(pixels.size()), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    listed.pixels()[i] = radiance(pixels[i].x, pixels[i].y);
  return metrics::luma(display_encoded(tone, listed));
}

Result<void> turn_knobs(const std::string& knobs, Config& config) {
  const auto values = kernels::parse_knobs(knobs);
  if (!values) return forward(values);
  return kernels::culling::turn_knobs(*values, config);
}

/// One scene in one motion: its references, and the methods against them.
class Comparison {
 public:
  static Result<std::unique_ptr<Comparison>> create(const CullingOptions& options,
                                                    const std::string& scene,
                                                    const std::string& motion,
                                                    TileScheduler& scheduler) {
    const auto kind = find_motion(motion);
    if (!kind) return forward(kind);
    auto setting = CullingSetting::create(scene, *kind, options.side_px);
    if (!setting) return forward(setting);
    auto made = std::unique_ptr<Comparison>(
        new Comparison(options, scene, motion, std::move(*setting), scheduler));
    if (auto ok = made->make_references(); !ok) return forward(ok);
    return made;
  }

  Result<Fields> measure(const CullingMethod& method, int kept) {
    return method.keeps_all ? measure_all(method) : measure_session(method, kept);
  }

 private:
  Comparison(const CullingOptions& options, std::string scene, std::string motion,
             CullingSetting setting, TileScheduler& scheduler)
      : options_(options),
        scene_(std::move(scene)),
        motion_(std::move(motion)),
        setting_(std::move(setting)),
        scheduler_(scheduler),
        all_config_(culling_config(**find_culling_method("all_vpls"), 0)) {}

  int judged_frame() const { return options_.warm_up + options_.frames - 1; }

  Result<void> make_references() {
    const PictureCache cache(options_.references);
    auto halves = path_references(setting_, scene_ + motion_, judged_frame(),
                                  options_.reference_samples, cache, scheduler_);
    if (!halves) return forward(halves);
    setting_.set_exposure(exposure_for(halves->first));
    judge_.emplace(setting_, std::move(*halves));
    measure_surfaces();
    const AllLights all(setting_, all_config_, scheduler_);
    pixels_.assign(all.pixels().begin(), all.pixels().end());
    constexpr int kSteadyAsked = 256;
    for (int k = 0; k < options_.frames; ++k) {
      const bool last = k + 1 == options_.frames;
      auto frame = all.frame(options_.warm_up + k, last ? 0 : kSteadyAsked);
      if (!frame) return forward(frame);
      steady_luma_.push_back(encoded_luma(setting_.view().tone, frame->radiance, pixels_));
      if (last) all_ = std::move(*frame), all_ratio_ = all.pixel_ratio();
    }
    return write("reference", judge_->reference());
  }

  void measure_surfaces() {
    const auto scene = setting_.frame(judged_frame());
    if (!scene) return;
    const kernels::FrameRequest request{{&setting_.view(), 1}, setting_.map(), 0, kSeed};
    kernels::FrameReport report;
    Stopwatch watch;
    kernels::ray::trace_surfaces(request, **scene, all_config_.ray,
                                 kernels::kNormal | kernels::kAlbedo, scheduler_, report);
    surfaces_cpu_ms_ = watch.lap().cpu_ms;
  }

  Result<Fields> measure_all(const CullingMethod& method) {
    Rendered whole = all_;
    whole.lap.cpu_ms *= all_ratio_;
    whole.stages.shading_ms = whole.lap.cpu_ms, whole.lap.wall_ms = whole.lap.cpu_ms;
    return fields(method, whole, judge_->errors(all_.radiance, pixels_), 0.0);
  }

  Result<Fields> measure_session(const CullingMethod& method, int kept) {
    Config config = culling_config(method, kept);
    if (auto ok = turn_knobs(options_.knobs, config); !ok) return forward(ok);
    Session session(setting_, config, scheduler_);
    Rendered mean;
    std::vector<Plane<float>> luma;
    for (int k = 0; k <= judged_frame(); ++k) {
      auto frame = session.frame(k);
      if (!frame) return forward(frame);
      if (k < options_.warm_up) continue;
      add(*frame, mean);
      luma.push_back(encoded_luma(setting_.view().tone, frame->radiance, pixels_));
      if (k == judged_frame()) mean.radiance = std::move(frame->radiance);
    }
    share(mean);
    const std::string name = base::concat(method.name, "_", kept);
    if (auto ok = write(name, mean.radiance); !ok) return forward(ok);
    return fields(method, mean, judge_->errors(mean.radiance), flicker(luma));
  }

  static void add(const Rendered& one, Rendered& sum) {
    sum.lap.cpu_ms += one.lap.cpu_ms, sum.lap.wall_ms += one.lap.wall_ms;
    sum.stages += one.stages;
    sum.shadow_rays += one.shadow_rays;
    sum.made = one.made, sum.kept = one.kept;
  }
  void share(Rendered& sum) const {
    const double n = options_.frames;
    sum.lap.cpu_ms /= n, sum.lap.wall_ms /= n;
    sum.stages /= n;
    sum.shadow_rays /= static_cast<std::uint64_t>(options_.frames);
  }

  /// The eye is still. Nothing moves: what changes over time. Else: how much more the picture
  /// changes from frame to frame than light does.
  double flicker(const std::vector<Plane<float>>& luma) const {
    metrics::FlickerMeter meter;
    const Plane<float> nothing(luma.front().width(), 1, 0.0F);
    if (motion_ == "static") {
      for (const Plane<float>& one : luma) meter.add(nothing, one);
      return meter.rms();
    }
    const Plane<unsigned char> everywhere(luma.front().width(), 1, 1);
    double square = 0.0;
    for (std::size_t k = 1; k < luma.size(); ++k) {
      const double step = metrics::warped_flicker_rms(
          {luma[k], luma[k - 1], steady_luma_[k], steady_luma_[k - 1]}, everywhere);
      square += step * step / static_cast<double>(luma.size() - 1);
    }
    return std::sqrt(square);
  }

  Fields fields(const CullingMethod& method, const Rendered& r, const FoveaErrors& errors,
                double flicker) const {
    // Stages are wall time of one thread; the others help.
    const double cpu = r.lap.wall_ms > 0.0 ? r.lap.cpu_ms / r.lap.wall_ms : 1.0;
    const double reference = mean_luminance(judge_->reference(), pixels_);
    const double all = mean_luminance(all_.radiance, pixels_);
    const double own = mean_luminance(r.radiance, pixels_);
    const FoveaErrors from_all = judge_->difference(r.radiance, all_.radiance, pixels_);
    return {{"scene", std::filesystem::path(scene_).stem().string()},
            {"motion", motion_},
            {"fovea_deg", CullingSetting::fovea().value()},
            {"method", std::string(method.name)},
            {"vpls", static_cast<std::int64_t>(r.made)},
            {"kept", static_cast<std::int64_t>(r.kept)},
            {"rmse_in150", errors.inside.rmse()},
            {"rmse_out150", errors.outside.rmse()},
            {"ratio_pf", errors.ratio()},
            {"from_vpls_in150", from_all.inside.rmse()},
            {"from_vpls_out150", from_all.outside.rmse()},
            {"brightness_error_pct", 100.0 * (own / all - 1.0)},
            {"brightness_paths_pct", 100.0 * (own / reference - 1.0)},
            {"cpu_ms", r.lap.cpu_ms},
            {"gbuffer_ms", surfaces_cpu_ms_},
            {"rsm_ms", cpu * r.stages.lights_ms},
            {"importance_ms", cpu * r.stages.importance_ms},
            {"contribution_ms", cpu * r.stages.contribution_ms},
            {"culling_ms", cpu * r.stages.culling_ms},
            {"shading_ms", std::max(cpu * r.stages.shading_ms - surfaces_cpu_ms_, 0.0)},
            {"post_ms", cpu * r.stages.post_ms},
            {"mrays", 1e-6 * static_cast<double>(r.shadow_rays)},
            {"flicker_t1", flicker},
            {"reference_se_pct", 100.0 * errors.inside.relative_standard_error()}};
  }

  Result<void> write(const std::string& name, const Plane<Rgb>& radiance) const {
    if (options_.pictures.empty()) return {};
    std::error_code ignored;  // a folder that cannot be made shows when it is written to
    std::filesystem::create_directories(options_.pictures, ignored);
    Plane<Rgb8> codes;
    image::encode(setting_.view().tone, radiance, codes);
    const std::string stem = std::filesystem::path(scene_).stem().string();
    return image::write_png(
        base::concat(options_.pictures, "/", stem, "_", motion_, "_", name, ".png"), codes);
  }

  const CullingOptions& options_;
  const std::string scene_, motion_;
  CullingSetting setting_;
  TileScheduler& scheduler_;
  const Config all_config_;
  std::optional<CullingJudge> judge_;
  Rendered all_;                           ///< every light, at pixels_, in the judged frame
  double all_ratio_ = 1.0;                 ///< of the whole picture over pixels_
  std::vector<image::Pixel> pixels_;       ///< what is compared with all lights
  std::vector<Plane<float>> steady_luma_;  ///< of pixels_ under all lights, by timed frame
  double surfaces_cpu_ms_ = 0.0;
};

Fields config_of(const CullingOptions& options) {
  return {{"side_px", std::int64_t{options.side_px}},
          {"fov_deg", 90.0},
          {"reference_samples", std::int64_t{options.reference_samples}},
          {"warm_up", std::int64_t{options.warm_up}},
          {"frames", std::int64_t{options.frames}},
          {"knobs", options.knobs},
          {"threads", std::int64_t{options.threads}}};
}

template <class T>
const T* find(const Fields& fields, std::string_view key) {
  const auto at = std::ranges::find(fields, key, [](const auto& field) { return field.first; });
  return at == fields.end() ? nullptr : std::get_if<T>(&at->second);
}

struct Wanted {
  const CullingMethod* method;
  int kept;
};
Result<std::vector<Wanted>> wanted(const CullingOptions& options) {
  std::vector<Wanted> all;
  const auto add = [&](const CullingMethod& method) {
    if (method.keeps_all) return all.push_back({&method, 0});
    for (const int kept : options.kept) all.push_back({&method, kept});
  };
  if (options.methods.empty())
    for (const CullingMethod& method : culling_methods()) add(method);
  for (const std::string& name : options.methods) {
    const auto method = find_culling_method(name);
    if (!method) return forward(method);
    add(**method);
  }
  return all;
}

}  // namespace

void make_quick(CullingOptions& options) {
  options.side_px = 512;
  options.motions = {"static", "both"};
  options.kept = {256, 1024};
  options.reference_samples = 8;
  options.warm_up = 4, options.frames = 3;
}

Result<void> run_culling(const CullingOptions& options) {
  const auto rows = wanted(options);
  if (!rows) return forward(rows);
  Config any;
  if (auto ok = turn_knobs(options.knobs, any); !ok) return ok;
  Report report{"culling", config_of(options), {}};
  if (!options.json.empty()) {
    auto known = read_rows(options.json, report);
    if (!known) return forward(known);
    report.rows = std::move(*known);
  }
  const auto is_known = [&](const std::string& scene, const std::string& motion,
                            const Wanted& row) {
    const std::string stem = std::filesystem::path(scene).stem().string();
    return std::ranges::any_of(report.rows, [&](const Fields& fields) {
      return *find<std::string>(fields, "scene") == stem &&
             *find<std::string>(fields, "motion") == motion &&
             *find<std::string>(fields, "method") == row.method->name &&
             (row.method->keeps_all || *find<std::int64_t>(fields, "asked_for") == row.kept);
    });
  };
  TileScheduler scheduler(options.threads);
  Progress progress("culling", static_cast<std::int64_t>(options.scenes.size() *
                                                         options.motions.size() * rows->size()));
  for (const std::string& scene : options.scenes) {
    for (const std::string& motion : options.motions) {
      std::unique_ptr<Comparison> comparison;
      for (const Wanted& row : *rows) {
        progress.advance();
        if (is_known(scene, motion, row)) continue;
        if (!comparison) {
          auto made = Comparison::create(options, scene, motion, scheduler);
          if (!made) return forward(made);
          comparison = std::move(*made);
        }
        auto fields = comparison->measure(*row.method, row.kept);
        if (!fields) return forward(fields);
        fields->insert(fields->begin() + 4, {"asked_for", std::int64_t{row.kept}});
        report.rows.push_back(std::move(*fields));
        if (options.json.empty()) continue;
        if (auto ok = write_json(options.json, report); !ok) return ok;
      }
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return {};
}

}  // namespace macula::bench
