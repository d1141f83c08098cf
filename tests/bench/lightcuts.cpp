#include "tests/bench/lightcuts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "server/reconstruction/light_memory.h"
#include "tests/bench/lightcuts_gains.h"
#include "tests/bench/lightcuts_pictures.h"
#include "tests/bench/lightcuts_setting.h"
#include "tests/bench/lightcuts_stages.h"
#include "tests/bench/lightcuts_stereo.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/tradeoff_front.h"

namespace macula::bench {
namespace {

using kernels::lightcuts::Config;
using kernels::lightcuts::CutSizes;
using kernels::lightcuts::PerceptionMode;
using scheduling::TileScheduler;

/// Points of a baseline's curve, and what is read from which.
enum class Curves { Itself, Plain, Denoised };

struct Method {
  std::string name;
  Config config;
  Curves against = Curves::Plain;  ///< Itself: sl or sl_denoised at some number of samples
  bool remembers = false;          ///< warmed up before it is judged

  float alpha() const { return config.perception.alpha; }
  /// Unlike all others' of a run.
  std::string label() const {
    if (against == Curves::Itself)
      return name + "_" + std::to_string(config.ray.area_light_samples);
    if (alpha() == kernels::lightcuts::PerceptionConfig{}.alpha) return name;
    char text[32];
    std::snprintf(text, sizeof text, "_alpha_%g", static_cast<double>(alpha()));
    return name + text;
  }
};

/// Table 4's, less the default.
void add_alphas(std::vector<Method>& all) {
  for (const float alpha : {0.025F, 0.1F, 0.2F, 0.4F}) {
    Config config = paper_cuts();
    config.perception.alpha = alpha;
    all.push_back({"paper", config});
  }
}

/// Of a baseline's cuts.
constexpr int most_nodes(bool quick) {
  return quick ? 32 : 64;
}

/// Whether light memory holds more than one frame of so many samples a pixel.
bool fills_memory(int nodes) {
  return static_cast<float>(nodes) < reconstruction::MemoryConfig{}.most_samples;
}

std::vector<Method> methods(const LightcutsOptions& options) {
  using kernels::lightcuts::Denoise;
  std::vector<Method> all;
  const int most = most_nodes(options.quick);
  for (int nodes = 1; nodes <= most; nodes *= 2)
    all.push_back({"sl", uniform_cuts(nodes), Curves::Itself});
  // Quick: the last that memory serves well, and one without any, which needs no frames before.
  for (int nodes = 1; nodes <= most; nodes *= 2) {
    if (options.quick && (nodes == 2 || nodes == 16)) continue;
    all.push_back({"sl_denoised", denoised_cuts(nodes), Curves::Itself, fills_memory(nodes)});
  }
  all.push_back({"sl_as", perceived_cuts(PerceptionMode::Stengel)});
  all.push_back({"paper_no_reuse", perceived_cuts(PerceptionMode::Attenuation)});
  all.push_back({"paper", paper_cuts()});
  if (options.alphas) add_alphas(all);
  all.push_back({"ours_exact", reservoir_cuts(Denoise::No), Curves::Plain, true});
  Config denoised = paper_cuts();
  denoised.denoise = Denoise::Yes;
  all.push_back({"paper_denoised", denoised, Curves::Denoised, true});
  all.push_back({"ours", reservoir_cuts(Denoise::Yes), Curves::Denoised, true});
  std::erase_if(all, [&](const Method& method) {
    return !options.methods.empty() &&
           std::ranges::find(options.methods, method.name) == options.methods.end();
  });
  if (options.quick && options.methods.empty())
    std::erase_if(all, [](const Method& method) { return method.name == "paper_denoised"; });
  return all;
}

/// What a method did, means over its frames.
struct Measured {
  double cpu_ms = 0.0, wall_ms = 0.0, fpsm_ms = 0.0, trace_ms = 0.0, denoise_ms = 0.0,
         samples = 0.0;
  double mean_lspp = 0.0;  ///< nodes that cuts were allowed, a pixel
  double reuse = 0.0;      ///< share of nodes whose light another pixel had drawn
  LightcutsStages stages;
  Regional lspp;
  LightcutsErrors errors;

