#include "tests/bench/reprojection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "client/pose/demo_trace.h"
#include "client/pose/trace.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "tests/bench/progress.h"
#include "tests/bench/recorded_head.h"
#include "tests/bench/report.h"
#include "tests/bench/reprojection_grids.h"
#include "tests/bench/reprojection_measures.h"
#include "tests/bench/reprojection_setting.h"

namespace macula::bench {
namespace {

using base::forward;

constexpr Degrees kView{60.0}, kGuard{12.0};
constexpr double kViewCell_m = 0.05;  // that the second layer is made for

foveation::Display display_of(int side_px) {
  return {math::symmetric_fov(kView, 1.0), side_px, side_px};
}

/// What a row is, before it is measured.
struct RowKey {
  std::string scene, trace, method;
  double latency_ms, source_scale;
};

/// Of the frames' grid; uniform where it is not foveal.
std::string rate_model_of(const ReprojectionOptions& options) {
  return options.foveated ? options.rate_model : "uniform";
}

bool is_row_of(const Fields& fields, const RowKey& key, const ReprojectionOptions& options) {
  const auto is = [&](const char* name, const Value& value) {
    return std::ranges::any_of(
        fields, [&](const auto& field) { return field.first == name && field.second == value; });
  };
  const bool same = is("codec", options.codec) && is("foveated", options.foveated) &&
                    is("rate_model", rate_model_of(options));
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
      {"rate_model", rate_model_of(options)},
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
           double source_scale, ReprojectionSetting& setting, const RecordedHead& head,
           Report& report)
      : options_(options),
        scene_(scene),
        trace_(trace),
        source_scale_(source_scale),
        setting_(setting),
        head_(head),
        report_(report),
        display_(display_of(options.side_px)),
        raster_(foveation::make_uniform_grid(display_)),
        guarded_(options.foveated ? foveal_grid(display_, source_scale, kGuard,
                                                *foveation::find_rate_model(options.rate_model))
                                  : guarded_raster(display_, kGuard, source_scale)) {}

  Result<void> run(Progress& progress) {
    const std::vector<double> moments = head_.moments(options_.poses);
    last_moment_s_ = moments.back();
    for (const double latency_ms : options_.latencies_ms) {
      std::vector<RowKey> missing;
      for (const Method& method : reprojection_methods()) {
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
  const RecordedHead& head_;
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
          {"head_samples_per_s", kHeadSamplesPerSecond}};
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
  if (const auto model = foveation::find_rate_model(options.rate_model); !model) {
    return forward(model);
  }
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
      const RecordedHead head(trace.trace, setting->stage_from_camera());
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
