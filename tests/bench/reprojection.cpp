#include "tests/bench/reprojection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "client/pose/demo_trace.h"
#include "client/pose/predictor.h"
#include "client/pose/trace.h"
#include "client/reprojection/error_bound.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flip.h"
#include "shared/metrics/foveated.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/reprojection_setting.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using base::forward;
using reprojection::WarpOptions;

constexpr Degrees kView{60.0}, kGuard{12.0};
constexpr double kViewCell_m = 0.05;        // that the second layer is made for
constexpr double kSamplesPerSecond = 72.0;  // of the head, that prediction sees

foveation::Display display_of(int side_px) {
  return {math::symmetric_fov(kView, 1.0), side_px, side_px};
}

// ---- methods ----

struct Method {
  const char* name;
  WarpOptions options;
  bool guarded = true, predicted = false, layered = false;
};
using Silhouettes = WarpOptions::Silhouettes;
const std::array<Method, 10> kMethods{{
    {"stale", {.method = WarpOptions::Method::Stale}},
    {"rotation", {.method = WarpOptions::Method::RotationOnly}, false},
    {"rotation_guard", {.method = WarpOptions::Method::RotationOnly}},
    {"mesh", {.silhouettes = Silhouettes::Stretch}},
    {"mesh_cut", {.silhouettes = Silhouettes::Cut}},
    {"mesh_cut_splat", {}},
    {"grid", {.detail_px = WarpOptions::kGridDetail_px, .filter = WarpOptions::Filter::Bilinear}},
    {"predicted", {}, true, true},
    {"layered", {}, true, false, true},
    {"layered_predicted", {}, true, true, true},
}};

const Method& method_named(const std::string& name) {
  return *std::ranges::find(kMethods, name, &Method::name);
}

// ---- heads ----

/// A recorded head, moved so that it stands and looks where the scene's camera does.
class Head {
 public:
  Head(const pose::Trace& trace, const Pose& stage_from_camera)
      : trace_(trace), camera_(stage_from_camera) {}

  /// Even moments of the ten most vigorous seconds, the first half a second in.
  std::vector<double> moments(int count) const {
    const double length_s = std::min(10.0, units::to_s(trace_.duration()) - 1.0);
    const double begin_s = most_vigorous(length_s);
    std::vector<double> moments;
    for (int i = 0; i < count; ++i) {
      moments.push_back(begin_s + 0.5 + (length_s - 0.5) * i / count);
    }
    return moments;
  }
  Pose at(double s) const { return raw(s).stage_from_head; }

  /// What Predictor says at `known_s` about `asked_s`.
  Pose predicted(double known_s, double asked_s) const {
    pose::Predictor predictor;
    constexpr int kSamples = 8;  // more than its window
    for (int i = kSamples; i >= 0; --i) {
      pose::HeadSample sample = raw(known_s - i / kSamplesPerSecond);
      sample.at = ClientTime{units::from_s(known_s - i / kSamplesPerSecond)};
      predictor.add(sample);
    }
    return predictor.predict(ClientTime{units::from_s(asked_s)});
  }
  /// Carries the trace's stage to the scene's: the head of `now_s` stands at the camera's place and
  /// looks along it, as level as recorded.
  Pose stage_from_trace(double now_s) const {
    const Pose now = at(now_s);
    const auto heading = [](const DQuat& rotation) {
      const DVec3 ahead = rotation * DVec3{0, 0, -1};
      return std::atan2(ahead.x, -ahead.z);
    };
    const double turn = heading(now.rotation) - heading(camera_.rotation);
    const DQuat level = glm::angleAxis(turn, DVec3{0, 1, 0});
    return {camera_.position - level * now.position, level};
  }

 private:
  pose::HeadSample raw(double s) const { return trace_.at(units::from_s(s)); }

  double most_vigorous(double length_s) const {
    double best_s = 0.5, most = -1.0;
    for (double begin = 0.5; begin + length_s <= units::to_s(trace_.duration()); begin += 1.0) {
      double turned = 0.0;
      for (double t = begin; t < begin + length_s; t += 0.1) {
        turned += math::angle_between(at(t), at(t + 0.1)).value();
      }
      if (turned > most) most = turned, best_s = begin;
    }
    return best_s;
  }

  const pose::Trace& trace_;
  const Pose camera_;
};

// ---- measuring ----

