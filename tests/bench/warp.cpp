#include "tests/bench/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <thread>

#include "client/reprojection/warp.h"
#include "shared/metrics/error.h"
#include "tests/bench/report.h"
#include "tests/bench/reprojection_setting.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using base::forward;
using reprojection::Warper;
using reprojection::WarpOptions;

struct Way {
  const char* name;
  WarpOptions options;
};
const std::array<Way, 5> kWays{{
    {"every_cell", {.detail_px = 0.0F}},
    {"full", {}},
    {"bilinear", {.filter = WarpOptions::Filter::Bilinear}},
    {"grid", WarpOptions::grid_mode()},
    {"rotation", {.method = WarpOptions::Method::RotationOnly}},
}};

/// One eye's warper and picture, repeated.
struct Eye {
  Warper warper;
  image::Plane<Rgb8> shown;
  reprojection::WarpReport report;
};

struct Cost {
  double cpu_ms = INFINITY, wall_ms = INFINITY, wall_both_ms = INFINITY;
};

class CostRun {
 public:
  CostRun(const SourcePicture& source, const foveation::Display& display, const Pose& to,
          int repetitions)
      : source_(source), display_(display), to_(to), repetitions_(repetitions) {}

  Cost measure(const WarpOptions& options) {
    Cost cost;
    warp(eyes_[1], options);
    for (int i = 0; i < repetitions_; ++i) {
      Stopwatch watch;
      warp(eyes_[0], options);
      const Lap one = watch.lap();
      {
        const std::jthread other([&] { warp(eyes_[1], options); });
        warp(eyes_[0], options);
      }
      cost.cpu_ms = std::min(cost.cpu_ms, one.cpu_ms);
      cost.wall_ms = std::min(cost.wall_ms, one.wall_ms);
      cost.wall_both_ms = std::min(cost.wall_both_ms, watch.lap().wall_ms);
    }
    return cost;
  }
  const Eye& eye() const { return eyes_[0]; }

 private:
  void warp(Eye& eye, const WarpOptions& options) {
    eye.report = eye.warper.warp(source_.view(), to_, display_, options, eye.shown);
  }

  const SourcePicture& source_;
  const foveation::Display& display_;
  const Pose to_;
  const int repetitions_;
  std::array<Eye, 2> eyes_;
};

Result<PixelGrid> grid_of(const std::string& name, const foveation::Display& display,
                          double guard_deg) {
  if (name == "uniform") return guarded_raster(display, Degrees{guard_deg});
  if (name != "foveal") {
    return base::bad_input("unknown grid '" + name + "'", "--grids", "allowed: uniform, foveal");
  }
  const auto model = foveation::find_rate_model("cortical");
  if (!model) return forward(model);
  return foveation::make_foveal_grid(display, {}, *model, {.guard_band = Degrees{guard_deg}});
}

bool is_wanted(const WarpCostOptions& options, const Way& way) {
  return options.methods.empty() || std::ranges::count(options.methods, way.name) > 0;
}

double psnr_db(const image::Plane<Rgb8>& a, const image::Plane<Rgb8>& b) {
  return metrics::psnr_db(metrics::unit_from_8bit(a), metrics::unit_from_8bit(b));
}

Result<void> add_rows(const WarpCostOptions& options, const std::string& scene, Report& report) {
  auto setting = ReprojectionSetting::create(scene, "lambert", options.threads);
  if (!setting) return forward(setting);
  const double aspect = static_cast<double>(options.width_px) / options.height_px;
  const foveation::Display display{math::symmetric_fov(Degrees{options.vertical_fov_deg}, aspect),
                                   options.width_px, options.height_px};
  const Pose& from = setting->stage_from_camera();
  const DQuat turn =
      glm::angleAxis(Radians{Degrees{2.5}}.value(), glm::normalize(DVec3{0.3, 1.0, 0.2}));
  const Pose to{from.position + from.rotation * DVec3{0.01, 0.004, -0.005},
                glm::normalize(from.rotation * turn)};
  for (const std::string& name : options.grids) {
    const auto grid = grid_of(name, display, options.guard_deg);
    if (!grid) return forward(grid);
    const SourcePicture source = setting->render(from, *grid);
    CostRun run(source, display, to, options.repetitions);
    image::Plane<Rgb8> best;
    for (const Way& way : kWays) {
      if (!is_wanted(options, way)) continue;
      const Cost cost = run.measure(way.options);
      if (best.empty()) best = run.eye().shown;
      report.rows.push_back({{"scene", std::filesystem::path(scene).stem().string()},
                             {"grid", name},
                             {"method", way.name},
                             {"width_px", std::int64_t{options.width_px}},
                             {"height_px", std::int64_t{options.height_px}},
                             {"cells", static_cast<std::int64_t>(source.color.size())},
                             {"filled_pct", 100.0 * run.eye().report.filled_share()},
                             {"cpu_ms", cost.cpu_ms},
                             {"wall_ms", cost.wall_ms},
                             {"wall_both_ms", cost.wall_both_ms},
                             {"psnr_db", psnr_db(best, run.eye().shown)}});
    }
  }
  return {};
}

}  // namespace

Result<void> run_warp_cost(const WarpCostOptions& options) {
  Report report{"warp",
                {{"vertical_fov_deg", options.vertical_fov_deg},
                 {"guard_deg", options.guard_deg},
                 {"repetitions", std::int64_t{options.repetitions}}},
                {}};
  for (const std::string& scene : options.scenes) {
    if (const auto done = add_rows(options, scene, report); !done) return forward(done);
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
