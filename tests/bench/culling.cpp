#include "tests/bench/culling.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "server/kernels/culling/knobs.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "tests/bench/culling_equal_time.h"
#include "tests/bench/culling_judge.h"
#include "tests/bench/culling_method.h"
#include "tests/bench/culling_runs.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

using base::forward;
using kernels::culling::Config;
using scheduling::TileScheduler;

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
        new Comparison(options, scene, motion, *kind, std::move(*setting), scheduler));
    if (auto ok = made->make_references(); !ok) return forward(ok);
    return made;
  }

  Result<Fields> measure(const CullingMethod& method, int kept) {
    return method.rendering == Rendering::Blocks ? measure_all(method)
                                                 : measure_session(method, kept);
  }

 private:
  Comparison(const CullingOptions& options, const std::string& scene, std::string motion,
             SceneMotion kind, CullingSetting setting, TileScheduler& scheduler)
      : options_(options),
        stem_(std::filesystem::path(scene).stem().string()),
        motion_(std::move(motion)),
        kind_(kind),
        setting_(std::move(setting)),
        scheduler_(scheduler),
        all_config_(culling_config(**find_culling_method("all_vpls"), 0)),
        judged_(judged_pixels(setting_, options.judged)) {}

  int judged_frame() const { return options_.warm_up + options_.frames - 1; }

  Result<void> make_references() {
    auto halves = path_references(setting_, judged_, judged_frame(), options_.reference_samples,
                                  PictureCache(options_.references), scheduler_);
    if (!halves) return forward(halves);
    judge_.emplace(judged_, std::move(*halves));
    if (!(judge_->reference_luminance() > 0.0)) {
      return base::bad_input("the lamp above the eye lights nothing that it sees", stem_,
                             "a scene whose first camera looks into a room from within");
    }
    setting_.set_exposure(judge_->tone().exposure_ev);
    for (int k = options_.warm_up; k <= judged_frame(); ++k) {
      const auto frame = all_lights_at(judged_.pixels, k, setting_, all_config_, scheduler_);
      if (!frame) return forward(frame);
      steady_.push_back(listed(frame->radiance, judged_.pixels));
    }
    const auto surfaces = surfaces_cpu_ms(judged_frame(), setting_, all_config_.ray, scheduler_);
    if (!surfaces) return forward(surfaces);
    surfaces_cpu_ms_ = *surfaces;
    return {};
  }

  /// Timed where pixels lie beside each other, as in a picture.
  Result<Fields> measure_all(const CullingMethod& method) {
    const auto& display = setting_.display();
    const std::vector<image::Pixel> blocks = sample_of_blocks(display);
    auto timed = all_lights_at(blocks, judged_frame(), setting_, all_config_, scheduler_);
    if (!timed) return forward(timed);
    timed->count_cells_times(static_cast<double>(display.width_px) * display.height_px /
                             static_cast<double>(blocks.size()));
    return fields(method, *timed, steady_.back(), 0.0);
  }

  Result<Fields> measure_session(const CullingMethod& method, int kept) {
    Config config = culling_config(method, kept);
    if (auto ok = turn_knobs(options_.knobs, config); !ok) return forward(ok);
    const bool fourth = method.rendering == Rendering::Fourth;
    CullingSession session(setting_, fourth ? setting_.thinned_eye() : setting_.eye(), config,
                           static_cast<std::uint64_t>(options_.seed), scheduler_);
    Rendered mean;
    std::vector<Plane<Rgb>> rows;
    for (int k = 0; k <= judged_frame(); ++k) {
      auto frame = session.frame(k);
      if (!frame) return forward(frame);
      if (k < options_.warm_up) continue;
      mean.add(*frame);
      rows.push_back(fourth ? listed_of_thinned(frame->radiance, judged_.pixels)
                            : listed(frame->radiance, judged_.pixels));
      if (k == judged_frame()) mean.radiance = std::move(frame->radiance);
    }
    mean.divide(options_.frames);
    constexpr double kPixels = CullingSetting::kThinning * CullingSetting::kThinning;
    if (fourth) mean.count_cells_times(kPixels);
    const std::string name = base::concat(method.name, "_", kept);
    if (auto ok = write(name, mean.radiance); !ok) return forward(ok);
    return fields(method, mean, rows.back(), judge_->flicker(rows, steady_, kind_));
  }

  Fields fields(const CullingMethod& method, const Rendered& r, const Plane<Rgb>& row,
                double flicker) const {
    // Stages are wall time of one thread; the others help.
    const double cpu = r.lap.wall_ms > 0.0 ? r.lap.cpu_ms / r.lap.wall_ms : 1.0;
    const double own = judge_->mean_luminance(row);
    const FoveaErrors errors = judge_->errors(row);
    const FoveaErrors from_all = judge_->difference(row, steady_.back());
    return {{"scene", stem_},
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
            {"brightness_error_pct", 100.0 * (own / judge_->mean_luminance(steady_.back()) - 1.0)},
            {"brightness_paths_pct", 100.0 * (own / judge_->reference_luminance() - 1.0)},
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
            {"reference_se_pct", 100.0 * errors.inside.relative_standard_error()},
            {"rmse_se_pct", 100.0 * errors.relative_standard_error()}};
  }

  Result<void> write(const std::string& name, const Plane<Rgb>& radiance) const {
    if (options_.pictures.empty()) return {};
    std::error_code ignored;  // a folder that cannot be made shows when it is written to
    std::filesystem::create_directories(options_.pictures, ignored);
    Plane<Rgb8> codes;
    image::encode(setting_.view().tone, radiance, codes);
    return image::write_png(
        base::concat(options_.pictures, "/", stem_, "_", motion_, "_", name, ".png"), codes);
  }

  const CullingOptions& options_;
  const std::string stem_, motion_;
  const SceneMotion kind_;
  CullingSetting setting_;
  TileScheduler& scheduler_;
  const Config all_config_;
  const JudgedPixels judged_;
  std::optional<CullingJudge> judge_;
  std::vector<Plane<Rgb>> steady_;  ///< at the judged pixels, under all lights, by timed frame
  double surfaces_cpu_ms_ = 0.0;
};