/// The part of a picture that lies on the display's own raster.
SourcePicture without_guard(const SourcePicture& picture, const foveation::Display& display) {
  const DVec2 low = display.fov.tangent_min(), high = display.fov.tangent_max();
  const auto range = [](const std::vector<float>& edges, double from, double to) {
    const double slack = 0.25 * (edges[1] - edges[0]);
    const auto first = std::lower_bound(edges.begin(), edges.end(), from - slack);
    const auto last = std::upper_bound(edges.begin(), edges.end(), to + slack);
    return std::pair{static_cast<int>(first - edges.begin()),
                     static_cast<int>(last - edges.begin()) - 1};
  };
  const auto [left, right] = range(picture.grid.x_edges, low.x, high.x);
  const auto [top, bottom] = range(picture.grid.y_edges, low.y, high.y);
  SourcePicture cut{
      picture.stage_from_view,
      {{picture.grid.x_edges.begin() + left, picture.grid.x_edges.begin() + right + 1},
       {picture.grid.y_edges.begin() + top, picture.grid.y_edges.begin() + bottom + 1}},
      {right - left, bottom - top},
      {right - left, bottom - top}};
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      cut.color(x - left, y - top) = picture.color(x, y);
      cut.inverse_depth_per_m(x - left, y - top) = picture.inverse_depth_per_m(x, y);
    }
  }
  return cut;
}

/// The same cells, half a cell to the right and down.
PixelGrid shifted(PixelGrid grid) {
  for (std::vector<float>* edges : {&grid.x_edges, &grid.y_edges}) {
    const float half = 0.5F * ((*edges)[1] - (*edges)[0]);
    for (float& edge : *edges) edge += half;
  }
  return grid;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double beyond = place - static_cast<double>(below);
  const double next = values[std::min(below + 1, values.size() - 1)];
  return (1.0 - beyond) * values[below] + beyond * next;
}

int squared_error(const Rgb8& a, const Rgb8& b) {
  const int r = a.r - b.r, g = a.g - b.g, bl = a.b - b.b;
  return r * r + g * g + bl * bl;
}

/// The disc of 10 degrees around the axis.
double f10_psnr_db(const image::Plane<Rgb8>& shown, const image::Plane<Rgb8>& expected,
                   const PixelGrid& raster) {
  const double least = std::cos(Radians{Degrees{10.0}}.value());
  double squares = 0.0, values = 0.0;
  for (int y = 0; y < shown.height(); ++y) {
    for (int x = 0; x < shown.width(); ++x) {
      if (1.0 / static_cast<double>(glm::length(raster.ray(x, y))) < least) continue;
      squares += squared_error(shown(x, y), expected(x, y));
      values += 3.0;
    }
  }
  return metrics::db_from_mse(squares / values, 255.0);
}

/// Grey: four times the root mean square error of each pixel.
image::Plane<Rgb8> error_picture(const image::Plane<Rgb8>& shown,
                                 const image::Plane<Rgb8>& expected) {
  image::Plane<Rgb8> picture(shown.width(), shown.height());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double rms = std::sqrt(squared_error(shown.data()[i], expected.data()[i]) / 3.0);
    const auto grey = static_cast<std::uint8_t>(std::min(4.0 * rms, 255.0));
    picture.data()[i] = {grey, grey, grey};
  }
  return picture;
}

/// Whether another surface begins within two pixels.
bool is_by_silhouette(const image::Plane<float>& inverse_depth, int x, int y) {
  constexpr int kReach = 2;
  constexpr float kOtherSurface = 0.05F;  // relative step of inverse depth
  const float here = inverse_depth(x, y);
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) {
      if (!inverse_depth.contains(x + i, y + j)) continue;
      const float there = inverse_depth(x + i, y + j);
      if (std::abs(there - here) > kOtherSurface * std::max(here, there)) return true;
    }
  }
  return false;
}

/// Shares of a picture's squared error: of filled pixels, and of others by silhouettes.
struct ErrorShares {
  double filled_pct = 0.0, silhouette_pct = 0.0;
};
ErrorShares error_shares(const image::Plane<Rgb8>& shown,
                         const image::Plane<reprojection::Coverage>& coverage,
                         const SourcePicture& expected) {
  double all = 0.0, filled = 0.0, silhouette = 0.0;
  for (int y = 0; y < shown.height(); ++y) {
    for (int x = 0; x < shown.width(); ++x) {
      const int error = squared_error(shown(x, y), expected.color(x, y));
      if (error == 0) continue;
      all += error;
      if (coverage(x, y) == reprojection::Coverage::Filled) {
        filled += error;
      } else if (is_by_silhouette(expected.inverse_depth_per_m, x, y)) {
        silhouette += error;
      }
    }
  }
  return all > 0.0 ? ErrorShares{100.0 * filled / all, 100.0 * silhouette / all} : ErrorShares{};
}

