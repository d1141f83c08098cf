#include "tests/bench/sphere.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <type_traits>

#include "server/kernels/sphere/sphere_kernel.h"
#include "server/scene/load.h"
#include "shared/base/text.h"
#include "shared/foveation/eccentricity.h"
#include "shared/image/draw.h"
#include "shared/image/png.h"
#include "shared/metrics/flip.h"
#include "shared/metrics/ssim.h"
#include "tests/bench/fma_rate.h"
#include "tests/bench/primitive_scenes.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/sphere_method.h"

namespace macula::bench {
namespace {

using image::Plane;
using kernels::ViewBuffers;

/// The paper's headset: about 98 degrees high an eye, 63 mm between the eyes.
constexpr double kVerticalFov_deg = 98.0;
constexpr double kEyeDistance_m = 0.063;
constexpr double kFramesPerSecond = 90.0;
/// How fast the head turns to and fro on top of the scene's own camera.
constexpr double kTurn_deg = 8.0, kTurnPeriod_s = 1.6;

class Stopwatch {
 public:
  double cpu_ms() const { return 1e3 * static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC; }
  double wall_ms() const { return units::to_ms(std::chrono::steady_clock::now() - wall_); }

 private:
  std::clock_t cpu_ = std::clock();
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
};

foveation::Display display_of(const SphereOptions& options) {
  return {math::symmetric_fov(Degrees{kVerticalFov_deg},
                              static_cast<double>(options.width_px) / options.height_px),
          options.width_px, options.height_px};
}

/// A scene at the moments of a run.
class Run {
 public:
  static Result<Run> create(const std::string& name) {
    if (const auto count = primitive_count(name)) return Run(primitive_scene(*count));
    auto scene = scene::load_scene(name);
    if (!scene) return base::forward(scene);
    if ((*scene)->field == nullptr || (*scene)->cameras.empty()) {
      return base::bad_input(
          "is no distance field with a camera", name,
          "a distance field: primitives, columns, temple, primitives-N or FILE.sdf.json");
    }
    return Run(std::move(*scene));
  }
  Result<std::shared_ptr<const kernels::SceneFrame>> frame(int index) const {
    return kernels::SceneFrame::create(scene_, scene::SceneTime{units::from_s(seconds(index))});
  }
  /// The scene's camera "walk", else its first, with a turning head.
  std::vector<kernels::View> views(const kernels::SceneFrame& frame, const PixelGrid& grid,
                                   int count) const {
    Pose head = frame.pose().world_from_view[camera()];
    const double turn = Radians{Degrees{kTurn_deg}}.value() *
                        std::sin(2.0 * std::numbers::pi * seconds_in(frame) / kTurnPeriod_s);
    head.rotation = head.rotation * glm::angleAxis(turn, DVec3{0.0, 1.0, 0.0});
    std::vector<kernels::View> views;
    for (int v = 0; v < count; ++v) {
      const double side = count == 1 ? 0.0 : (v == 0 ? -0.5 : 0.5) * kEyeDistance_m;
      kernels::View view;
      view.world_from_view = head * Pose{DVec3{side, 0.0, 0.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
      view.grid = grid;
      view.tone = scene_->settings.tone;
      views.push_back(std::move(view));
    }
    return views;
  }

 private:
  explicit Run(std::shared_ptr<const scene::Scene> scene) : scene_(std::move(scene)) {}
  std::size_t camera() const {
    const auto walk = std::ranges::find(scene_->cameras, "walk", &scene::Camera::name);
    return walk == scene_->cameras.end() ? 0
                                         : static_cast<std::size_t>(walk - scene_->cameras.begin());
  }
  static double seconds(int index) { return 1.0 + index / kFramesPerSecond; }
  static double seconds_in(const kernels::SceneFrame& frame) {
    return std::chrono::duration<double>(frame.time().since_start).count();
  }
  std::shared_ptr<const scene::Scene> scene_;
};

/// What one method made of a run: costs are means over its frames, per frame.
struct Measured {
  double cpu_ms = 0.0, wall_ms = 0.0;
  double evaluations = 0.0, operations = 0.0;
  std::map<int, ViewBuffers> pictures;  ///< the first view, by frame index
};

std::vector<int> key_frames(const SphereOptions& options) {
  std::vector<int> frames;
  for (int k = 1; k <= options.key_frames; ++k)
    frames.push_back(k * options.frames / options.key_frames - 1);
  return frames;
}

Result<Measured> measure(const SphereCase& row, const Run& run, const SphereOptions& options,
                         kernels::TileScheduler& scheduler) {
  const auto config = sphere_config(row);
  if (!config) return base::forward(config);
  const kernels::sphere::SphereKernel kernel(*config);
  const PixelGrid grid = foveation::make_uniform_grid(display_of(options));
  const std::vector<int> keys = key_frames(options);
  kernels::History history;
  kernels::FrameBuffers buffers;
  buffers.wanted = options.pictures.empty() ? 0U : unsigned{kernels::kSteps};
  Measured result;
  int count = 0;
  for (int i = 0; i < options.frames; ++i) {
    const bool is_key = std::ranges::count(keys, i) > 0;
    if (!is_key && row.refresh == 1) continue;  // without memory a frame is like any other
    const auto frame = run.frame(i);
    if (!frame) return base::forward(frame);
    const auto views = run.views(**frame, grid, row.views);
    const FoveationMap map(std::vector<FoveationMap::ViewInput>(
                               views.size(), {grid, {}, display_of(options).pixel_tangent()}),
                           foveation::RateModel{});
    Stopwatch watch;
    const auto report = kernel.render({views, map, static_cast<std::uint64_t>(i), 1}, **frame,
                                      history, scheduler, buffers);
    // The first frame of a method with a memory has none yet.
    if (i > 0 || options.frames == 1) {
      result.cpu_ms += watch.cpu_ms(), result.wall_ms += watch.wall_ms();
      result.evaluations += static_cast<double>(report.field_evaluations);
      result.operations += static_cast<double>(report.field_operations);
      ++count;
    }
    if (is_key) result.pictures[i] = buffers.views.front();
  }
  result.cpu_ms /= count, result.wall_ms /= count;
  result.evaluations /= count, result.operations /= count;
  return result;
}

/// Quality of a picture against that of `full`, means over key frames.
struct Quality {
  double ssim = 0.0, flip = 0.0, flip_fovea = 0.0, wrong_hits = 0.0;
};

Plane<Rgb> shown(const Plane<Rgb>& radiance, const image::Tone& tone) {
  Plane<Rgb8> encoded;
  image::encode(tone, radiance, encoded);
  return image::decode_display_linear(encoded);
}
Plane<Rgb> encoded_values(const Plane<Rgb>& linear) {
  Plane<Rgb> out(linear.width(), linear.height());
  std::ranges::transform(linear.pixels(), out.pixels().begin(), [](const Rgb& c) {
    return Rgb{image::srgb_from_linear(c.x), image::srgb_from_linear(c.y),
               image::srgb_from_linear(c.z)};
  });
  return out;
}

/// Cells where one hits and the other does not, or whose depths differ by more than 1 %.
double wrong_hits(const Plane<float>& reference, const Plane<float>& test) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const float a = reference.pixels()[i], b = test.pixels()[i];
    const bool same = std::isinf(a) || std::isinf(b) ? std::isinf(a) == std::isinf(b)
                                                     : std::abs(a - b) <= 0.01F * a;
    wrong += same ? 0 : 1;
  }
  return static_cast<double>(wrong) / static_cast<double>(reference.size());
}

/// FLIP of the fovea alone: what lies around it is made equal, or FLIP's filters would carry it in.
double flip_in_fovea(const Plane<Rgb>& reference, const Plane<Rgb>& test, const PixelGrid& grid,
                     double fovea_deg, double pixels_per_degree) {
  Plane<Rgb> fovea = reference;
  std::vector<std::size_t> inside;
  bool differs = false;
  for (int y = 0; y < test.height(); ++y) {
    for (int x = 0; x < test.width(); ++x) {
      const Degrees e{foveation::eccentricity(Gaze{}.direction, grid.ray(x, y))};
      if (e.value() > fovea_deg) continue;
      inside.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(test.width()) +
                       static_cast<std::size_t>(x));
      differs = differs || test(x, y) != reference(x, y);
      fovea(x, y) = test(x, y);
    }
  }
  if (!differs) return 0.0;
  const Plane<float> flip = metrics::flip_map(reference, fovea, pixels_per_degree);
  double sum = 0.0;
  for (const std::size_t i : inside) sum += flip.pixels()[i];
  return sum / static_cast<double>(inside.size());
}

Quality compare(const Measured& reference, const Measured& test, const SphereCase& row,
                const SphereOptions& options, const image::Tone& tone) {
  Quality quality;
  const foveation::Display display = display_of(options);
  const PixelGrid grid = foveation::make_uniform_grid(display);
  const double share = 1.0 / static_cast<double>(test.pictures.size());
  const double fovea = row.foveated() ? row.fovea_deg : 7.5;
  for (const auto& [index, picture] : test.pictures) {
    const ViewBuffers& ideal = reference.pictures.at(index);
    const Plane<Rgb> a = shown(ideal.radiance, tone), b = shown(picture.radiance, tone);
    const Plane<float> flip = metrics::flip_map(a, b, display.pixels_per_degree());
    quality.ssim += share * metrics::ssim_luma(encoded_values(a), encoded_values(b));
    quality.flip += share * metrics::summarise(flip).mean;
    quality.flip_fovea += share * flip_in_fovea(a, b, grid, fovea, display.pixels_per_degree());
    quality.wrong_hits += share * wrong_hits(ideal.depth_m, picture.depth_m);
  }
  return quality;
}

// ---- rows ----

std::string name_of(const SphereCase& row) {
  const std::string scene = std::filesystem::path(row.scene).filename().string();
  return base::concat(scene, "_", row.method, "_", row.fovea_deg, "deg_", row.samples, "spp_",
                      row.refresh, "_", row.edges, "_", row.views);
}

std::vector<SphereCase> cases_of(const SphereOptions& options, const std::string& scene,
                                 int samples, int views) {
  std::vector<SphereCase> cases;
  for (const std::string& method : options.methods) {
    SphereCase row{scene, method, 0.0, samples, 1, "none", views};
    if (!row.foveated()) {
      cases.push_back(row);
      continue;
    }
    for (const std::string& edges : options.edges)
      for (const double fovea : options.fovea_deg)
        for (const int refresh : options.refresh)
          cases.push_back({scene, method, fovea, samples, refresh, edges, views});
  }
  return cases;
}

Fields fields_of(const SphereCase& row, const Measured& measured, const Quality& quality,
                 double full_cpu_ms, double best_cpu_ms, double fma_rate,
                 const SphereOptions& options) {
  const double pixels = static_cast<double>(options.width_px) * options.height_px * row.views;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  return {{"scene", row.scene},
          {"method", row.method},
          {"fovea_deg", row.fovea_deg},
          {"ssaa", std::int64_t{row.samples}},
          {"refresh", 1.0 / row.refresh},
          {"edges", row.edges},
          {"views", std::int64_t{row.views}},
          {"evals_per_px", measured.evaluations / pixels},
          {"evals_s", 1e3 * measured.evaluations / measured.cpu_ms},
          {"fma_share", 1e3 * measured.operations / measured.cpu_ms / fma_rate},
          {"cpu_ms", measured.cpu_ms},
          {"wall_ms", measured.wall_ms},
          {"speedup", full_cpu_ms / measured.cpu_ms},
          {"speedup_best", best_cpu_ms > 0.0 ? best_cpu_ms / measured.cpu_ms : nothing},
          {"ssim", quality.ssim},
          {"flip", quality.flip},
          {"flip_fovea", quality.flip_fovea},
          {"wrong_hits", quality.wrong_hits}};
}

template <class T>
T field(const Fields& row, const std::string& key) {
  const auto found = std::ranges::find(row, key, &Fields::value_type::first);
  if (found == row.end()) return T{};
  if constexpr (std::is_same_v<T, double>) {
    if (const auto* whole = std::get_if<std::int64_t>(&found->second))
      return static_cast<double>(*whole);
  }
  const T* value = std::get_if<T>(&found->second);
  return value != nullptr ? *value : T{};
}

bool is_row_of(const Fields& fields, const SphereCase& row) {
  return field<std::string>(fields, "scene") == row.scene &&
         field<std::string>(fields, "method") == row.method &&
         field<std::string>(fields, "edges") == row.edges &&
         field<double>(fields, "fovea_deg") == row.fovea_deg &&
         field<double>(fields, "ssaa") == row.samples &&
         std::lround(1.0 / field<double>(fields, "refresh")) == row.refresh &&
         field<double>(fields, "views") == row.views;
}

Result<void> write_pictures(const SphereCase& row, const Measured& measured,
                            const SphereOptions& options, const image::Tone& tone) {
  if (options.pictures.empty()) return {};
  const std::filesystem::path folder(options.pictures);
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const ViewBuffers& last = measured.pictures.rbegin()->second;
  Plane<Rgb8> picture;
  image::encode(tone, last.radiance, picture);
  const auto file = [&](const char* suffix) { return (folder / (name_of(row) + suffix)).string(); };
  if (auto ok = image::write_png(file(".png"), picture); !ok) return base::forward(ok);
  constexpr float kMostSteps = 64.0F;
  return image::write_png(file("_steps.png"), image::false_color(last.steps, 0.0F, kMostSteps));
}

/// Measures the missing rows of one group: the same scene, samples and views, one baseline.
class Group {
 public:
  Group(const SphereOptions& options, const Run& run, kernels::TileScheduler& scheduler,
        Report& report)
      : options_(options), run_(run), scheduler_(scheduler), report_(report) {}

