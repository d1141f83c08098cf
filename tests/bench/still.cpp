#include "tests/bench/still.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "server/shading/exr.h"
#include "shared/base/text.h"
#include "shared/image/draw.h"
#include "shared/image/png.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

using base::bad_input;
using base::forward;
using image::Plane;

/// Samples a cell are taken in passes of at most this many, so that progress can be shown.
constexpr int kSamplesPerPass = 16;
/// Eye height of a standing viewer where a scene brings no camera.
constexpr double kStandingEye_m = 1.6;

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

// ---- what is looked at ----

struct Shot {
  Pose world_from_view;
  Radians vertical_fov{Degrees{60.0}};
};

Result<Shot> explicit_shot(const StillCamera& camera, double meters_per_unit) {
  const DVec3 forward_axis = camera.target - camera.eye;
  if (!(glm::length(glm::cross(forward_axis, camera.up)) > 0.0)) {
    return bad_input("looks at its own place or along its up vector", "--camera",
                     "eye, target and up must span a plane");
  }
  const Pose pose =
      math::look_at(meters_per_unit * camera.eye, meters_per_unit * camera.target, camera.up);
  if (!math::is_valid(pose)) return bad_input("is not finite or beyond 1e7 m", "--camera");
  return Shot{pose, camera.vertical_fov};
}

Result<Shot> named_shot(const scene::Scene& scene, const std::string& name) {
  std::string names;
  for (const scene::Camera& camera : scene.cameras) {
    if (camera.name == name) return Shot{camera.world_from_view, camera.vertical_fov};
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  return bad_input(base::concat("the scene has no camera '", name, "'"), "--camera",
                   names.empty() ? "it has none; give one by eight numbers and a field of view"
                                 : "it has: " + names);
}

Result<Shot> choose_shot(const StillOptions& options, const scene::Scene& scene) {
  if (options.camera) return explicit_shot(*options.camera, scene.settings.meters_per_unit);
  if (!options.camera_name.empty()) return named_shot(scene, options.camera_name);
  if (!scene.cameras.empty()) {
    return Shot{scene.cameras.front().world_from_view, scene.cameras.front().vertical_fov};
  }
  const Pose stage_from_view{DVec3{0.0, kStandingEye_m, 0.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
  return Shot{scene.settings.scene_from_stage * stage_from_view};
}

Gaze gaze_of(const StillGaze& angles) {
  const double yaw = Radians{angles.yaw}.value(), pitch = Radians{angles.pitch}.value();
  return {Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch))};
}

/// Everything one render needs, made from the options.
struct Job {
  std::shared_ptr<const kernels::SceneFrame> scene;
  foveation::Display display;
  foveation::RateModel rate;
  kernels::View view;
  std::string kernel;
  unsigned wanted = 0;
};

unsigned plane_flag(StillPlane plane) {
  switch (plane) {
    case StillPlane::Depth:
      return 0;  // always made
    case StillPlane::Normal:
      return kernels::kNormal;
    case StillPlane::Albedo:
      return kernels::kAlbedo;
    case StillPlane::Id:
      return kernels::kSurfaceId;
    case StillPlane::Rate:
      return kernels::kRate;
    case StillPlane::Samples:
      return kernels::kSamples;
    case StillPlane::Variance:
      return kernels::kVariance;
    case StillPlane::Steps:
      return 0;  // refused in prepare()
  }
  return 0;
}

Result<Job> prepare(const StillOptions& options) {
  const auto rate = foveation::find_rate_model(options.rate_model);
  if (!rate) return forward(rate);
  if (std::ranges::count(options.planes, StillPlane::Steps) > 0) {
    return bad_input("'steps' is made by kernels that march distance fields only", "--aov");
  }
  const auto loaded = scene::load_scene(options.scene);
  if (!loaded) return forward(loaded);
  const auto shot = choose_shot(options, **loaded);
  if (!shot) return forward(shot);
  auto frame = kernels::SceneFrame::create(*loaded);
  if (!frame) return forward(frame);
  Job job;
  job.scene = *frame;
  job.display = {math::symmetric_fov(shot->vertical_fov,
                                     static_cast<double>(options.width_px) / options.height_px),
                 options.width_px, options.height_px};
  job.rate = *rate;
  job.view.world_from_view = shot->world_from_view;
  job.view.gaze = gaze_of(options.gaze);
  job.view.tone = (*loaded)->settings.tone;
  job.view.grid = options.grid == StillGrid::Uniform
                      ? foveation::make_uniform_grid(job.display)
                      : foveation::make_foveal_grid(job.display, job.view.gaze, *rate);
  job.kernel = options.kernel != "auto" ? options.kernel : (options.bounces > 0 ? "brute" : "ray");
  for (const StillPlane plane : options.planes) job.wanted |= plane_flag(plane);
  return job;
}

// ---- rendering ----

struct Rendered {
  kernels::ViewBuffers planes;
  kernels::FrameReport report;
  double cpu_ms = 0.0;
};

/// Adds one pass of `share` of all samples to the mean; other planes stay those of the first pass.
void merge(kernels::ViewBuffers& mean, const kernels::ViewBuffers& pass, float share) {
  for (std::size_t i = 0; i < mean.radiance.size(); ++i) {
    mean.radiance.pixels()[i] += share * pass.radiance.pixels()[i];
  }
  for (std::size_t i = 0; i < mean.variance.size(); ++i) {
    mean.variance.pixels()[i] += share * share * pass.variance.pixels()[i];
  }
  for (std::size_t i = 0; i < mean.samples.size(); ++i) {
    mean.samples.pixels()[i] += pass.samples.pixels()[i];
  }
}

kernels::ViewBuffers start_from(const kernels::ViewBuffers& pass, float share) {
  kernels::ViewBuffers mean = pass;
  for (Rgb& value : mean.radiance.pixels()) value *= share;
  for (float& value : mean.variance.pixels()) value *= share * share;
  return mean;
}

Result<Rendered> render(const Job& job, const StillOptions& options) {
  kernels::KernelOptions settings;
  settings.mode = options.mode == StillMode::Fast ? kernels::Mode::Fast : kernels::Mode::Exact;
  settings.area_light_samples = options.light_samples;
  settings.ambient_samples = options.light_samples;
  settings.bounces = options.bounces;
  settings.lambert_only = options.material == StillMaterial::Lambert;

  scheduling::TileScheduler scheduler(options.threads);
  const FoveationMap map({{job.view.grid, job.view.gaze, job.display.pixel_tangent()}}, job.rate);
  kernels::History history;
  kernels::FrameBuffers buffers;
  buffers.wanted = job.wanted;
  Rendered rendered;
  Progress progress("rendering", options.samples_per_cell);
  const std::clock_t begin = std::clock();
  for (int done = 0, pass = 0; done < options.samples_per_cell; ++pass) {
    settings.samples_per_cell = std::min(kSamplesPerPass, options.samples_per_cell - done);
    const auto kernel = kernels::make_kernel(job.kernel, settings);
    if (!kernel) return forward(kernel);
    const kernels::FrameRequest request{
        {&job.view, 1}, map, static_cast<std::uint64_t>(pass), options.seed};
    const auto report = (*kernel)->render(request, *job.scene, history, scheduler, buffers);
    const float share = static_cast<float>(settings.samples_per_cell) /
                        static_cast<float>(options.samples_per_cell);
    if (pass == 0) {
      rendered.planes = start_from(buffers.views.front(), share);
    } else {
      merge(rendered.planes, buffers.views.front(), share);
    }
    rendered.report.primary_rays += report.primary_rays;
    rendered.report.shadow_rays += report.shadow_rays;
    rendered.report.non_finite_samples += report.non_finite_samples;
    rendered.report.trace_ms += report.trace_ms;
    rendered.report.shade_ms += report.shade_ms;
    done += settings.samples_per_cell;
    progress.advance(settings.samples_per_cell);
  }
  rendered.cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return rendered;
}

// ---- from cells to pixels ----

/// Draws every cell of the grid where the display's pixels see it; a uniform grid is copied.
template <class T>
Plane<T> on_display(const Plane<T>& cells, const Job& job) {
  const PixelGrid raster = foveation::make_uniform_grid(job.display);
  if (raster == job.view.grid) return cells;
  Plane<T> pixels(raster.width(), raster.height());
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      const auto at = job.view.grid.locate(raster.tangent(x, y));
      if (!at) continue;
      pixels(x, y) = cells(std::min(static_cast<int>(at->x), cells.width() - 1),
                           std::min(static_cast<int>(at->y), cells.height() - 1));
    }
  }
  return pixels;
}