/// What the poses of one row gave.
struct Samples {
  std::vector<double> psnr_db, f10_psnr_db, bound_p95_px, true_p95_px, violations, bytes,
      hidden_bytes_pct, gp_psnr_db, flip, holes_pct, outside_pct, error_filled_pct,
      error_silhouette_pct, hidden_cells_pct, hidden_cpu_pct, cpu_ms, turn_deg, offset_cm;
};

void add_sample(const SourcePicture& source, const SourcePicture& expected,
                const foveation::Display& display, const Method& method,
                reprojection::Warper& warper, image::Plane<Rgb8>& shown, Samples& samples) {
  image::Plane<reprojection::Coverage> coverage;
  Stopwatch watch;
  WarpOptions options = method.options;
  options.layers = method.layered ? WarpOptions::Layers::Both : WarpOptions::Layers::First;
  const auto report =
      warper.warp(source.view(), expected.stage_from_view, display, options, shown, &coverage);
  samples.cpu_ms.push_back(watch.lap().cpu_ms);
  const auto reference = metrics::unit_from_8bit(expected.color);
  const auto test = metrics::unit_from_8bit(shown);
  samples.f10_psnr_db.push_back(f10_psnr_db(shown, expected.color, expected.grid));
  const double ppd = display.pixels_per_degree();
  samples.psnr_db.push_back(metrics::psnr_db(reference, test));
  samples.gp_psnr_db.push_back(metrics::gp_psnr_db(
      reference, test, metrics::GazedView::centred(display.width_px, display.height_px, ppd)));
  samples.flip.push_back(metrics::summarise(metrics::flip_map(reference, test, ppd)).mean);
  const auto pixels = static_cast<double>(shown.size());
  samples.holes_pct.push_back(100.0 * report.filled_share());
  samples.outside_pct.push_back(100.0 * static_cast<double>(report.outside_px) / pixels);
  const ErrorShares shares = error_shares(shown, coverage, expected);
  samples.error_filled_pct.push_back(shares.filled_pct);
  samples.error_silhouette_pct.push_back(shares.silhouette_pct);
  if (method.layered) {
    samples.hidden_cells_pct.push_back(source.hidden_cells_pct);
    samples.hidden_cpu_pct.push_back(100.0 * source.hidden_cpu_ms /
                                     (source.cpu_ms + source.hidden_cpu_ms));
  }
  const Pose &from = source.stage_from_view, &to = expected.stage_from_view;
  samples.turn_deg.push_back(Degrees(math::angle_between(from, to)).value());
  samples.offset_cm.push_back(100.0 * glm::distance(from.position, to.position));
}

/// The bound of a source's cells against where the renderer says their points are: nine in each.
struct BoundCheck {
  double bound_p95_px = 0.0, true_p95_px = 0.0, violations = 0.0;
};
BoundCheck check_bound(const SourcePicture& source, const image::Plane<float>& fine_inverse_depth,
                       const Pose& to, const foveation::Display& display,
                       const WarpOptions& options) {
  const reprojection::SourceView view = source.view();
  const reprojection::ErrorBound bound(view, {source.depth_residual, source.residual_step_per_m},
                                       to, display, options);
  BoundCheck check;
  std::vector<double> bounds, errors;
  constexpr int kPoints = 3;
  for (int y = 0; y < source.color.height(); ++y) {
    for (int x = 0; x < source.color.width(); ++x) {
      const DVec2 shown = bound.place(x, y, 0.5, 0.5, source.inverse_depth_per_m(x, y));
      if (!(shown.x >= 0 && shown.x <= display.width_px && shown.y >= 0 &&
            shown.y <= display.height_px)) {
        continue;
      }
      const double most = bound.at(x, y);
      bounds.push_back(most);
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const int column = i % kPoints, row = i / kPoints;
        const DVec2 place =
            bound.place(x, y, (column + 0.5) / kPoints, (row + 0.5) / kPoints,
                        fine_inverse_depth(kPoints * x + column, kPoints * y + row));
        const double error = glm::distance(place, shown);
        if (std::isnan(error)) continue;
        errors.push_back(error);
        if (error > most) ++check.violations;
      }
    }
  }
  check.bound_p95_px = percentile(std::move(bounds), 0.95);
  check.true_p95_px = percentile(std::move(errors), 0.95);
  return check;
}