Fields config_of(const CullingOptions& options) {
  return {{"side_px", std::int64_t{options.side_px}},
          {"fov_deg", 90.0},
          {"judged", std::int64_t{options.judged}},
          {"reference_samples", std::int64_t{options.reference_samples}},
          {"warm_up", std::int64_t{options.warm_up}},
          {"frames", std::int64_t{options.frames}},
          {"knobs", options.knobs},
          {"seed", std::int64_t{options.seed}},
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
    if (method.rendering == Rendering::Blocks) return all.push_back({&method, 0});
    const bool reads_off = is_rival(method.name) && !options.rivals_kept.empty();
    const double share = reads_off ? method.lights_at_equal_time : 1.0;
    for (const int kept : reads_off ? options.rivals_kept : options.kept)
      all.push_back({&method, std::max(static_cast<int>(share * kept), 1)});
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
  options.motions = {"both"};
  options.methods = {"flc", "flc_fast", "flc_rays", "fir", "power", "tree", "all_vpls"};
  options.kept = {1024}, options.rivals_kept = {768, 2048};
  options.judged = 256, options.reference_samples = 2048;
  options.warm_up = 2, options.frames = 2;
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
             (row.method->rendering == Rendering::Blocks ||
              *find<std::int64_t>(fields, "asked_for") == row.kept);
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
  const std::vector<Fields> at_equal_time = errors_at_equal_time(report.rows);
  if (at_equal_time.empty()) return {};
  std::fputs("\nAt equal CPU time, the rival's error over the method's own:\n", stdout);
  std::fputs(table_text(at_equal_time).c_str(), stdout);
  return {};
}

}  // namespace macula::bench
