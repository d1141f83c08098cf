#include "tests/bench/culling_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "server/kernels/brute.h"
#include "shared/foveation/eccentricity.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flicker.h"

namespace macula::bench {
namespace {

constexpr int kThinning = CullingSetting::kThinning;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool is_inside(const kernels::View& view, const image::Pixel& at) {
  return foveation::eccentricity(view.gaze.direction, view.grid.ray(at.x, at.y)) <=
         Radians{CullingSetting::fovea()};
}

/// `count` of the pixels by the order of their hashes.
void draw(std::vector<image::Pixel>& pixels, std::size_t count) {
  const auto rank = [](const image::Pixel& at) {
    return math::hash_combine(static_cast<std::uint64_t>(at.x), static_cast<std::uint64_t>(at.y));
  };
  count = std::min(count, pixels.size());
  std::ranges::sort(pixels, {}, rank);
  pixels.resize(count);
}

/// What the eye sees in the middle of a pixel; none where it sees nothing.
std::optional<kernels::SurfacePoint> seen_at(const kernels::View& view, const image::Pixel& at,
                                             const kernels::SceneFrame& scene) {
  const DVec3 along = view.world_from_view.transform_direction(DVec3(view.grid.ray(at.x, at.y)));
  const Vec3 eye(view.world_from_view.position);
  const auto hit = scene.intersect(visibility::Ray{eye, Vec3(along), 0.0F, kInfinity, {}});
  if (!hit) return std::nullopt;
  kernels::SurfacePoint point;
  point.position = view.world_from_view.position + static_cast<double>(hit->t) * along;
  point.to_eye = Vec3(-glm::normalize(along));
  point.geometric_normal = scene.surface(*hit, point.position).geometric_normal;
  if (glm::dot(point.geometric_normal, point.to_eye) < 0.0F) point.geometric_normal *= -1.0F;
  point.instance = hit->instance, point.triangle = hit->triangle;
  point.barycentric = {hit->u, hit->v};
  return point;
}

Plane<Rgb> lit_by_paths(const CullingSetting& setting, std::span<const image::Pixel> pixels,
                        const kernels::SceneFrame& scene, int samples, std::uint64_t seed,
                        scheduling::TileScheduler& scheduler) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = samples;
  options.ambient_samples = 0;
  options.lambert_only = true;
  options.bounces = 1;
  Plane<Rgb> row(static_cast<int>(pixels.size()), 1, Rgb{0.0F});
  std::vector<kernels::SurfacePoint> points;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    auto point = seen_at(setting.view(), pixels[i], scene);
    if (!point) continue;
    point->key = math::hash_combine(seed, i);
    points.push_back(*point), places.push_back(i);
  }
  std::vector<Rgb> light(points.size());
  kernels::BruteKernel(options).shade(points, scene, scheduler, light);
  for (std::size_t i = 0; i < places.size(); ++i) row.pixels()[places[i]] = light[i];
  return row;
}

Plane<float> encoded_luma(const image::Tone& tone, const Plane<Rgb>& row, std::size_t begin,
                          std::size_t end) {
  Plane<Rgb> part(static_cast<int>(end - begin), 1);
  std::ranges::copy(row.pixels().subspan(begin, end - begin), part.pixels().begin());
  return metrics::luma(display_encoded(tone, part));
}

}  // namespace

double JudgedPixels::share(std::size_t i) const {
  return is_inside(i) ? inside_share / static_cast<double>(inside)
                      : (1.0 - inside_share) / static_cast<double>(pixels.size() - inside);
}

JudgedPixels judged_pixels(const CullingSetting& setting, int each) {
  const auto& display = setting.display();
  std::vector<image::Pixel> inside, outside;
  for (int y = kThinning / 2; y < display.height_px; y += kThinning)
    for (int x = kThinning / 2; x < display.width_px; x += kThinning)
      (is_inside(setting.view(), {x, y}) ? inside : outside).push_back({x, y});
  JudgedPixels judged;
  judged.inside_share =
      static_cast<double>(inside.size()) / static_cast<double>(inside.size() + outside.size());
  draw(inside, static_cast<std::size_t>(each)), draw(outside, static_cast<std::size_t>(each));
  judged.inside = inside.size();
  judged.pixels = std::move(inside);
  judged.pixels.insert(judged.pixels.end(), outside.begin(), outside.end());
  return judged;
}

