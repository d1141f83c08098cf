#include "tests/bench/tradeoff_setting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/registry.h"
#include "server/session/view_builder.h"
#include "shared/base/text.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"
#include "shared/image/regions.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flicker.h"
#include "shared/metrics/flip.h"
#include "shared/metrics/foveated.h"
#include "shared/metrics/ssim.h"
#include "tests/bench/lit_scene.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using base::forward;
using image::Region;
using scheduling::TileScheduler;

constexpr Degrees kFov{90.0};
constexpr double kRefresh_hz = 72.0;
constexpr int kUnboundJpegQuality = 85;
/// A reference's paths: light is sampled once a primary sample, which come in great number.
constexpr int kReferenceLights = 1;
constexpr int kJudgements = 48;  ///< that a server's estimate is made of
const foveation::FovealGridOptions kGrid{.full_rate_radius = Degrees{5.0}};

metrics::GazedView gazed_view(const foveation::Display& display) {
  return metrics::GazedView::centred(display.width_px, display.height_px,
                                     display.pixels_per_degree());
}

/// Means of finer x finer pixels.
Plane<Rgb> shrunk(const Plane<Rgb>& fine, int finer) {
  Plane<Rgb> coarse(fine.width() / finer, fine.height() / finer);
  const float share = 1.0F / static_cast<float>(finer * finer);
  for (int y = 0; y < fine.height(); ++y)
    for (int x = 0; x < fine.width(); ++x) coarse(x / finer, y / finer) += share * fine(x, y);
  return coarse;
}

Plane<Rgb> display_linear(const image::Tone& tone, const Plane<Rgb>& radiance) {
  Plane<Rgb> shown(radiance.width(), radiance.height());
  std::ranges::transform(radiance.pixels(), shown.pixels().begin(),
                         [&](const Rgb& value) { return image::display_linear(tone, value); });
  return shown;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// A grid on which frames of these settings are rendered, and the display its rates refer to.
session::ScaledGrid grid_of(const foveation::Display& display, const FrameSettings& settings) {
  if (settings.grid == FrameGrid::Foveal)
    return session::make_scaled_grid(display, settings.scale, Gaze{}, settings.model, kGrid);
  foveation::Display small = display;
  small.width_px = std::max(1, static_cast<int>(std::lround(settings.scale * display.width_px)));
  small.height_px = std::max(1, static_cast<int>(std::lround(settings.scale * display.height_px)));
  return {small, foveation::make_uniform_grid(small)};
}

/// What a frame weighs on the wire, and what a display shows of it.
struct Sent {
  double bytes = 0.0;
  Plane<Rgb> radiance;  ///< display-linear where it was coded, else radiance
  bool is_coded = false;
};

Result<Sent> send(const kernels::ViewBuffers& frame, const image::Tone& tone,
                  const FrameSettings& settings) {
  Plane<Rgb8> codes;
  image::encode(tone, frame.radiance, codes);
  codec::ColorOptions color;
  color.jpeg_quality = settings.jpeg.value_or(kUnboundJpegQuality);
  const auto bytes = codec::encode_color(codes, codes.rect(), color);
  if (!bytes) return forward(bytes);
  const auto depth = codec::encode_depth(frame.depth_m, {.divisor = settings.depth_divisor});
  if (!depth) return forward(depth);
  Sent sent{static_cast<double>(bytes->size() + depth->bytes.size()), {}, false};
  if (!settings.jpeg) return sent;
  if (auto ok = codec::decode_color(*bytes, color.codec, codes.rect(), codes); !ok)
    return forward(ok);
  sent.radiance = image::decode_display_linear(codes);
  sent.is_coded = true;
  return sent;
}

}  // namespace

TradeoffSetting::TradeoffSetting(const TradeoffKernel& kernel, const TradeoffScale& scale,
                                 StillJob job, TileScheduler& scheduler)
    : kernel_(kernel), scale_(scale), job_(std::move(job)), scheduler_(scheduler) {
  job_.display = {math::symmetric_fov(kFov, 1.0), scale.side_px, scale.side_px};
  job_.view.grid = foveation::make_uniform_grid(job_.display);
  job_.view.gaze = {};
  const int side = scale.side_px;
  eccentricity_ = Plane<float>(side, side);
  const FoveationMap map({{job_.view.grid, job_.view.gaze, job_.display.pixel_tangent()}}, {});
  for (int y = 0; y < side; ++y) map.eccentricity_row(0, y, eccentricity_.row(y));
  weight_ = metrics::acuity_weights(gazed_view(job_.display), side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Vec3 ray = glm::normalize(job_.view.grid.ray(x, y));
      weight_(x, y) *= -ray.z * ray.z * ray.z;  // a pixel's solid angle
    }
  }
}

