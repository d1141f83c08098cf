#include "tests/bench/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>

#include "server/scene/load.h"
#include "shared/base/resident.h"
#include "shared/image/draw.h"
#include "shared/image/png.h"
#include "shared/image/tone.h"
#include "tests/bench/figure_sheet.h"
#include "tests/bench/report.h"
#include "tests/bench/still_job.h"
#include "tests/bench/still_planes.h"

namespace macula::bench {
namespace {

using base::forward;
using image::Plane;

std::vector<std::string> scenes_of(const ContactSheetOptions& options) {
  if (!options.scenes.empty()) return options.scenes;
  std::vector<std::string> names;
  for (const scene::BuiltIn& entry : scene::built_in_scenes()) names.emplace_back(entry.name);
  return names;
}

/// One ray through the centre of every cell, in tiles of 4 x 4 as kernels send them, until at least
/// a fifth of a CPU second has passed; one thread.
double primary_mrays_per_cpu_s(const StillJob& job, const visibility::TriangleScene& triangles) {
  const Vec3 origin(job.view.world_from_view.position);
  visibility::RayStream rays;
  visibility::HitStream hits;
  double traced = 0.0, seconds = 0.0;
  while (seconds < 0.2) {
    const std::clock_t begin = std::clock();
    for (int y = 0; y + 4 <= job.view.grid.height(); y += 4) {
      for (int x = 0; x + 4 <= job.view.grid.width(); x += 4) {
        for (int i = 0; i < 16; ++i) {
          const DVec3 direction(job.view.grid.ray(x + i % 4, y + i / 4));
          rays.push(origin, Vec3(job.view.world_from_view.transform_direction(direction)), 0.0F,
                    std::numeric_limits<float>::infinity());
        }
        if (!rays.full()) continue;
        triangles.intersect(rays, hits, visibility::Coherence::Coherent);
        traced += rays.count;
        rays.clear();
      }
    }
    seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  }
  return traced / seconds / 1e6;
}

/// CPU time of primary rays over what it would be were every surface opaque, the middle one of
/// three ratios measured by turns; 1 where all are.
Result<double> alpha_test_cost(const StillJob& job) {
  if (!job.scene->plan().has(scene::Step::AlphaTest)) return 1.0;
  const auto opaque = visibility::TriangleScene::create(job.scene->scene(),
                                                        {.alpha_test = scene::StepUse::LeftOut});
  if (!opaque) return forward(opaque);
  std::array<double, 3> ratios{};
  for (double& ratio : ratios) {
    const double all = primary_mrays_per_cpu_s(job, **opaque);
    ratio = all / primary_mrays_per_cpu_s(job, job.scene->triangles());
  }
  std::ranges::sort(ratios);
  return ratios[1];
}

StillOptions still_options(const ContactSheetOptions& options, const std::string& scene) {
  StillOptions still;
  still.scene = scene;
  still.mode = StillMode::Fast;
  still.width_px = options.width_px, still.height_px = options.height_px;
  still.samples_per_cell = options.samples_per_cell;
  still.light_samples = options.light_samples;
  still.threads = options.threads;
  return still;
}

Result<Fields> row_of(const std::string& name, const StillJob& job, const RenderedStill& rendered,
                      double resident) {
  const scene::Scene& scene = job.scene->scene();
  const scene::SceneCounts counts = scene::counts_of(scene);
  const auto count = [](std::size_t value) { return static_cast<std::int64_t>(value); };
  const auto alpha_cost = alpha_test_cost(job);
  if (!alpha_cost) return forward(alpha_cost);
  return Fields{{"scene", name},
                {"triangles", count(counts.triangles)},
                {"unique", count(counts.unique_triangles)},
                {"emissive", count(counts.emissive_triangles)},
                {"lights", count(counts.lights)},
                {"load_cpu_ms", job.load_cpu_ms},
                {"build_cpu_ms", job.build_cpu_ms},
                {"resident_mb", resident},
                {"primary_mrays_per_cpu_s", primary_mrays_per_cpu_s(job, job.scene->triangles())},
                {"alpha_test_cost_ratio", *alpha_cost},
                {"render_cpu_ms", rendered.cpu_ms}};
}

struct Entry {
  Plane<Rgb8> picture;
  Fields row;
};
Result<Entry> make_entry(const ContactSheetOptions& options, const std::string& scene) {
  const StillOptions still = still_options(options, scene);
  const auto job = prepare_still(still);
  if (!job) return forward(job);
  const double resident = 1e-6 * static_cast<double>(base::resident_bytes());
  const auto rendered = render_still(*job, still);
  if (!rendered) return forward(rendered);
  Entry entry;
  image::encode(job->view.tone, radiance_on_display(*job, *rendered), entry.picture);
  const std::string name = std::filesystem::path(scene).stem().string();
  auto row = row_of(name, *job, *rendered, resident);
  if (!row) return forward(row);
  entry.row = std::move(*row);
  if (!options.singles.empty()) {
    const auto path = std::filesystem::path(options.singles) / (name + ".png");
    const auto written = image::write_png(path.string(), entry.picture);
    if (!written) return forward(written);
  }
  entry.picture = captioned(entry.picture, std::span(&name, 1));
  return entry;
}

}  // namespace

Result<void> run_contact_sheet(const ContactSheetOptions& options) {
  std::vector<Plane<Rgb8>> pictures;
  Report report{"contact-sheet",
                {{"width_px", std::int64_t{options.width_px}},
                 {"height_px", std::int64_t{options.height_px}},
                 {"samples_per_cell", std::int64_t{options.samples_per_cell}},
                 {"light_samples", std::int64_t{options.light_samples}}},
                {}};
  for (const std::string& scene : scenes_of(options)) {
    auto entry = make_entry(options, scene);
    if (!entry) return forward(entry);
    pictures.push_back(std::move(entry->picture));
    report.rows.push_back(std::move(entry->row));
  }
  const auto written = image::write_png(
      options.out, image::contact_sheet(pictures, options.columns, options.width_px));
  if (!written) return written;
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