Plane<Rgb> listed(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels) {
  Plane<Rgb> row(static_cast<int>(pixels.size()), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    row.pixels()[i] = radiance(pixels[i].x, pixels[i].y);
  return row;
}

Plane<Rgb> listed_of_thinned(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels) {
  Plane<Rgb> row(static_cast<int>(pixels.size()), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    row.pixels()[i] = radiance(pixels[i].x / kThinning, pixels[i].y / kThinning);
  return row;
}

Result<HalfReferences> path_references(const CullingSetting& setting, const JudgedPixels& judged,
                                       int frame, int samples, const PictureCache& cache,
                                       scheduling::TileScheduler& scheduler) {
  const auto scene = setting.frame(frame);
  if (!scene) return base::forward(scene);
  const auto half = [&](std::uint64_t seed) {
    Hasher hash;
    hash.add(hash_of(setting.scene())), hash.add(seed), hash.add(frame), hash.add(samples);
    hash.add_all(std::span<const image::Pixel>(judged.pixels));
    for (const DMat4& place : (*scene)->pose().world_from_object) hash.add(place);
    for (const scene::Light& light : (*scene)->lights().punctual()) hash.add(light.position);
    return cache.at(hash.value(), static_cast<int>(judged.pixels.size()), 1, [&] {
      return lit_by_paths(setting, judged.pixels, **scene, samples, seed, scheduler);
    });
  };
  return HalfReferences{half(0x5EED'0001U), half(0x5EED'0002U)};
}

double FoveaErrors::relative_standard_error() const {
  const double mean = inside.sum / inside.weight;
  return mean > 0.0 ? 0.5 * inside_spread / mean : INFINITY;  // half: of the root
}

CullingJudge::CullingJudge(JudgedPixels judged, HalfReferences references)
    : judged_(std::move(judged)), references_(std::move(references)) {
  constexpr double kMiddleGrey = 0.18;
  const double mean = reference_luminance();
  if (mean > 0.0) tone_.exposure_ev = static_cast<float>(std::log2(kMiddleGrey / mean));
}

Rgb CullingJudge::shown(const Rgb& radiance) const {
  return glm::clamp(std::exp2(tone_.exposure_ev) * radiance, Rgb{0.0F}, Rgb{1.0F});
}

FoveaErrors CullingJudge::errors(const Plane<Rgb>& row) const {
  FoveaErrors errors;
  double square = 0.0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Rgb value = shown(row.pixels()[i]);
    const Rgb first = value - shown(references_.first.pixels()[i]);
    const Rgb second = value - shown(references_.second.pixels()[i]);
    (judged_.is_inside(i) ? errors.inside : errors.outside).add(first, second);
    const double product = static_cast<double>(glm::dot(first, second)) / 3.0;
    if (judged_.is_inside(i)) square += product * product;
  }
  const double n = errors.inside.weight, mean = errors.inside.sum / n;
  errors.inside_spread = std::sqrt(std::max(square / n - mean * mean, 0.0) / (n - 1.0));
  return errors;
}

FoveaErrors CullingJudge::difference(const Plane<Rgb>& a, const Plane<Rgb>& b) const {
  FoveaErrors errors;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Rgb off = shown(a.pixels()[i]) - shown(b.pixels()[i]);
    (judged_.is_inside(i) ? errors.inside : errors.outside).add(off, off);
  }
  return errors;
}

double CullingJudge::mean_luminance(const Plane<Rgb>& row) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < row.size(); ++i)
    sum += judged_.share(i) * static_cast<double>(image::luminance(row.pixels()[i]));
  return sum;
}

double CullingJudge::reference_luminance() const {
  return 0.5 * (mean_luminance(references_.first) + mean_luminance(references_.second));
}

double CullingJudge::flicker(std::span<const Plane<Rgb>> rows, std::span<const Plane<Rgb>> steady,
                             SceneMotion motion) const {
  const double in = region_flicker(rows, steady, motion, 0, judged_.inside);
  const double out = region_flicker(rows, steady, motion, judged_.inside, judged_.pixels.size());
  return std::sqrt(judged_.inside_share * in * in + (1.0 - judged_.inside_share) * out * out);
}

double CullingJudge::region_flicker(std::span<const Plane<Rgb>> rows,
                                    std::span<const Plane<Rgb>> steady, SceneMotion motion,
                                    std::size_t begin, std::size_t end) const {
  const auto luma = [&](const Plane<Rgb>& row) { return encoded_luma(tone_, row, begin, end); };
  const int width = static_cast<int>(end - begin);
  if (motion == SceneMotion::Still) {
    metrics::FlickerMeter meter(0);
    for (const Plane<Rgb>& row : rows) meter.add(Plane<float>(width, 1, 0.0F), luma(row));
    return meter.rms();
  }
  const Plane<unsigned char> everywhere(width, 1, 1);
  double square = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double step = metrics::warped_flicker_rms(
        {luma(rows[k]), luma(rows[k - 1]), luma(steady[k]), luma(steady[k - 1])}, everywhere);
    square += step * step / static_cast<double>(rows.size() - 1);
  }
  return std::sqrt(square);
}

}  // namespace macula::bench