Result<std::unique_ptr<TradeoffSetting>> TradeoffSetting::create(const TradeoffKernel& kernel,
                                                                 const std::string& scene,
                                                                 const TradeoffScale& scale,
                                                                 const PictureCache& cache,
                                                                 TileScheduler& scheduler) {
  StillOptions still;
  still.scene = scene;
  still.kernel = kernel.name;
  still.bounces = kernel.bounces;
  auto job = prepare_still(still);
  if (!job) return forward(job);
  auto setting = std::unique_ptr<TradeoffSetting>(
      new TradeoffSetting(kernel, scale, std::move(*job), scheduler));
  Hasher hash;
  hash.add(hash_of(setting->job_.scene->scene()));
  for (const char letter : scene) hash.add(letter);
  setting->scene_hash_ = hash.value();
  auto halves = setting->make_halves(scene, cache);
  if (!halves) return forward(halves);
  setting->take(std::move(*halves));
  return setting;
}

Result<Plane<Rgb>> TradeoffSetting::path_half(const std::string& scene, std::uint64_t seed) const {
  StillOptions still;
  still.scene = scene;
  still.kernel = kernel_.reference;
  still.bounces = kernel_.bounces;
  still.light_samples = kReferenceLights;
  still.samples_per_cell = scale_.reference_samples;
  still.seed = seed;
  StillJob job = job_;
  if (kernel_.reference != kernel_.name) {
    auto made = prepare_still(still);
    if (!made) return forward(made);
    job.scene = made->scene, job.kernel = made->kernel;
  }
  auto rendered = render_still(job, still);
  if (!rendered) return forward(rendered);
  return std::move(rendered->planes.radiance);
}

/// Kernel sphere's samples lie at fixed places: patterns of two densities stand in for two draws.
Plane<Rgb> TradeoffSetting::field_half(int finer, int samples) const {
  const auto knobs = *kernels::parse_knobs(base::concat("foveation=off samples=", samples));
  const auto kernel = kernels::make_kernel(kernel_.name, {}, knobs);
  MACULA_CHECK(kernel.has_value(), "sphere has these knobs");
  kernels::View view = job_.view;
  const foveation::Display fine{job_.display.fov, finer * scale_.side_px, finer * scale_.side_px};
  view.grid = foveation::make_uniform_grid(fine);
  const FoveationMap map({{view.grid, view.gaze, fine.pixel_tangent()}}, {});
  kernels::History none;
  kernels::FrameBuffers out;
  (*kernel)->render({{&view, 1}, map, 0, 1}, *job_.scene, none, scheduler_, out);
  return shrunk(out.views.front().radiance, finer);
}

Result<TradeoffSetting::Halves> TradeoffSetting::make_halves(const std::string& scene,
                                                             const PictureCache& cache) const {
  const bool is_field = job_.scene->scene().field != nullptr;
  Error failed;
  const auto half = [&](std::uint64_t seed) {
    Hasher hash;
    hash.add(scene_hash_), hash.add(seed), hash.add(scale_.side_px);
    hash.add(is_field ? 0 : scale_.reference_samples), hash.add(kernel_.bounces);
    for (const char letter : kernel_.reference) hash.add(letter);
    return cache.at(hash.value(), scale_.side_px, scale_.side_px, [&]() -> Plane<Rgb> {
      if (is_field) return seed == 1 ? field_half(2, 16) : field_half(3, 4);
      auto made = path_half(scene, seed);
      if (made) return std::move(*made);
      failed = made.error();
      return Plane<Rgb>(scale_.side_px, scale_.side_px);
    });
  };
  Halves halves{half(1), half(2)};
  if (!failed.what.empty()) return tl::unexpected(failed);
  return halves;
}

void TradeoffSetting::take(Halves halves) {
  image::Tone& tone = job_.view.tone;
  tone = {exposure_for(halves.first), image::ToneCurve::Linear};
  first_ = display_linear(tone, halves.first), second_ = display_linear(tone, halves.second);
  Plane<Rgb> mean = halves.first;
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean.pixels()[i] = 0.5F * (mean.pixels()[i] + halves.second.pixels()[i]);
  reference_ = display_linear(tone, mean);
  image::encode(tone, mean, reference_codes_);
  reference_encoded_ = metrics::unit_from_8bit(reference_codes_);
}

namespace {

void add_regions(const Rgb& from_first, const Rgb& from_second, Radians e, double weight,
                 TradeoffRow::Regions& errors) {
  if (image::contains(Region::F5, e)) errors.f5.add(from_first, from_second);
  if (image::contains(Region::F10, e)) errors.f10.add(from_first, from_second);
  if (image::contains(Region::F25, e)) errors.f25.add(from_first, from_second);
  if (image::contains(Region::Out10, e)) errors.out10.add(from_first, from_second);
  if (image::contains(Region::Out25, e)) errors.out25.add(from_first, from_second);
  errors.seen.add(from_first, from_second, weight);
}

}  // namespace

/// Frames share their references' noise, which their sum takes for independent.
double TradeoffRow::standard_error(const CrossError& error) const {
  return std::sqrt(static_cast<double>(frames)) * error.relative_standard_error();
}

