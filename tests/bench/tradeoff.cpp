#include "tests/bench/tradeoff.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include "shared/base/text.h"
#include "shared/image/png.h"
#include "tests/bench/papers.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/tradeoff_front.h"
#include "tests/bench/tradeoff_ladder.h"

namespace macula::bench {
namespace {

using base::forward;

/// One row to be measured.
struct Wanted {
  const TradeoffKernel* kernel;
  std::string scene, config;
};

Result<std::vector<const TradeoffKernel*>> find_kernels(const std::vector<std::string>& names) {
  std::vector<const TradeoffKernel*> found;
  for (const std::string& name : names) {
    std::string known;
    const TradeoffKernel* match = nullptr;
    for (const TradeoffKernel& kernel : tradeoff_kernels()) {
      known += (known.empty() ? "" : ", ") + std::string(kernel.name);
      if (kernel.name == name) match = &kernel;
    }
    if (match == nullptr)
      return base::bad_input("unknown kernel '" + name + "'", "--kernels", "allowed: " + known);
    found.push_back(match);
  }
  return found;
}

std::vector<std::string> configs_of(const TradeoffKernel& kernel, const TradeoffOptions& options) {
  if (!options.configs.empty()) return options.configs;
  std::vector<std::string> all = kernel.uniform;
  all.insert(all.end(), kernel.knobs.begin(), kernel.knobs.end());
  if (options.quick)
    std::erase_if(all, [&](const std::string& config) {
      return std::ranges::find(kernel.costly, config) != kernel.costly.end();
    });
  return all;
}

bool is_uniform(const TradeoffKernel& kernel, const std::string& config) {
  return std::ranges::find(kernel.uniform, config) != kernel.uniform.end();
}

std::string stem_of(const std::string& scene) {
  return std::filesystem::path(scene).stem().string();
}

/// Letters, digits and what else a file's name takes everywhere.
std::string file_name(std::string text) {
  for (char& c : text)
    if (c == ' ' || c == '/') c = '_';
  return text;
}

Fields fields_of(const Wanted& wanted, const TradeoffRow& row, std::uint64_t scene_hash,
                 std::string picture) {
  const auto& e = row.errors;
  char hash[24];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(scene_hash));
  return {{"kernel", std::string(wanted.kernel->name)},
          {"scene", stem_of(wanted.scene)},
          {"config", wanted.config},
          {"cpu_ms", row.cpu_ms},
          {"work_per_px", row.work_per_px},
          {"bytes_per_frame", row.bytes},
          {"rmse_f5", e.f5.rmse()},
          {"rmse_f10", e.f10.rmse()},
          {"rmse_f25", e.f25.rmse()},
          {"rmse_out10", e.out10.rmse()},
          {"rmse_out25", e.out25.rmse()},
          {"rmse_ew", e.seen.rmse()},
          {"relmse", row.relmse / row.frames},
          {"psnr_db", row.psnr_db / row.frames},
          {"ssim", row.ssim / row.frames},
          {"flip", row.flip / row.frames},
          {"flip_out10", row.flip_out10 / row.frames},
          {"ew_psnr_db", row.ew_psnr_db / row.frames},
          {"gp_psnr_db", row.gp_psnr_db / row.frames},
          {"flicker_t1", row.flicker},
          {"reference_se", std::max(row.standard_error(e.f10), row.standard_error(e.seen))},
          {"rmse_estimated", row.rmse_estimated},
          {"cells", row.cells},
          {"uniform", is_uniform(*wanted.kernel, wanted.config)},
          {"scene_hash", std::string(hash)},
          {"picture", std::move(picture)}};
}

/// The run: what is asked for, less what the report holds already.
class Run {
 public:
  Run(const TradeoffOptions& options, Report& report)
      : options_(options),
        report_(report),
        cache_(options.references),
        scheduler_(options.threads) {}

  Result<void> measure_all(const std::vector<const TradeoffKernel*>& kernels) {
    std::int64_t total = 0;
    for (const TradeoffKernel* kernel : kernels)
      total += static_cast<std::int64_t>(scenes_of(*kernel).size() *
                                         configs_of(*kernel, options_).size());
    Progress progress("tradeoff", total);
    for (const TradeoffKernel* kernel : kernels) {
      for (const std::string& scene : scenes_of(*kernel))
        if (auto ok = measure_scene(*kernel, scene, progress); !ok) return ok;
    }
    return {};
  }

