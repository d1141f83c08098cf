#include "tests/bench/lightcuts_stereo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "shared/image/png.h"
#include "tests/bench/lightcuts_setting.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using kernels::lightcuts::Config;
using kernels::lightcuts::StereoReuse;
using scheduling::TileScheduler;

constexpr double kEyes_m = 0.063;

struct Method {
  const char* name;
  Config config;
};
std::vector<Method> methods(const std::vector<std::string>& asked) {
  using kernels::lightcuts::Denoise;
  Config paper_denoised = paper_cuts();
  paper_denoised.denoise = Denoise::Yes;
  std::vector<Method> all{{"sl_denoised", denoised_cuts(1)},
                          {"paper", paper_cuts()},
                          {"paper_denoised", paper_denoised},
                          {"ours", reservoir_cuts(Denoise::Yes)}};
  std::erase_if(all, [&](const Method& method) {
    return !asked.empty() && std::ranges::find(asked, method.name) == asked.end();
  });
  return all;
}

/// The setting seen by an eye, 0 or 1, of a head where its own was.
LightcutsSetting eye_of(LightcutsSetting setting, int eye) {
  const Pose& head = setting.view.world_from_view;
  setting.view.world_from_view = head * Pose{{(eye - 0.5) * kEyes_m, 0.0, 0.0}, {}};
  return setting;
}

struct Pair {
  Plane<Rgb> left, right;
  kernels::FrameReport report;
  double cpu_ms = 0.0;
};
Pair pair_of(const LightcutsSetting& head, const Config& config, std::uint64_t seed,
             kernels::History& history, TileScheduler& scheduler) {
  const std::array views{eye_of(head, 0).view, eye_of(head, 1).view};
  std::vector<FoveationMap::ViewInput> parts;
  for (const kernels::View& view : views)
    parts.push_back({view.grid, view.gaze, head.display.pixel_tangent()});
  const FoveationMap map{std::move(parts), {}};
  kernels::FrameBuffers out;
  const kernels::lightcuts::LightcutsKernel kernel(config);
  Stopwatch watch;
  Pair pair;
  pair.report = kernel.render({views, map, 0, seed}, *head.scene, history, scheduler, out);
  pair.cpu_ms = watch.lap().cpu_ms;
  pair.left = std::move(out.views[0].radiance), pair.right = std::move(out.views[1].radiance);
  return pair;
}

/// Means over the judged frames.
struct Measured {
  double cpu_ms = 0.0, reproject_ms = 0.0, lit = 0.0;
  Regional left, right;              ///< mean squared errors, display-linear
  std::vector<Regional> right_each;  ///< a frame each

  void add(const Pair& pair, const LightcutsErrors& left_eye, const LightcutsErrors& right_eye,
           double share) {
    cpu_ms += share * pair.cpu_ms, reproject_ms += share * pair.report.reproject_ms;
    lit += share * static_cast<double>(pair.report.resampled_cells) /
           static_cast<double>(pair.right.size());
    left.f25 += share * left_eye.mse.f25, left.out25 += share * left_eye.mse.out25;
    right.f25 += share * right_eye.mse.f25, right.out25 += share * right_eye.mse.out25;
    right.f10 += share * right_eye.mse.f10;
    right_each.push_back(right_eye.mse);
  }
  /// Standard error of the right eye's RMSE in a region, over the frames; NaN of one frame. Frames
  /// that share a memory differ less than others.
  double noise(double Regional::*region) const {
    const auto n = static_cast<double>(right_each.size());
    double square = 0.0;
    for (const Regional& each : right_each) square += std::pow(each.*region - right.*region, 2);
    return std::sqrt(square / (n - 1.0) / n) / (2.0 * std::sqrt(right.*region));
  }
};

class Scene {
 public:
  Scene(std::string name, LightcutsSetting setting, const LightcutsOptions& options,
        TileScheduler& scheduler)
      : name_(std::move(name)),
        setting_(std::move(setting)),
        options_(options),
        scheduler_(scheduler),
        left_(eye_of(setting_, 0), references_of(options), scheduler),
        right_(eye_of(setting_, 1), references_of(options), scheduler) {}

