#include "tests/bench/still.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>

#include "shared/image/png.h"
#include "shared/image/tone.h"
#include "tests/bench/report.h"
#include "tests/bench/still_job.h"
#include "tests/bench/still_planes.h"

namespace macula::bench {
namespace {

using base::bad_input;
using base::forward;
using image::Plane;

enum class FileKind { Exr, Png };

Result<FileKind> file_kind(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".exr") return FileKind::Exr;
  if (extension == ".png") return FileKind::Png;
  return bad_input("unknown kind of picture", path,
                   "allowed: .exr (radiance) and .png (tone-mapped)");
}

std::string beside(const std::string& out, const std::string& suffix) {
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + suffix)).string();
}

/// The picture itself; with planes one EXR of everything (beside a PNG) and a picture a plane.
Result<void> write_pictures(const StillOptions& options, const StillJob& job, FileKind kind,
                            const Plane<Rgb>& radiance, const std::vector<StillLayer>& layers) {
  if (kind == FileKind::Png) {
    Plane<Rgb8> encoded;
    image::encode(job.view.tone, radiance, encoded);
    if (const auto written = image::write_png(options.out, encoded); !written) return written;
    if (layers.empty()) return {};
  }
  for (const StillLayer& layer : layers) {
    const auto drawn =
        image::write_png(beside(options.out, "." + layer.name + ".png"), picture_of(layer));
    if (!drawn) return drawn;
  }
  return write_layered_exr(kind == FileKind::Exr ? options.out : beside(options.out, ".exr"),
                           radiance, layers);
}

DVec3 mean_of(const Plane<Rgb>& plane) {
  DVec3 sum{0.0};
  for (const Rgb& value : plane.pixels()) sum += DVec3(value);
  return sum / static_cast<double>(plane.size());
}

Report make_report(const StillOptions& options, const StillJob& job, const RenderedStill& rendered,
                   const Plane<Rgb>& radiance) {
  const auto rays = static_cast<double>(rendered.report.primary_rays + rendered.report.shadow_rays);
  const auto per_second = [rays](double ms) { return ms > 0.0 ? rays / (1e3 * ms) : 0.0; };
  const DVec3 mean = mean_of(radiance);
  const auto cells = static_cast<std::int64_t>(rendered.planes.radiance.size());
  const auto pixels = static_cast<double>(job.display.width_px) * job.display.height_px;
  Report report{
      "still",
      {{"scene", options.scene},
       {"kernel", job.kernel},
       {"mode", std::string(options.mode == StillMode::Fast ? "fast" : "exact")},
       {"width_px", std::int64_t{options.width_px}},
       {"height_px", std::int64_t{options.height_px}},
       {"samples_per_cell", std::int64_t{options.samples_per_cell}},
       {"light_samples", std::int64_t{options.light_samples}},
       {"perceived_lights", options.perceived_lights},
       {"knobs", options.knobs},
       {"ambient_samples", std::int64_t{options.light_samples}},
       {"bounces", std::int64_t{options.bounces.value_or(job.kernel == "culling" ? 1 : 0)}},
       {"rate_model", options.rate_model},
       {"time_s", options.time_s},
       {"seed", static_cast<std::int64_t>(options.seed)}},
      {{{"cells", cells},
        {"cells_per_px", static_cast<double>(cells) / pixels},
        {"primary_rays", static_cast<std::int64_t>(rendered.report.primary_rays)},
        {"shadow_rays", static_cast<std::int64_t>(rendered.report.shadow_rays)},
        {"load_cpu_ms", job.load_cpu_ms},
        {"build_cpu_ms", job.build_cpu_ms},
        {"cpu_ms", rendered.cpu_ms},
        {"trace_ms", rendered.report.trace_ms},
        {"shade_ms", rendered.report.shade_ms},
        {"mrays_per_cpu_s", per_second(rendered.cpu_ms)},
        {"mrays_per_trace_s", per_second(rendered.report.trace_ms)},
        {"mean_r", mean.x},
        {"mean_g", mean.y},
        {"mean_b", mean.z},
        {"non_finite", static_cast<std::int64_t>(rendered.report.non_finite_samples)}}}};
  return report;
}

}  // namespace

Result<void> run_still(const StillOptions& options) {
  const auto kind = file_kind(options.out);
  if (!kind) return forward(kind);
  const auto job = prepare_still(options);
  if (!job) return forward(job);
  const auto rendered = render_still(*job, options);
  if (!rendered) return forward(rendered);
  const Plane<Rgb> radiance = radiance_on_display(*job, *rendered);
  const std::vector<StillLayer> layers = make_layers(options, *job, *rendered);
  if (const auto written = write_pictures(options, *job, *kind, radiance, layers); !written) {
    return written;
  }
  const Report report = make_report(options, *job, *rendered, radiance);
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
