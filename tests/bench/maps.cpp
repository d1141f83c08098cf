#include "tests/bench/maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/reprojection/warp.h"
#include "shared/codec/color.h"
#include "shared/metrics/error.h"
#include "shared/metrics/foveated.h"
#include "tests/bench/arguments.h"
#include "tests/bench/other_maps.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/reprojection_setting.h"

namespace macula::bench {
namespace {

using base::forward;

constexpr std::size_t kOthers = 4;  // the first of the grids compared; ours follow

struct NamedGrid {
  std::string name;
  PixelGrid grid;
};

/// Yaw to the right, pitch up.
Gaze gaze_towards(const StillGaze& angles) {
  const double yaw = Radians{angles.yaw}.value(), pitch = Radians{angles.pitch}.value();
  return {Vec3(std::cos(pitch) * std::sin(yaw), std::sin(pitch), -std::cos(pitch) * std::cos(yaw))};
}

PixelGrid uniform_quarter(const foveation::Display& display) {
  foveation::Display half = display;
  half.width_px /= 2;
  half.height_px /= 2;
  return foveation::make_uniform_grid(half);
}

/// Where the gaze meets the display, in [-1, 1] of each axis, y down.
DVec2 place_of(const foveation::Display& display, const Gaze& gaze) {
  const DVec2 tangent{math::tangent_from_direction(gaze.direction)};
  const DVec2 low = display.fov.tangent_min(), high = display.fov.tangent_max();
  return 2.0 * (tangent - low) / (high - low) - 1.0;
}

PixelGrid alvr_grid(const foveation::Display& display, const DVec2& at) {
  // Its centre may move as far as its edges leave room for.
  const AlvrAxis x{0.45, std::clamp(at.x / (1.0 - 0.45), -0.95, 0.95), 4.0};
  const AlvrAxis y{0.4, std::clamp(at.y / (1.0 - 0.4), -0.95, 0.95), 5.0};
  return grid_of_edges(display, alvr_edges(display.width_px, x), alvr_edges(display.height_px, y));
}

PixelGrid wivrn_grid(const foveation::Display& display, const DVec2& at, double share) {
  return grid_of_edges(display, wivrn_edges(display.width_px, {share, at.x}),
                       wivrn_edges(display.height_px, {share, at.y}));
}

foveation::RateModel cortical(double floor) {
  foveation::RateModel model;
  model.floor = floor;
  return model;
}

PixelGrid our_grid(const foveation::Display& display, const Gaze& gaze,
                   const foveation::RateModel& model, double radius_deg) {
  return foveation::make_foveal_grid(display, gaze, model,
                                     {.full_rate_radius = Degrees{radius_deg}});
}

/// Degrees as they are given: ramp-10-35.
std::string name_of(const foveation::RateModel& ramp) {
  char name[64];
  std::snprintf(name, sizeof name, "ramp-%g-%g", ramp.inner.value(), ramp.outer.value());
  return name;
}

Result<std::vector<NamedGrid>> grids_for(const foveation::Display& display, const Gaze& gaze,
                                         const std::vector<std::string>& ramps) {
  const DVec2 at = place_of(display, gaze);
  std::vector<NamedGrid> grids{{"uniform-25", uniform_quarter(display)},
                               {"alvr", alvr_grid(display, at)},
                               {"wivrn-50", wivrn_grid(display, at, 0.5)},
                               {"wivrn-30", wivrn_grid(display, at, 0.3)},
                               {"cortical", our_grid(display, gaze, cortical(0.02), 5.0)}};
  for (const std::string& words : ramps) {
    const auto model = parse_ramp("--ramps", words);
    if (!model) return forward(model);
    grids.push_back({name_of(*model), our_grid(display, gaze, *model, 0.0)});
  }
  return grids;
}

/// Bytes and quality at each of many JPEG qualities; both rise.
struct Curve {
  std::vector<double> bytes, db;

  double best_db() const { return *std::max_element(db.begin(), db.end()); }
  /// NaN where the curve never gets there.
  double bytes_at(double target_db) const {
    for (std::size_t i = 0; i < db.size(); ++i) {
      if (db[i] < target_db) continue;
      if (i == 0) return bytes[0];
      const double share = (target_db - db[i - 1]) / (db[i] - db[i - 1]);
      return std::exp(std::lerp(std::log(bytes[i - 1]), std::log(bytes[i]), share));
    }
    return NAN;
  }
  double db_at_85 = 0.0;
};

/// Judges pictures of one scene and gaze.
class Judge {
 public:
  Judge(ReprojectionSetting& setting, const foveation::Display& display, const Gaze& gaze)
      : setting_(setting), display_(display) {
    const SourcePicture truth =
        setting.render(setting.stage_from_camera(), foveation::make_uniform_grid(display));
    truth_ = metrics::unit_from_8bit(truth.color);
    const DVec2 pixel = display.pixel_tangent(), low = display.fov.tangent_min();
    view_.focal_px = 1.0 / pixel.x;
    view_.axis_px = -low / pixel;
    view_.gaze_px = (DVec2(math::tangent_from_direction(gaze.direction)) - low) / pixel;
  }

