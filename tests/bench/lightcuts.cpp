#include "tests/bench/lightcuts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "shared/image/draw.h"
#include "shared/image/png.h"
#include "tests/bench/curve.h"
#include "tests/bench/lightcuts_setting.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"

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
};

std::vector<Method> methods(bool quick) {
  using kernels::lightcuts::Denoise;
  std::vector<Method> all;
  for (int nodes = 1; nodes <= (quick ? 32 : 64); nodes *= 2) {
    all.push_back({"sl", uniform_cuts(nodes), Curves::Itself});
    all.push_back({"sl_denoised", denoised_cuts(nodes), Curves::Itself});
  }
  all.push_back({"sl_as", perceived_cuts(PerceptionMode::Stengel)});
  all.push_back({"paper_no_reuse", perceived_cuts(PerceptionMode::Attenuation)});
  all.push_back({"paper", paper_cuts()});
  all.push_back({"ours_exact", reservoir_cuts(Denoise::No), Curves::Plain, true});
  all.push_back({"ours", reservoir_cuts(Denoise::Yes), Curves::Denoised, true});
  return all;
}

/// What a method did, means over its frames.
struct Measured {
  double cpu_ms = 0.0, wall_ms = 0.0, fpsm_ms = 0.0, denoise_ms = 0.0, samples = 0.0;
  double mean_lspp = 0.0;  ///< nodes that cuts were allowed, a pixel
  double reuse = 0.0;      ///< share of nodes whose light another pixel had drawn
  Regional lspp;
  LightcutsErrors errors;
};

Plane<float> as_floats(const Plane<std::uint16_t>& nodes) {
  Plane<float> plane(nodes.width(), nodes.height());
  std::ranges::copy(nodes.pixels(), plane.pixels().begin());
  return plane;
}

double mean_of(const Plane<float>& plane) {
  double sum = 0.0;
  for (const float value : plane.pixels()) sum += static_cast<double>(value);
  return sum / static_cast<double>(plane.size());
}

template <class Value>
double or_nan(const std::optional<double>& value, const Value& then) {
  return value ? then(*value) : std::nan("");
}

/// Seeds of frames that are not judged.
constexpr int kWarmUpSeed = 10'000;

class Run {
 public:
  Run(const LightcutsSetting& setting, const LightcutsJudge& judge, const LightcutsOptions& options,
      TileScheduler& scheduler)
      : setting_(setting), judge_(judge), options_(options), scheduler_(scheduler) {}

  void measure(const Method& method) {
    Measured all;
    sizes_of(method, all);
    const auto frames = static_cast<double>(options_.frames);
    kernels::History history;
    const int warm_up = method.remembers ? options_.warm_up : 0;
    for (int k = -warm_up; k < options_.frames; ++k) {
      if (!method.remembers) history = {};
      const auto seed = static_cast<std::uint64_t>(k < 0 ? kWarmUpSeed - k : k + 1);
      const Picture one = picture_of(setting_, method.config, seed, history, scheduler_);
      if (k < 0) continue;
      all.cpu_ms += one.cpu_ms / frames, all.wall_ms += one.wall_ms / frames;
      all.fpsm_ms += one.report.mask_ms / frames;
      all.denoise_ms += one.report.post_ms / frames;
      all.samples += static_cast<double>(one.report.shadow_rays) / frames;
      const auto taken = static_cast<double>(one.report.taken_nodes);
      const auto nodes = taken + static_cast<double>(one.report.walked_nodes);
      if (nodes > 0.0) all.reuse += taken / nodes / frames;
      add(judge_.errors(one.radiance), 1.0 / frames, all.errors);
      if (k == 0) keep(method, one.radiance);
    }
    measured_.push_back({method, all});
  }

  std::vector<Fields> rows() const {
    std::vector<Fields> rows;
    for (const Row& row : measured_) rows.push_back(fields(row));
    return rows;
  }

 private:
  struct Row {
    Method method;
    Measured measured;
  };

  static void add(const LightcutsErrors& one, double share, LightcutsErrors& sum) {
    sum.mse.f25 += share * one.mse.f25, sum.mse.out25 += share * one.mse.out25;
    sum.relmse.f25 += share * one.relmse.f25, sum.relmse.out25 += share * one.relmse.out25;
  }

  void sizes_of(const Method& method, Measured& all) {
    if (method.config.sizes == CutSizes::Uniform) {
      all.mean_lspp = method.config.ray.area_light_samples;
      all.lspp = {all.mean_lspp, all.mean_lspp};
      return;
    }
    const auto plan = plan_of(setting_, method.config, scheduler_);
    const Plane<float> nodes = as_floats(plan.cut_nodes.front());
    all.mean_lspp = mean_of(nodes);
    all.lspp = judge_.mean(nodes);
  }

  void keep(const Method& method, const Plane<Rgb>& radiance) const {
    if (options_.pictures.empty()) return;
    Plane<Rgb8> shown;
    image::encode(setting_.view.tone, radiance, shown);
    const std::string name =
        method.against == Curves::Itself
            ? method.name + "_" + std::to_string(method.config.ray.area_light_samples)
            : method.name;
    if (!image::write_png(options_.pictures + "/" + name + ".png", shown)) {
      std::fprintf(stderr, "%s: cannot be written\n", name.c_str());
    }
  }

  template <class Error>
  Curve curve(const std::string& baseline, const Error& error_of, bool time_from_error) const {
    std::vector<Curve::Point> points;
    for (const Row& row : measured_) {
      if (row.method.name != baseline) continue;
      const double time = row.measured.cpu_ms, error = error_of(row.measured);
      points.push_back(time_from_error ? Curve::Point{error, time} : Curve::Point{time, error});
    }
    return Curve(std::move(points));
  }