void TradeoffSetting::judge(const Plane<Rgb>& shown, TradeoffRow& row) const {
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Rgb value = shown.pixels()[i];
    add_regions(value - first_.pixels()[i], value - second_.pixels()[i],
                Radians{static_cast<double>(eccentricity_.pixels()[i])},
                static_cast<double>(weight_.pixels()[i]), row.errors);
  }
  Plane<Rgb> encoded(shown.width(), shown.height());
  row.shown = Plane<Rgb8>(shown.width(), shown.height());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Rgb c = shown.pixels()[i];
    row.shown.pixels()[i] = image::encode(image::Tone{}, c);
    encoded.pixels()[i] = {image::srgb_from_linear(c.x), image::srgb_from_linear(c.y),
                           image::srgb_from_linear(c.z)};
  }
  const metrics::GazedView view = gazed_view(job_.display);
  const Plane<float> flip = metrics::flip_map(reference_, shown, job_.display.pixels_per_degree());
  double outside = 0.0, count = 0.0;
  for (std::size_t i = 0; i < flip.size(); ++i) {
    const Radians e{static_cast<double>(eccentricity_.pixels()[i])};
    if (!image::contains(Region::Out10, e)) continue;
    outside += static_cast<double>(flip.pixels()[i]), count += 1.0;
  }
  row.flip = metrics::summarise(flip).mean;
  row.flip_out10 = outside / count;
  row.relmse = metrics::relative_mse(reference_, shown);
  row.psnr_db = metrics::psnr_db(reference_encoded_, encoded);
  row.ssim = metrics::ssim_luma(reference_encoded_, encoded);
  row.ew_psnr_db = metrics::ew_psnr_db(reference_encoded_, encoded, view);
  row.gp_psnr_db = metrics::gp_psnr_db(reference_encoded_, encoded, view);
}

/// As a server would, which judges a few pixels twice a second: frame k's part of kJudgements.
session::SpotError TradeoffSetting::estimate(const kernels::View& view, const Plane<Rgb>& shown,
                                             int k) const {
  const auto reference = kernels::make_reference(kernel_.name, {});
  MACULA_CHECK(reference.has_value(), "every measured kernel has a reference");
  session::SpotError all;
  for (int i = k; i < kJudgements; i += scale_.frames) {
    const session::FrameToJudge frame{view, job_.display, static_cast<std::uint64_t>(i), 1};
    if (const auto some = session::spot_error(**reference, *job_.scene, frame, shown, scheduler_))
      all += *some;
  }
  return all;
}

Result<TradeoffRow> TradeoffSetting::measure(const FrameSettings& settings) const {
  const auto kernel = kernels::make_kernel(kernel_.name, {}, settings.knobs);
  if (!kernel) return forward(kernel);
  const auto [display, grid] = grid_of(job_.display, settings);
  kernels::View view = job_.view;
  view.grid = grid;
  const FoveationMap map({{view.grid, view.gaze, display.pixel_tangent()}}, settings.model);
  kernels::History history;
  kernels::FrameBuffers out;
  std::uint64_t frame = 0;
  const auto render = [&] {
    return (*kernel)->render({{&view, 1}, map, frame++, 1}, *job_.scene, history, scheduler_, out);
  };
  for (int k = 0; k < scale_.warm_up; ++k) {
    view.world_from_view = swayed(job_.view.world_from_view, (k - scale_.warm_up) / kRefresh_hz);
    render();
    if (history.record == nullptr) break;  // a frame is like any other
  }
  view.world_from_view = job_.view.world_from_view;

  TradeoffRow row;
  std::vector<double> cpu_ms;
  session::SpotError estimated;
  metrics::FlickerMeter meter;
  const Plane<float> nothing(scale_.side_px, scale_.side_px, 0.0F);
  const double pixels = static_cast<double>(scale_.side_px) * scale_.side_px;
  for (int k = 0; k < scale_.frames; ++k) {
    if (k >= 2 && cpu_ms.back() > scale_.longest_ms) break;
    Stopwatch watch;
    const kernels::FrameReport report = render();
    cpu_ms.push_back(watch.lap().cpu_ms);
    row.work_per_px =
        static_cast<double>(report.primary_rays + report.shadow_rays + report.field_evaluations) /
        pixels;
    const auto sent = send(out.views.front(), view.tone, settings);
    if (!sent) return forward(sent);
    row.bytes = sent->bytes;
    const Plane<Rgb> raster =
        on_raster(sent->is_coded ? sent->radiance : out.views.front().radiance, grid, job_.display);
    const Plane<Rgb> shown = sent->is_coded ? raster : display_linear(view.tone, raster);
    judge(shown, row);
    if (settings.grid == FrameGrid::Foveal)
      estimated += estimate(view, out.views.front().radiance, k);
    ++row.frames;
    meter.add(nothing, metrics::luma(metrics::unit_from_8bit(row.shown)));
  }
  row.cpu_ms = median(cpu_ms);
  row.cells = static_cast<double>(out.views.front().radiance.size());
  row.flicker = meter.rms();
  row.rmse_estimated = settings.grid == FrameGrid::Foveal
                           ? estimated.rmse()
                           : std::numeric_limits<double>::quiet_NaN();
  return row;
}

}  // namespace macula::bench