/// The server's own grid around a gaze straight ahead.
PixelGrid foveal_grid(const foveation::Display& display, double scale) {
  return foveation::make_foveal_grid(display, {}, *foveation::find_rate_model("cortical"),
                                     {.fovea_oversampling = scale, .guard_band = kGuard});
}

/// Three cells for each, along both axes.
PixelGrid three_times_finer(const PixelGrid& grid) {
  const auto split = [](const std::vector<float>& edges) {
    std::vector<float> finer{edges.front()};
    for (std::size_t i = 1; i < edges.size(); ++i) {
      const float step = (edges[i] - edges[i - 1]) / 3.0F;
      finer.insert(finer.end(), {edges[i - 1] + step, edges[i - 1] + 2.0F * step, edges[i]});
    }
    return finer;
  };
  return {split(grid.x_edges), split(grid.y_edges)};
}

/// What a row is, before it is measured.
struct RowKey {
  std::string scene, trace, method;
  double latency_ms, source_scale;
};

bool is_row_of(const Fields& fields, const RowKey& key, const ReprojectionOptions& options) {
  const auto is = [&](const char* name, const Value& value) {
    return std::ranges::any_of(
        fields, [&](const auto& field) { return field.first == name && field.second == value; });
  };
  const bool same = is("codec", options.codec) && is("foveated", options.foveated);
  return same && is("scene", key.scene) && is("trace", key.trace) && is("method", key.method) &&
         is("latency_ms", key.latency_ms) && is("source_scale", key.source_scale) &&
         is("material", options.material);
}

Fields fields_of(const RowKey& key, const ReprojectionOptions& options, const Samples& samples,
                 double ceiling_db) {
  const auto median = [](const std::vector<double>& values) {
    return values.empty() ? std::nan("") : percentile(values, 0.5);
  };
  return {
      {"scene", key.scene},
      {"trace", key.trace},
      {"latency_ms", key.latency_ms},
      {"method", key.method},
      {"codec", options.codec},
      {"foveated", options.foveated},
      {"source_scale", key.source_scale},
      {"material", options.material},
      {"layers", std::int64_t{samples.hidden_cells_pct.empty() ? 1 : 2}},
      {"poses", static_cast<std::int64_t>(samples.psnr_db.size())},
      {"psnr_db", median(samples.psnr_db)},
      {"psnr_p10_db", samples.psnr_db.empty() ? std::nan("") : percentile(samples.psnr_db, 0.1)},
      {"f10_psnr_db", median(samples.f10_psnr_db)},
      {"gp_psnr_db", median(samples.gp_psnr_db)},
      {"flip", median(samples.flip)},
      {"holes_pct", median(samples.holes_pct)},
      {"outside_guard_pct", median(samples.outside_pct)},
      {"error_filled_pct", median(samples.error_filled_pct)},
      {"error_silhouette_pct", median(samples.error_silhouette_pct)},
      {"bound_p95_px", median(samples.bound_p95_px)},
      {"true_p95_px", median(samples.true_p95_px)},
      {"violations", samples.violations.empty()
                         ? std::nan("")
                         : *std::max_element(samples.violations.begin(), samples.violations.end())},
      {"bytes_per_frame", median(samples.bytes)},
      {"hidden_bytes_pct", median(samples.hidden_bytes_pct)},
      {"hidden_cells_pct", median(samples.hidden_cells_pct)},
      {"hidden_cpu_pct", median(samples.hidden_cpu_pct)},
      {"cpu_ms", median(samples.cpu_ms)},
      {"resampling_ceiling_db", ceiling_db},
      {"turn_deg", median(samples.turn_deg)},
      {"offset_cm", median(samples.offset_cm)}};
}