  Result<void> measure_all(const std::vector<SphereCase>& cases, const image::Tone& tone,
                           Progress& progress) {
    const auto missing = [&](const SphereCase& row) {
      return std::ranges::none_of(report_.rows,
                                  [&](const Fields& fields) { return is_row_of(fields, row); });
    };
    if (std::ranges::none_of(cases, missing)) {
      progress.advance(static_cast<std::int64_t>(cases.size()));
      return {};
    }
    SphereCase baseline = cases.front();
    baseline.method = "full", baseline.fovea_deg = 0.0, baseline.refresh = 1;
    baseline.edges = "none";
    const auto full = measure(baseline, run_, options_, scheduler_);
    if (!full) return base::forward(full);
    double best_cpu_ms = 0.0;
    for (const SphereCase& row : cases) {
      progress.advance();
      const bool is_full = row.method == "full";
      if (!missing(row) && row.method != "full_best") continue;
      const double fma_rate = fma_lanes_per_cpu_s(scheduler_);
      const auto measured = is_full ? full : measure(row, run_, options_, scheduler_);
      if (!measured) return base::forward(measured);
      if (row.method == "full_best") best_cpu_ms = measured->cpu_ms;
      if (!missing(row)) continue;
      const Quality quality = compare(*full, *measured, row, options_, tone);
      report_.rows.push_back(
          fields_of(row, *measured, quality, full->cpu_ms, best_cpu_ms, fma_rate, options_));
      if (auto ok = write_pictures(row, *measured, options_, tone); !ok) return ok;
      if (options_.json.empty()) continue;
      if (auto ok = write_json(options_.json, report_); !ok) return ok;
    }
    return {};
  }