template <class T, class Value>
Plane<float> component(const Plane<T>& plane, Value value) {
  Plane<float> result(plane.width(), plane.height());
  std::ranges::transform(plane.pixels(), result.pixels().begin(),
                         [&](const T& pixel) { return static_cast<float>(value(pixel)); });
  return result;
}

/// One further plane as named channels, and how a picture of it is drawn.
struct Layer {
  std::string name;
  std::vector<std::pair<std::string, Plane<float>>> channels;
};

template <class T>
Layer vector_layer(const std::string& name, const Plane<T>& plane, const char* suffixes) {
  Layer layer{name, {}};
  for (int c = 0; c < 3; ++c) {
    layer.channels.emplace_back(base::concat(name, ".", suffixes[c]),
                                component(plane, [c](const T& v) { return v[c]; }));
  }
  return layer;
}
Layer scalar_layer(const std::string& name, const char* channel, Plane<float> plane) {
  Layer layer{name, {}};
  layer.channels.emplace_back(base::concat(name, ".", channel), std::move(plane));
  return layer;
}

Layer make_layer(StillPlane plane, const kernels::ViewBuffers& planes, const Job& job) {
  switch (plane) {
    case StillPlane::Depth:
      return scalar_layer("depth", "Z", on_display(planes.depth_m, job));
    case StillPlane::Normal:
      return vector_layer("normal", on_display(planes.normal, job), "XYZ");
    case StillPlane::Albedo:
      return vector_layer("albedo", on_display(planes.albedo, job), "RGB");
    case StillPlane::Id:
      return scalar_layer("id", "Y",
                          component(on_display(planes.surface_id, job), std::identity{}));
    case StillPlane::Rate:
      return scalar_layer("rate", "Y", on_display(planes.rate, job));
    case StillPlane::Samples:
      return scalar_layer("samples", "Y", on_display(planes.samples, job));
    case StillPlane::Variance:
      return scalar_layer("variance", "Y", on_display(planes.variance, job));
    case StillPlane::Steps:
      break;
  }
  return {};
}