  double sample_ms() const { return stages.sample_ms * (1.0 - reuse); }
  /// What nothing else accounts for: all rays, materials, what lights send, low resolution.
  double shade_ms() const {
    return cpu_ms - fpsm_ms - denoise_ms - stages.cut_ms - sample_ms() - stages.glossy_ms;
  }
};

/// Of one scene's pictures.
std::string picture_folder(const LightcutsOptions& options, const std::string& scene) {
  if (options.scenes.size() == 1) return options.pictures;
  return options.pictures + "/" + std::filesystem::path(scene).stem().string();
}

/// Seeds of frames that are not judged.
constexpr int kWarmUpSeed = 10'000;

/// One scene and gaze.
class Run {
 public:
  /// `pictures`: none where nobody looks.
  Run(const std::string& scene, double gaze_deg, const LightcutsSetting& setting,
      const LightcutsJudge& judge, const LightcutsOptions& options, LightcutsPictures* pictures,
      TileScheduler& scheduler)
      : scene_(scene),
        gaze_deg_(gaze_deg),
        setting_(setting),
        judge_(judge),
        options_(options),
        pictures_(pictures),
        scheduler_(scheduler) {}

  Result<void> measure(const Method& method) {
    Measured all;
    sizes_of(method, all);
    kernels::History history;
    Plane<Rgb> first;
    constexpr int kSwing = LightcutsSetting::kSwing;
    const int warm_up = method.remembers ? (options_.warm_up + kSwing - 1) / kSwing * kSwing : 0;
    const int step = method.remembers ? 1 : kSwing;
    for (int k = -warm_up; k <= kSwing * (options_.frames - 1); k += step) {
      if (!method.remembers) history = {};
      auto moved = setting_.moved(k + warm_up);
      if (!moved) return base::forward(moved);
      const auto seed = static_cast<std::uint64_t>(k < 0 ? kWarmUpSeed - k : k + 1);
      Picture one = picture_of(*moved, method.config, seed, history, scheduler_);
      if (k < 0 || k % kSwing != 0) continue;
      add(one, all);
      if (k == 0) first = std::move(one.radiance);
    }
    show(method, all, first);
    measured_.push_back({method, all});
    return {};
  }

  /// Whether more points of a baseline's curve would tell nothing.
  bool reaches_all(const std::string& baseline) const {
    return bench::reaches_all(baseline, judged());
  }

  /// Curves first.
  std::vector<Fields> rows() const {
    std::vector<Fields> rows;
    for (const bool curves : {true, false}) {
      for (const Row& row : measured_)
        if ((row.method.against == Curves::Itself) == curves) rows.push_back(fields(row));
    }
    return rows;
  }

 private:
  struct Row {
    Method method;
    Measured measured;
  };

  /// The mean over the judged frames grows by one of them.
  void add(const Picture& one, Measured& all) const {
    const double share = 1.0 / options_.frames;
    all.cpu_ms += share * one.cpu_ms, all.wall_ms += share * one.wall_ms;
    all.fpsm_ms += share * one.report.mask_ms, all.trace_ms += share * one.report.trace_ms;
    all.denoise_ms += share * one.report.post_ms;
    all.samples += share * static_cast<double>(one.report.shadow_rays);
    const auto taken = static_cast<double>(one.report.taken_nodes);
    const auto nodes = taken + static_cast<double>(one.report.walked_nodes);
    if (nodes > 0.0) all.reuse += share * taken / nodes;
    const LightcutsErrors errors = judge_.errors(one.radiance);
    const auto grow = [share](Regional& sum, const Regional& by) {
      sum.f25 += share * by.f25, sum.out25 += share * by.out25;
    };
    grow(all.errors.mse, errors.mse), grow(all.errors.relmse, errors.relmse);
    grow(all.errors.diffuse, errors.diffuse), grow(all.errors.glossy, errors.glossy);
  }

  void sizes_of(const Method& method, Measured& all) {
    Plane<std::uint16_t> cut_nodes(
        setting_.display.width_px, setting_.display.height_px,
        static_cast<std::uint16_t>(method.config.ray.area_light_samples));
    if (method.config.sizes == CutSizes::Perceived)
      cut_nodes = plan_of(setting_, method.config, scheduler_).cut_nodes.front();
    const Plane<float> nodes = as_floats(cut_nodes);
    all.mean_lspp = mean_of(nodes);
    all.lspp = judge_.mean(nodes);
    all.stages = stages_of(setting_, method.config, cut_nodes, options_.quick ? 4 : 1, scheduler_);
  }