  Result<void> measure(const Method& method, std::vector<Fields>& rows) const {
    double alone_ms = 0.0;
    for (const StereoReuse stereo : {StereoReuse::No, StereoReuse::Yes}) {
      Config config = method.config;
      config.stereo = stereo, config.gloss = setting_.gloss;
      const auto measured = measure(config, label(method, stereo));
      if (!measured) return base::forward(measured);
      if (stereo == StereoReuse::No) alone_ms = measured->cpu_ms;
      rows.push_back({{"scene", name_},
                      {"method", std::string(method.name)},
                      {"stereo_reuse", stereo == StereoReuse::Yes},
                      {"cpu_ms", measured->cpu_ms},
                      {"of_both_lit", measured->cpu_ms / alone_ms},
                      {"reproject_ms", measured->reproject_ms},
                      {"lit_share", stereo == StereoReuse::Yes ? measured->lit : 1.0},
                      {"rmse_left_f25", std::sqrt(measured->left.f25)},
                      {"rmse_left_out25", std::sqrt(measured->left.out25)},
                      {"rmse_right_f10", std::sqrt(measured->right.f10)},
                      {"noise_f10", measured->noise(&Regional::f10)},
                      {"rmse_right_f25", std::sqrt(measured->right.f25)},
                      {"noise_f25", measured->noise(&Regional::f25)},
                      {"rmse_right_out25", std::sqrt(measured->right.out25)}});
    }
    return {};
  }

 private:
  static std::string label(const Method& method, StereoReuse stereo) {
    return std::string(method.name) + (stereo == StereoReuse::Yes ? "_reused" : "_lit");
  }

  Result<Measured> measure(const Config& config, const std::string& label) const {
    Measured measured;
    kernels::History history;
    constexpr int kSwing = LightcutsSetting::kSwing;
    const int warm_up = (options_.warm_up + kSwing - 1) / kSwing * kSwing;
    const int last = warm_up + kSwing * (options_.frames - 1);
    for (int k = 0; k <= last; ++k) {
      const auto head = setting_.moved(k);
      if (!head) return base::forward(head);
      const Pair pair =
          pair_of(*head, config, static_cast<std::uint64_t>(k + 1), history, scheduler_);
      if (k < warm_up || k % kSwing != 0) continue;
      measured.add(pair, left_.errors(pair.left), right_.errors(pair.right), 1.0 / options_.frames);
      if (k == last) {
        write("left_" + label, pair.left);
        write("right_" + label, pair.right);
      }
    }
    return measured;
  }
  void write(const std::string& name, const Plane<Rgb>& radiance) const {
    if (options_.pictures.empty()) return;
    const std::string path = options_.pictures + "/" +
                             std::filesystem::path(name_).stem().string() + "_" + name + ".png";
    Plane<Rgb8> shown;
    image::encode(setting_.view.tone, radiance, shown);
    if (!image::write_png(path, shown))
      std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
  }

  std::string name_;
  LightcutsSetting setting_;
  const LightcutsOptions& options_;
  TileScheduler& scheduler_;
  LightcutsJudge left_, right_;
};

}  // namespace

Result<void> run_lightcuts_stereo(const LightcutsOptions& options) {
  TileScheduler scheduler(options.threads);
  const std::vector<Method> all = methods(options.methods);
  Report report{"lightcuts-stereo", effective(options), {}};
  Progress progress("lightcuts", static_cast<std::int64_t>(options.scenes.size() * all.size()));
  if (!options.pictures.empty()) {
    std::error_code ignored;  // a folder that cannot be made shows when it is written to
    std::filesystem::create_directories(options.pictures, ignored);
  }
  for (const std::string& name : options.scenes) {
    auto setting = LightcutsSetting::make(name, options.quick, options.gloss, scheduler);
    if (!setting) return base::forward(setting);
    const Scene scene(name, std::move(*setting), options, scheduler);
    for (const Method& method : all) {
      if (auto ok = scene.measure(method, report.rows); !ok) return ok;
      progress.advance();
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