  static std::string baseline_of(const Method& method) {
    if (method.against == Curves::Itself) return method.name;
    return method.against == Curves::Plain ? "sl" : "sl_denoised";
  }

  Fields fields(const Row& row) const {
    const Measured& m = row.measured;
    const auto inside = [](const Measured& one) { return one.errors.mse.f25; };
    const auto outside = [](const Measured& one) { return one.errors.mse.out25; };
    const std::string baseline = baseline_of(row.method);
    const double gain_f25 = or_nan(curve(baseline, inside, false).at(m.cpu_ms),
                                   [&](double sl) { return sl / inside(m); });
    const double gain_out25 = or_nan(curve(baseline, outside, false).at(m.cpu_ms),
                                     [&](double sl) { return sl / outside(m); });
    const double speed_f25 = or_nan(curve(baseline, inside, true).at(inside(m)),
                                    [&](double sl) { return sl / m.cpu_ms; });
    return {{"scene", options_.scene},
            {"lights", static_cast<std::int64_t>(setting_.lights)},
            {"gaze", std::string("0,0")},
            {"method", row.method.name},
            {"against", baseline},
            {"cpu_ms", m.cpu_ms},
            {"wall_ms", m.wall_ms},
            {"mean_lspp", m.mean_lspp},
            {"lspp_f25", m.lspp.f25},
            {"lspp_out25", m.lspp.out25},
            {"mse_f25", m.errors.mse.f25},
            {"mse_out25", m.errors.mse.out25},
            {"relmse_f25", m.errors.relmse.f25},
            {"relmse_out25", m.errors.relmse.out25},
            {"fpsm_ms", m.fpsm_ms},
            {"denoise_ms", m.denoise_ms},
            {"reuse", m.reuse},
            {"samples_s", m.samples / (1e-3 * m.cpu_ms)},
            {"gain_f25", gain_f25},
            {"gain_out25", gain_out25},
            {"speed_f25", speed_f25}};
  }

  const LightcutsSetting& setting_;
  const LightcutsJudge& judge_;
  const LightcutsOptions& options_;
  TileScheduler& scheduler_;
  std::vector<Row> measured_;
};

/// Every mode's map at the mean number of samples that the default has, in false colour.
Result<void> write_maps(const LightcutsSetting& setting, const std::string& folder,
                        TileScheduler& scheduler) {
  const auto plan = plan_of(setting, perceived_cuts(PerceptionMode::Attenuation), scheduler);
  const double mean = mean_of(as_floats(plan.cut_nodes.front()));
  struct Named {
    const char* name;
    PerceptionMode mode;
  };
  for (const Named& one :
       {Named{"printed", PerceptionMode::Printed}, Named{"difference", PerceptionMode::Difference},
        Named{"attenuation", PerceptionMode::Attenuation},
        Named{"stengel", PerceptionMode::Stengel}}) {
    Config config = perceived_cuts(one.mode);
    config.mean_nodes = mean;
    const auto made = plan_of(setting, config, scheduler);
    const auto most = static_cast<float>(config.most_nodes);
    auto ok = image::write_png(folder + "/map_" + one.name + ".png",
                               image::false_color(as_floats(made.cut_nodes.front()), 0.0F, most));
    if (!ok) return ok;
  }
  const auto& map = plan.maps.front();
  if (auto ok = image::write_png(folder + "/feature_spatial.png",
                                 image::false_color(map.spatial, 0.0F, 1.0F));
      !ok) {
    return ok;
  }
  return image::write_png(folder + "/feature_luminance.png",
                          image::false_color(map.luminance, 0.0F, 1.0F));
}

LightcutsOptions quickened(LightcutsOptions options) {
  if (!options.quick) return options;
  options.reference_nodes = std::min(options.reference_nodes, 96);
  options.reference_passes = 1;
  options.frames = 1;
  options.warm_up = std::min(options.warm_up, 6);
  return options;
}

Fields effective(const LightcutsOptions& options, const LightcutsJudge& judge) {
  return {{"scene", options.scene},
          {"quick", options.quick},
          {"frames", std::int64_t{options.frames}},
          {"warm_up", std::int64_t{options.warm_up}},
          {"reference_nodes", std::int64_t{options.reference_nodes}},
          {"reference_passes", std::int64_t{options.reference_passes}},
          {"share_of_f25", judge.share_of_f25()}};
}

}  // namespace

Result<void> run_lightcuts(const LightcutsOptions& asked) {
  const LightcutsOptions options = quickened(asked);
  TileScheduler scheduler(options.threads);
  const auto setting = LightcutsSetting::make(options.scene, options.quick, scheduler);
  if (!setting) return base::forward(setting);
  if (!options.pictures.empty()) {
    std::error_code ignored;  // a folder that cannot be made shows when it is written to
    std::filesystem::create_directories(options.pictures, ignored);
    if (auto ok = write_maps(*setting, options.pictures, scheduler); !ok) return ok;
  }
  const LightcutsJudge judge(*setting, options.reference_nodes, options.reference_passes,
                             scheduler);
  Run run(*setting, judge, options, scheduler);
  const std::vector<Method> all = methods(options.quick);
  Progress progress("lightcuts", static_cast<std::int64_t>(all.size()));
  for (const Method& method : all) {
    run.measure(method);
    progress.advance();
  }
  const Report report{"lightcuts", effective(options, judge), run.rows()};
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