/// One scene, trace and source scale: every latency and method over the same poses.
class SceneRun {
 public:
  SceneRun(const ReprojectionOptions& options, const std::string& scene, const std::string& trace,
           double source_scale, ReprojectionSetting& setting, const Head& head, Report& report)
      : options_(options),
        scene_(scene),
        trace_(trace),
        source_scale_(source_scale),
        setting_(setting),
        head_(head),
        report_(report),
        display_(display_of(options.side_px)),
        raster_(foveation::make_uniform_grid(display_)),
        guarded_(options.foveated ? foveal_grid(display_, source_scale)
                                  : guarded_raster(display_, kGuard, source_scale)) {}

  Result<void> run(Progress& progress) {
    const std::vector<double> moments = head_.moments(options_.poses);
    last_moment_s_ = moments.back();
    for (const double latency_ms : options_.latencies_ms) {
      std::vector<RowKey> missing;
      for (const Method& method : kMethods) {
        const RowKey key{scene_, trace_, method.name, latency_ms, source_scale_};
        if (is_wanted(method) && !is_known(key)) missing.push_back(key);
      }
      std::map<std::string, Samples> samples;
      for (const double now_s : moments) {
        if (!missing.empty()) {
          if (auto done = measure(now_s, latency_ms, missing, samples); !done) return done;
        }
        progress.advance();
      }
      for (const RowKey& key : missing) {
        report_.rows.push_back(
            fields_of(key, options_, samples[key.method], percentile(ceilings_db_, 0.5)));
      }
      if (options_.json.empty() || missing.empty()) continue;
      if (auto done = write_json(options_.json, report_); !done) return done;
    }
    return {};
  }

 private:
  bool is_wanted(const Method& method) const {
    return options_.methods.empty() || std::ranges::count(options_.methods, method.name) > 0;
  }
  bool is_known(const RowKey& key) const {
    return std::ranges::any_of(
        report_.rows, [&](const Fields& fields) { return is_row_of(fields, key, options_); });
  }

  /// The picture at the very pose of a moment; and what the filter alone can do there.
  const SourcePicture& expected_at(double now_s) {
    const auto known = expected_.find(now_s);
    if (known != expected_.end()) return known->second;
    const Pose pose = head_.stage_from_trace(now_s) * head_.at(now_s);
    const SourcePicture& expected =
        expected_.emplace(now_s, setting_.render(pose, raster_)).first->second;
    Samples ceiling;
    add_sample(setting_.render(pose, shifted(guarded_)), expected, display_,
               method_named("mesh_cut_splat"), warper_, shown_, ceiling);
    ceilings_db_.push_back(ceiling.psnr_db.front());
    return expected;
  }

  void write_pictures(const RowKey& row, const SourcePicture& expected) const {
    if (options_.pictures.empty()) return;
    const std::filesystem::path folder(options_.pictures);
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    const auto write = [&](const std::string& name, const image::Plane<Rgb8>& picture) {
      if (const auto done = image::write_png((folder / name).string(), picture); !done) {
        std::fprintf(stderr, "macula-bench: %s\n", done.error().message().c_str());
      }
    };
    const std::string stem = base::concat(row.scene, "-", row.trace, "-", row.latency_ms, "ms-");
    write(base::concat(stem, "expected.png"), expected.color);
    write(base::concat(stem, row.method, ".png"), shown_);
    write(base::concat(stem, row.method, "-error.png"), error_picture(shown_, expected.color));
  }

  /// A frame for the client, and its points' true depths, known when first asked for.
  struct Source {
    SourcePicture picture;
    image::Plane<float> fine_inverse_depth;
  };
  Result<Source> source_at(const Pose& from) {
    SourcePicture picture = setting_.render(from, guarded_, kViewCell_m);
    if (options_.codec != "none") {
      auto received = coded(picture);
      if (!received) return forward(received);
      picture = std::move(*received);
    }
    return Source{std::move(picture), {}};
  }