  void show(const Method& method, const Measured& all, const Plane<Rgb>& radiance) {
    if (pictures_ == nullptr) return;
    pictures_->add({method.name, method.label(), baseline_of(method), method.alpha(), all.cpu_ms,
                    all.errors.mse, all.lspp},
                   method.config, radiance);
  }

  static std::string baseline_of(const Method& method) {
    if (method.against == Curves::Itself) return method.name;
    return method.against == Curves::Plain ? "sl" : "sl_denoised";
  }

  static Judged judged(const Row& row) {
    const Measured& m = row.measured;
    return {row.method.name, baseline_of(row.method), m.cpu_ms, m.errors.mse.f25,
            m.errors.mse.out25};
  }
  std::vector<Judged> judged() const {
    std::vector<Judged> all;
    for (const Row& row : measured_) all.push_back(judged(row));
    return all;
  }

  Fields fields(const Row& row) const {
    const Measured& m = row.measured;
    const LightcutsGains gains = gains_of(judged(row), judged());
    char gaze[32];
    std::snprintf(gaze, sizeof gaze, "%g,0", gaze_deg_);
    return {{"scene", scene_},
            {"lights", static_cast<std::int64_t>(setting_.lights)},
            {"gaze", std::string(gaze)},
            {"share_of_f25", judge_.share_of_f25()},
            {"method", row.method.name},
            {"alpha", static_cast<double>(row.method.alpha())},
            {"against", baseline_of(row.method)},
            {"cpu_ms", m.cpu_ms},
            {"wall_ms", m.wall_ms},
            {"mean_lspp", m.mean_lspp},
            {"lspp_f25", m.lspp.f25},
            {"lspp_out25", m.lspp.out25},
            {"mse_f25", m.errors.mse.f25},
            {"mse_out25", m.errors.mse.out25},
            {"relmse_f25", m.errors.relmse.f25},
            {"relmse_out25", m.errors.relmse.out25},
            {"msed_f25", m.errors.diffuse.f25},
            {"msed_out25", m.errors.diffuse.out25},
            {"mseg_f25", m.errors.glossy.f25},
            {"mseg_out25", m.errors.glossy.out25},
            {"tree_ms", m.stages.tree_ms},
            {"fpsm_ms", m.fpsm_ms},
            {"cut_ms", m.stages.cut_ms},
            {"sample_ms", m.sample_ms()},
            {"shade_ms", m.shade_ms()},
            {"glossy_ms", m.stages.glossy_ms},
            {"trace_ms", m.trace_ms},
            {"denoise_ms", m.denoise_ms},
            {"reuse", m.reuse},
            {"samples_s", m.samples / (1e-3 * m.cpu_ms)},
            {"gain_f25", gains.gain_f25},
            {"gain_out25", gains.gain_out25},
            {"speed_f25", gains.speed_f25},
            {"plain_gain_f25", gains.plain_gain_f25},
            {"plain_gain_out25", gains.plain_gain_out25},
            {"not_read", std::int64_t{gains.not_read}}};
  }