  std::vector<std::string> scenes_of(const TradeoffKernel& kernel) const {
    return options_.scenes.empty() ? kernel.scenes : options_.scenes;
  }

 private:
  bool is_known(const Wanted& wanted) const {
    return std::ranges::any_of(report_.rows, [&](const Fields& row) {
      return text_in(row, "kernel") == wanted.kernel->name &&
             text_in(row, "scene") == stem_of(wanted.scene) &&
             text_in(row, "config") == wanted.config;
    });
  }

  Result<void> measure_scene(const TradeoffKernel& kernel, const std::string& scene,
                             Progress& progress) {
    std::unique_ptr<TradeoffSetting> setting;
    for (const std::string& config : configs_of(kernel, options_)) {
      progress.advance();
      const Wanted wanted{&kernel, scene, config};
      if (is_known(wanted)) continue;
      const auto settings = parse_frame_settings(config);
      if (!settings) return forward(settings);
      if (!setting) {
        auto made = TradeoffSetting::create(kernel, scene, options_.scale, cache_, scheduler_);
        if (!made) return forward(made);
        setting = std::move(*made);
        if (auto ok = keep(picture_name(kernel, scene, "reference"), setting->reference_shown());
            !ok)
          return ok;
      }
      const auto row = setting->measure(*settings);
      if (!row) return forward(row);
      const std::string picture = picture_name(kernel, scene, config);
      if (auto ok = keep(picture, row->shown); !ok) return ok;
      report_.rows.push_back(
          fields_of(wanted, *row, setting->scene_hash(), options_.pictures.empty() ? "" : picture));
      if (auto ok = finish(kernel, scene); !ok) return ok;
    }
    return {};
  }

  /// Rows of one kernel and scene lie together: measured in one go, or appended to.
  Result<void> finish(const TradeoffKernel& kernel, const std::string& scene) {
    const auto is_here = [&](const Fields& row) {
      return text_in(row, "kernel") == kernel.name && text_in(row, "scene") == stem_of(scene);
    };
    const auto here = std::stable_partition(report_.rows.begin(), report_.rows.end(),
                                            [&](const Fields& row) { return !is_here(row); });
    mark_fronts({here, report_.rows.end()});
    return options_.json.empty() ? Result<void>{} : write_json(options_.json, report_);
  }

  static std::string picture_name(const TradeoffKernel& kernel, const std::string& scene,
                                  const std::string& config) {
    return file_name(base::concat(kernel.name, "_", stem_of(scene), "_", config, ".png"));
  }

  Result<void> keep(const std::string& name, const Plane<Rgb8>& shown) const {
    if (options_.pictures.empty()) return {};
    std::error_code ignored;  // a folder that cannot be made shows when it is written to
    std::filesystem::create_directories(options_.pictures, ignored);
    return image::write_png(options_.pictures + "/" + name, shown);
  }

  const TradeoffOptions& options_;
  Report& report_;
  const PictureCache cache_;
  scheduling::TileScheduler scheduler_;
};

Fields config_of(const TradeoffOptions& options) {
  const TradeoffScale& scale = options.scale;
  return {{"side_px", std::int64_t{scale.side_px}},
          {"fov_deg", 90.0},
          {"reference_samples", std::int64_t{2 * scale.reference_samples}},
          {"warm_up", std::int64_t{scale.warm_up}},
          {"frames", std::int64_t{scale.frames}},
          {"threads", std::int64_t{options.threads}},
          {"pictures", options.pictures}};
}

/// The columns that fit a terminal; the report has them all.
std::vector<Fields> for_people(const std::vector<Fields>& rows) {
  static const std::set<std::string> kShown{
      "kernel",          "scene",           "config",       "cpu_ms",
      "work_per_px",     "bytes_per_frame", "rmse_f5",      "rmse_f10",
      "rmse_f25",        "rmse_out25",      "flip",         "gp_psnr_db",
      "rmse_ew",         "flicker_t1",      "reference_se", "on_front",
      "uniform_rmse_f10"};
  std::vector<Fields> table;
  for (const Fields& row : rows) {
    Fields shown;
    for (const auto& field : row)
      if (kShown.contains(field.first)) shown.push_back(field);
    table.push_back(std::move(shown));
  }
  return table;
}

/// One line a kernel and scene: where the foveated front lies below whole pictures.
std::vector<Fields> advantages(const std::vector<Fields>& rows) {
  std::vector<Fields> lines;
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(first, rows.end(), [&](const Fields& row) {
      return text_in(row, "kernel") != text_in(*first, "kernel") ||
             text_in(row, "scene") != text_in(*first, "scene");
    });
    Fields line{{"kernel", text_in(*first, "kernel")}, {"scene", text_in(*first, "scene")}};
    for (const auto& [key, name] : {std::pair{"rmse_f10", "f10"}, std::pair{"rmse_ew", "ew"},
                                    std::pair{"flip_out10", "flip_out10"}}) {
      const Advantage advantage = foveated_advantage({first, last}, key);
      line.emplace_back(base::concat(name, "_below_decades"), advantage.below_decades);
      line.emplace_back(base::concat(name, "_of_decades"), advantage.of_decades);
      line.emplace_back(base::concat(name, "_uniform_over_foveated"), advantage.mean_ratio);
    }
    lines.push_back(std::move(line));
    first = last;
  }
  return lines;
}