  Result<void> measure(double now_s, double latency_ms, const std::vector<RowKey>& rows,
                       std::map<std::string, Samples>& samples) {
    const SourcePicture& expected = expected_at(now_s);
    const Pose stage = head_.stage_from_trace(now_s);
    const double then_s = now_s - 1e-3 * latency_ms;
    const Pose old = stage * head_.at(then_s);
    const Pose foretold = stage * head_.predicted(then_s, now_s);
    std::optional<Source> plain, predicted;
    for (const RowKey& row : rows) {
      const Method& method = method_named(row.method);
      const Pose& from = method.predicted ? foretold : old;
      if (math::angle_between(from, expected.stage_from_view) > Radians(kGuard)) continue;
      std::optional<Source>& source = method.predicted ? predicted : plain;
      if (!source) {
        auto made = source_at(from);
        if (!made) return forward(made);
        source = std::move(*made);
      }
      const SourcePicture& picture = source->picture;
      Samples& row_samples = samples[row.method];
      add_sample(method.guarded ? picture : without_guard(picture, display_), expected, display_,
                 method, warper_, shown_, row_samples);
      if (method.layered) add_bound(*source, expected.stage_from_view, method, row_samples);
      if (now_s == last_moment_s_) write_pictures(row, expected);
    }
    return {};
  }

  void add_bound(Source& source, const Pose& to, const Method& method, Samples& samples) {
    if (source.fine_inverse_depth.empty()) {
      source.fine_inverse_depth =
          setting_.depth(source.picture.stage_from_view, three_times_finer(guarded_));
    }
    const BoundCheck check =
        check_bound(source.picture, source.fine_inverse_depth, to, display_, method.options);
    samples.bound_p95_px.push_back(check.bound_p95_px);
    samples.true_p95_px.push_back(check.true_p95_px);
    samples.violations.push_back(check.violations);
    if (source.picture.bytes == 0) return;
    samples.bytes.push_back(static_cast<double>(source.picture.bytes));
    samples.hidden_bytes_pct.push_back(100.0 * static_cast<double>(source.picture.hidden_bytes) /
                                       static_cast<double>(source.picture.bytes));
  }

  const ReprojectionOptions& options_;
  const std::string scene_, trace_;
  const double source_scale_;
  ReprojectionSetting& setting_;
  const Head& head_;
  Report& report_;
  const foveation::Display display_;
  const PixelGrid raster_, guarded_;
  double last_moment_s_ = 0.0;
  reprojection::Warper warper_;
  image::Plane<Rgb8> shown_;
  std::map<double, SourcePicture> expected_;  ///< by moment
  std::vector<double> ceilings_db_;
};

Fields config_of(const ReprojectionOptions& options) {
  return {{"side_px", std::int64_t{options.side_px}},
          {"fov_deg", kView.value()},
          {"guard_deg", kGuard.value()},
          {"poses", std::int64_t{options.poses}},
          {"head_samples_per_s", kSamplesPerSecond}};
}

struct NamedTrace {
  std::string name;
  pose::Trace trace;
};
Result<std::vector<NamedTrace>> load_traces(const std::vector<std::string>& paths) {
  std::vector<NamedTrace> traces;
  for (const std::string& path : paths) {
    auto trace = pose::load_trace(path);
    if (!trace) return forward(trace);
    if (trace->duration() < units::from_s(4.0)) {
      return base::bad_input("is shorter than 4 s", path, "a longer recording");
    }
    traces.push_back({std::filesystem::path(path).stem().string(), std::move(*trace)});
  }
  if (traces.empty()) traces.push_back({"demo", pose::make_demo_trace()});
  return traces;
}

}  // namespace

void make_quick(ReprojectionOptions& options) {
  options.scenes = {"posts", "atrium"};
  options.latencies_ms = {0.0, 50.0, 100.0};
  options.source_scales = {1.0};
  options.poses = 3;
}

Result<void> run_reprojection(const ReprojectionOptions& options) {
  Report report{"reprojection", config_of(options), {}};
  if (!options.json.empty()) {
    auto known = read_rows(options.json, report);
    if (!known) return forward(known);
    report.rows = std::move(*known);
  }
  const auto traces = load_traces(options.traces);
  if (!traces) return forward(traces);
  Progress progress(
      "reprojection",
      static_cast<std::int64_t>(options.scenes.size() * traces->size() *
                                options.source_scales.size() * options.latencies_ms.size()) *
          options.poses);
  for (const std::string& scene : options.scenes) {
    auto setting = ReprojectionSetting::create(scene, options.material, options.threads);
    if (!setting) return forward(setting);
    const std::string name = std::filesystem::path(scene).stem().string();
    for (const NamedTrace& trace : *traces) {
      const Head head(trace.trace, setting->stage_from_camera());
      for (const double scale : options.source_scales) {
        SceneRun run(options, name, trace.name, scale, *setting, head, report);
        if (const auto done = run.run(progress); !done) return done;
      }
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return {};
}

}  // namespace macula::bench