  Result<Curve> curve_of(const PixelGrid& grid) {
    SourcePicture source = setting_.render(setting_.stage_from_camera(), grid);
    const image::Plane<Rgb8> clean = source.color;
    Curve curve;
    for (const int quality : {10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98}) {
      codec::ColorOptions options;
      options.jpeg_quality = quality;
      const auto bytes = codec::encode_color(clean, clean.rect(), options);
      if (!bytes) return forward(bytes);
      const auto decoded = codec::decode_color(*bytes, options.codec, clean.rect(), source.color);
      if (!decoded) return forward(decoded);
      image::Plane<Rgb8> shown(display_.width_px, display_.height_px);
      warper_.warp(source.view(), source.stage_from_view, display_, {}, shown);
      curve.bytes.push_back(static_cast<double>(bytes->size()));
      curve.db.push_back(metrics::gp_psnr_db(truth_, metrics::unit_from_8bit(shown), view_));
      if (quality == 85) curve.db_at_85 = curve.db.back();
    }
    return curve;
  }

 private:
  ReprojectionSetting& setting_;
  const foveation::Display& display_;
  metrics::GazedView view_;
  image::Plane<Rgb> truth_;
  reprojection::Warper warper_;
};

Result<void> add_rows(const MapsOptions& options, const std::string& scene,
                      const std::string& words, Progress& progress, Report& report) {
  auto setting = ReprojectionSetting::create(scene, "full", options.threads);
  if (!setting) return forward(setting);
  const auto angles = parse_gaze("--gazes", words);
  if (!angles) return forward(angles);
  const Gaze gaze = gaze_towards(*angles);
  const double aspect = static_cast<double>(options.width_px) / options.height_px;
  const foveation::Display display{math::symmetric_fov(Degrees{options.vertical_fov_deg}, aspect),
                                   options.width_px, options.height_px};
  Judge judge(*setting, display, gaze);
  const auto made = grids_for(display, gaze, options.ramps);
  if (!made) return forward(made);
  const std::vector<NamedGrid>& grids = *made;
  std::vector<Curve> curves;
  for (const NamedGrid& named : grids) {
    auto curve = judge.curve_of(named.grid);
    if (!curve) return forward(curve);
    curves.push_back(std::move(*curve));
    progress.advance();
  }
  const double target_db = curves[0].db_at_85;
  double ours = INFINITY;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double bytes = curves[i].bytes_at(target_db);
    if (i >= kOthers && bytes < ours) ours = bytes;
  }
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double cells = static_cast<double>(grids[i].grid.width()) * grids[i].grid.height();
    report.rows.push_back({{"scene", scene},
                           {"gaze", words},
                           {"map", grids[i].name},
                           {"cells_pct", 100.0 * cells / (display.width_px * display.height_px)},
                           {"gp_psnr_best_db", curves[i].best_db()},
                           {"target_db", target_db},
                           {"bytes_at_target", curves[i].bytes_at(target_db)},
                           {"bytes_of_ours", ours}});
  }
  return {};
}

}  // namespace

void make_quick(MapsOptions& options) {
  options.scenes = {"atrium"};
  options.gazes = {"0,0"};
  options.width_px = 720;
  options.height_px = 800;
}

Result<void> run_maps(const MapsOptions& options) {
  Report report{"maps",
                {{"width_px", std::int64_t{options.width_px}},
                 {"height_px", std::int64_t{options.height_px}},
                 {"vertical_fov_deg", options.vertical_fov_deg}},
                {}};
  constexpr std::size_t kFixed = 5;  // maps besides the ramps
  const std::size_t pictures =
      (kFixed + options.ramps.size()) * options.scenes.size() * options.gazes.size();
  Progress progress("maps", static_cast<std::int64_t>(pictures));
  for (const std::string& scene : options.scenes) {
    for (const std::string& gaze : options.gazes) {
      if (auto done = add_rows(options, scene, gaze, progress, report); !done) return done;
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