/// Three channels are shown as a colour (normals from [-1, 1]), one in false colour over its range.
Plane<Rgb8> picture_of(const Layer& layer) {
  const Plane<float>& first = layer.channels.front().second;
  if (layer.channels.size() == 3) {
    const bool is_signed = layer.name == "normal";
    Plane<Rgb8> picture(first.width(), first.height());
    for (std::size_t i = 0; i < picture.size(); ++i) {
      Rgb color{first.pixels()[i], layer.channels[1].second.pixels()[i],
                layer.channels[2].second.pixels()[i]};
      if (is_signed) color = 0.5F * color + 0.5F;
      picture.pixels()[i] = image::encode(image::Tone{}, color);
    }
    return picture;
  }
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const float value : first.pixels()) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value), high = std::max(high, value);
  }
  return image::false_color(first, low < high ? low : low - 1.0F, high);
}

std::string beside(const std::string& out, const std::string& suffix) {
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + suffix)).string();
}

Result<void> write_planes(const StillOptions& options, const Job& job, const Rendered& rendered) {
  if (options.planes.empty()) return {};
  std::vector<Layer> layers;
  for (const StillPlane plane : options.planes) {
    layers.push_back(make_layer(plane, rendered.planes, job));
  }
  std::vector<shading::NamedPlane> channels;
  for (const Layer& layer : layers) {
    for (const auto& [name, plane] : layer.channels) channels.push_back({name, &plane});
    const auto drawn =
        image::write_png(beside(options.out, "." + layer.name + ".png"), picture_of(layer));
    if (!drawn) return drawn;
  }
  return shading::write_exr_layers(beside(options.out, ".planes.exr"), channels);
}

Result<void> write_picture(const StillOptions& options, const Job& job, FileKind kind,
                           const Plane<Rgb>& radiance) {
  if (kind == FileKind::Exr) return shading::write_exr(options.out, radiance);
  Plane<Rgb8> encoded;
  image::encode(job.view.tone, radiance, encoded);
  return image::write_png(options.out, encoded);
}

// ---- the report ----

DVec3 mean_of(const Plane<Rgb>& plane) {
  DVec3 sum{0.0};
  for (const Rgb& value : plane.pixels()) sum += DVec3(value);
  return sum / static_cast<double>(plane.size());
}

Report make_report(const StillOptions& options, const Job& job, const Rendered& rendered,
                   const Plane<Rgb>& radiance) {
  const auto rays = static_cast<double>(rendered.report.primary_rays + rendered.report.shadow_rays);
  const auto per_second = [rays](double ms) { return ms > 0.0 ? rays / (1e3 * ms) : 0.0; };
  const DVec3 mean = mean_of(radiance);
  const auto cells = static_cast<std::int64_t>(rendered.planes.radiance.size());
  const auto pixels = static_cast<double>(job.display.width_px) * job.display.height_px;
  Report report{"still",
                {{"scene", options.scene},
                 {"kernel", job.kernel},
                 {"mode", std::string(options.mode == StillMode::Fast ? "fast" : "exact")},
                 {"width_px", std::int64_t{options.width_px}},
                 {"height_px", std::int64_t{options.height_px}},
                 {"samples_per_cell", std::int64_t{options.samples_per_cell}},
                 {"light_samples", std::int64_t{options.light_samples}},
                 {"ambient_samples", std::int64_t{options.light_samples}},
                 {"bounces", std::int64_t{options.bounces}},
                 {"rate_model", options.rate_model},
                 {"seed", static_cast<std::int64_t>(options.seed)}},
                {{{"cells", cells},
                  {"cells_per_px", static_cast<double>(cells) / pixels},
                  {"primary_rays", static_cast<std::int64_t>(rendered.report.primary_rays)},
                  {"shadow_rays", static_cast<std::int64_t>(rendered.report.shadow_rays)},
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
  const auto job = prepare(options);
  if (!job) return forward(job);
  const auto rendered = render(*job, options);
  if (!rendered) return forward(rendered);
  const Plane<Rgb> radiance = on_display(rendered->planes.radiance, *job);
  if (const auto written = write_picture(options, *job, *kind, radiance); !written) return written;
  if (const auto written = write_planes(options, *job, *rendered); !written) return written;
  const Report report = make_report(options, *job, *rendered, radiance);
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