  const std::string& scene_;
  double gaze_deg_;
  const LightcutsSetting& setting_;
  const LightcutsJudge& judge_;
  const LightcutsOptions& options_;
  LightcutsPictures* pictures_;
  TileScheduler& scheduler_;
  std::vector<Row> measured_;
};

LightcutsOptions quickened(LightcutsOptions options) {
  if (!options.quick) return options;
  if (options.reference_nodes == LightcutsOptions{}.reference_nodes) options.reference_nodes = 64;
  options.reference_passes = 1;
  options.frames = options.stereo ? 4 : 1;  // noise of pairs is told by frames
  options.warm_up = std::min(options.warm_up, LightcutsSetting::kSwing);
  if (options.gazes_deg == LightcutsOptions{}.gazes_deg) options.gazes_deg = {0};
  return options;
}

/// Methods before the curves that they are held against: a quick run's curves end where they have
/// reached all.
Result<void> measure_all(std::vector<Method> all, const LightcutsOptions& options,
                         Progress& progress, Run& run) {
  std::ranges::stable_partition(
      all, [](const Method& method) { return method.against != Curves::Itself; });
  for (const Method& method : all) {
    const bool is_needed =
        !options.quick || method.against != Curves::Itself || !run.reaches_all(method.name);
    if (is_needed) {
      if (auto ok = run.measure(method); !ok) return ok;
    }
    progress.advance();
  }
  return {};
}

/// A scene's rows, a gaze after the other; references are made once.
Result<void> run_scene(const std::string& scene, const LightcutsOptions& options,
                       TileScheduler& scheduler, Progress& progress, std::vector<Fields>& rows) {
  auto setting = LightcutsSetting::make(scene, options.quick, options.gloss, scheduler);
  if (!setting) return base::forward(setting);
  LightcutsJudge judge(*setting, references_of(options), scheduler);
  for (const double gaze_deg : options.gazes_deg) {
    setting->look(Degrees{gaze_deg});
    judge.look(*setting);
    std::optional<LightcutsPictures> pictures;
    if (!options.pictures.empty()) {
      pictures.emplace(picture_folder(options, scene), gaze_deg == 0.0 ? "" : "_aside",
                       std::filesystem::path(scene).stem().string(), *setting, judge, scheduler);
    }
    Run run(scene, gaze_deg, *setting, judge, options, pictures ? &*pictures : nullptr, scheduler);
    if (auto ok = measure_all(methods(options), options, progress, run); !ok) return ok;
    if (pictures) pictures->write_sheets();
    for (Fields& row : run.rows()) rows.push_back(std::move(row));
  }
  return {};
}

/// Of every method over all scenes and gazes: geometric means and the worst of what was gained.
std::vector<Fields> gains(const std::vector<Fields>& rows) {
  std::vector<Fields> lines;
  for (const char* name : {"sl_as", "paper_no_reuse", "paper", "ours_exact", "ours"}) {
    const auto is_of_it = [&](const Fields& row) { return text_in(row, "method") == name; };
    if (std::ranges::none_of(rows, is_of_it)) continue;
    Fields line{{"method", std::string(name)}};
    for (const char* key :
         {"gain_f25", "gain_out25", "speed_f25", "plain_gain_f25", "plain_gain_out25"}) {
      double sum = 0.0, worst = INFINITY;
      int count = 0;
      for (const Fields& row : rows) {
        const bool is_default = number_in(row, "alpha") ==
                                static_cast<double>(kernels::lightcuts::PerceptionConfig{}.alpha);
        if (!is_of_it(row) || !is_default) continue;
        const double value = number_in(row, key);
        if (std::isnan(value)) continue;  // not measured, or beyond its curve
        sum += std::log(value), worst = std::min(worst, value), ++count;
      }
      line.emplace_back(key, std::exp(sum / count));
      line.emplace_back(std::string("worst_") + key, count > 0 ? worst : std::nan(""));
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

Fields effective(const LightcutsOptions& options) {
  return {{"quick", options.quick},
          {"frames", std::int64_t{options.frames}},
          {"warm_up", std::int64_t{options.warm_up}},
          {"reference_nodes", std::int64_t{options.reference_nodes}},
          {"reference_passes", std::int64_t{options.reference_passes}},
          {"gloss", options.gloss == kernels::lightcuts::Gloss::Yes}};
}

Result<void> run_lightcuts(const LightcutsOptions& asked) {
  const LightcutsOptions options = quickened(asked);
  if (options.stereo) return run_lightcuts_stereo(options);
  TileScheduler scheduler(options.threads);
  Report report{"lightcuts", effective(options), {}};
  Progress progress("lightcuts",
                    static_cast<std::int64_t>(options.scenes.size() * options.gazes_deg.size() *
                                              methods(options).size()));
  for (const std::string& scene : options.scenes) {
    if (auto ok = run_scene(scene, options, scheduler, progress, report.rows); !ok) return ok;
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  std::fputs("\nover all scenes and gazes\n", stdout);
  std::fputs(table_text(gains(report.rows)).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