/// One line a kernel and scene: the online estimate, by a ladder of the other scenes.
std::vector<Fields> estimate_rows(const std::vector<const TradeoffKernel*>& kernels,
                                  const std::vector<Fields>& rows) {
  std::vector<Fields> lines;
  for (const TradeoffKernel* kernel : kernels) {
    std::vector<Fields> own;
    std::set<std::string> scenes;
    for (const Fields& row : rows) {
      if (text_in(row, "kernel") != kernel->name) continue;
      own.push_back(row);
      scenes.insert(text_in(row, "scene"));
    }
    if (scenes.size() < 2) continue;
    for (const std::string& scene : scenes) {
      const EstimateCheck check = check_estimates(own, scene);
      lines.push_back({{"kernel", std::string(kernel->name)},
                       {"scene_left_out", scene},
                       {"ladder_steps", std::int64_t{check.steps}},
                       {"estimate_kendall_tau", check.kendall_tau},
                       {"estimate_within_30_share", check.share_within_30},
                       {"estimate_worst_factor", check.worst_factor}});
    }
  }
  return lines;
}

std::vector<Fields> paper_rows(const std::vector<const TradeoffKernel*>& kernels) {
  std::vector<Fields> rows;
  for (const TradeoffKernel* kernel : kernels)
    for (const PaperPoint& point : paper_points())
      if (point.kernel == kernel->name)
        rows.push_back({{"kernel", std::string(point.kernel)},
                        {"paper", std::string(point.paper)},
                        {"place", std::string(point.place)},
                        {"setting", std::string(point.setting)},
                        {"quantity", std::string(point.quantity)},
                        {"value", point.value}});
  return rows;
}

Result<void> write_ladders(const TradeoffOptions& options,
                           const std::vector<const TradeoffKernel*>& kernels,
                           const Report& report) {
  if (options.ladders.empty()) return {};
  for (const TradeoffKernel* kernel : kernels) {
    std::vector<Fields> own;
    for (const Fields& row : report.rows)
      if (text_in(row, "kernel") == kernel->name) own.push_back(row);
    const std::string command = base::concat(
        "macula-bench tradeoff --kernels ", kernel->name, options.quick ? " --quick" : "",
        " --ladders DIR, pictures of ", options.scale.side_px, " x ", options.scale.side_px);
    if (auto ok = write_ladder(options.ladders, std::string(kernel->name), own, command); !ok)
      return ok;
  }
  return {};
}

void print(const std::vector<Fields>& rows) {
  std::printf("%s\n", table_text(rows).c_str());
}

}  // namespace

void make_quick(TradeoffOptions& options) {
  options.quick = true;
  options.scale = {
      .side_px = 160, .reference_samples = 48, .warm_up = 4, .frames = 3, .longest_ms = 500.0};
}

Result<void> run_tradeoff(const TradeoffOptions& options) {
  const auto kernels = find_kernels(options.kernels);
  if (!kernels) return forward(kernels);
  Report report{"tradeoff", config_of(options), {}};
  if (!options.json.empty()) {
    auto known = read_rows(options.json, report);
    if (!known) return forward(known);
    report.rows = std::move(*known);
  }
  Run run(options, report);
  if (auto ok = run.measure_all(*kernels); !ok) return ok;
  print(for_people(report.rows));
  print(advantages(report.rows));
  print(estimate_rows(*kernels, report.rows));
  print(paper_rows(*kernels));
  return write_ladders(options, *kernels, report);
}

}  // namespace macula::bench