 private:
  const SphereOptions& options_;
  const Run& run_;
  kernels::TileScheduler& scheduler_;
  Report& report_;
};

Fields config_of(const SphereOptions& options) {
  return {{"width_px", std::int64_t{options.width_px}},
          {"height_px", std::int64_t{options.height_px}},
          {"vertical_fov_deg", kVerticalFov_deg},
          {"frames", std::int64_t{options.frames}},
          {"key_frames", std::int64_t{options.key_frames}},
          {"frames_per_s", kFramesPerSecond},
          {"threads", std::int64_t{options.threads}}};
}

}  // namespace

void make_quick(SphereOptions& options) {
  options.width_px = 1234, options.height_px = 1370;
  options.fovea_deg = {2.5, 7.5, 15.0};
  options.samples = {1, 16};
  options.refresh = {1, 4};
  options.frames = 8, options.key_frames = 1;
}

Result<void> run_sphere(const SphereOptions& options) {
  Report report{"sphere", config_of(options), {}};
  if (!options.json.empty()) {
    auto known = read_rows(options.json, report);
    if (!known) return base::forward(known);
    report.rows = std::move(*known);
  }
  kernels::TileScheduler scheduler(options.threads);
  std::int64_t total = 0;
  for (const int samples : options.samples)
    total += static_cast<std::int64_t>(cases_of(options, "", samples, 1).size() *
                                       options.views.size() * options.scenes.size());
  Progress progress("measuring", total);
  for (const std::string& name : options.scenes) {
    const auto run = Run::create(name);
    if (!run) return base::forward(run);
    const auto first = run->frame(0);
    if (!first) return base::forward(first);
    for (const int views : options.views) {
      for (const int samples : options.samples) {
        Group group(options, *run, scheduler, report);
        const auto done = group.measure_all(cases_of(options, name, samples, views),
                                            (*first)->scene().settings.tone, progress);
        if (!done) return done;
      }
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return {};
}

}  // namespace macula::bench
