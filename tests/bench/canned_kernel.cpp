#include "tests/bench/canned_kernel.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace macula::bench {
namespace {

constexpr int kSide = 1024;                  // texels of the period, a power of two
constexpr double kTexelsPerRadian = 1200.0;  // finer than a headset's 20 pixels per degree
constexpr float kDepthPeriod_texels = 256.0F;

float hashed(int octave, int x, int y) {
  const auto key = math::hash_combine(
      static_cast<std::uint64_t>(octave) << 40 | static_cast<std::uint64_t>(x) << 20,
      static_cast<std::uint64_t>(y));
  return 2.0F * math::unit_float(key) - 1.0F;
}

/// Value noise of one octave: `cells` random values a period, smoothly between.
float octave_at(int octave, int cells, int x, int y) {
  const float u = static_cast<float>(x) * static_cast<float>(cells) / kSide;
  const float v = static_cast<float>(y) * static_cast<float>(cells) / kSide;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const auto smooth = [](float t) { return t * t * (3.0F - 2.0F * t); };
  const float s = smooth(u - static_cast<float>(i)), t = smooth(v - static_cast<float>(j));
  const auto at = [&](int a, int b) { return hashed(octave, a % cells, b % cells); };
  return std::lerp(std::lerp(at(i, j), at(i + 1, j), s),
                   std::lerp(at(i, j + 1), at(i + 1, j + 1), s), t);
}

std::vector<Rgb> make_texture() {
  std::vector<Rgb> texture(static_cast<std::size_t>(kSide) * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      float value = 0.0F;
      for (int octave = 0; octave < 8; ++octave) {
        value += 0.35F * octave_at(octave, 4 << octave, x, y) /
                 std::sqrt(1.0F + static_cast<float>(octave));
      }
      const float grey = std::clamp(0.25F * std::exp2(1.5F * value), 0.0F, 1.0F);
      const float warm = 0.12F * octave_at(20, 8, x, y);
      texture[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)] =
          grey * Rgb{1.0F + warm, 1.0F, 1.0F - warm};
    }
  }
  return texture;
}

/// How far the head's turn pans the texture, in texels.
DVec2 pan_of(const Pose& world_from_view) {
  const DVec3 ahead = world_from_view.transform_direction(DVec3{0.0, 0.0, -1.0});
  const double yaw = std::atan2(ahead.x, -ahead.z),
               pitch = std::asin(std::clamp(ahead.y, -1.0, 1.0));
  return kTexelsPerRadian * DVec2{yaw, -pitch};
}

/// Texel of every cell along one axis.
std::vector<int> texels(const std::vector<float>& edges, double pan) {
  std::vector<int> along;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double at = kTexelsPerRadian * 0.5 * (edges[i] + edges[i + 1]) + pan;
    along.push_back(static_cast<int>(std::lround(at)) & (kSide - 1));
  }
  return along;
}

float wave(int texel) {
  return std::sin(6.2831853F * static_cast<float>(texel) / kDepthPeriod_texels);
}

}  // namespace

CannedPattern::CannedPattern(double noise_levels)
    : texture_(make_texture()), noise_(noise_levels) {}

void CannedPattern::fill(const Pose& world_from_view, const PixelGrid& grid, std::uint64_t frame,
                         image::Plane<Rgb>& radiance, image::Plane<float>& depth_m) const {
  const DVec2 pan = pan_of(world_from_view);
  const std::vector<int> columns = texels(grid.x_edges, pan.x), rows = texels(grid.y_edges, pan.y);
  radiance.resize(grid.width(), grid.height(), Rgb{0.0F});
  depth_m.resize(grid.width(), grid.height(), 0.0F);
  const auto grain = static_cast<float>(noise_ / 255.0);
  for (int y = 0; y < grid.height(); ++y) {
    const Rgb* const row = &texture_[static_cast<std::size_t>(rows[y]) * kSide];
    const float depth_of_row = 3.0F + wave(rows[y]);
    for (int x = 0; x < grid.width(); ++x) {
      radiance(x, y) = row[columns[x]];
      depth_m(x, y) = depth_of_row;
      if (grain <= 0.0F) continue;
      // Four uniform numbers are near enough to a Gaussian: their variance is 4 / 12.
      float sum = -2.0F;
      for (std::uint64_t i = 0; i < 4; ++i)
        sum += math::unit_float(math::hash_combine(frame * 4 + i, grid.cell_key(x, y)));
      radiance(x, y) += radiance(x, y) * (grain * 6.0F * sum);
    }
  }
}

kernels::FrameReport CannedKernel::render(const kernels::FrameRequest& request,
                                          const kernels::SceneFrame&, kernels::History&,
                                          scheduling::TileScheduler&,
                                          kernels::FrameBuffers& out) const {
  kernels::FrameReport report;
  out.views.resize(request.views.size());
  for (std::size_t i = 0; i < out.views.size(); ++i) {
    const kernels::View& view = request.views[i];
    pattern_->fill(view.world_from_view, view.grid, request.frame, out.views[i].radiance,
                   out.views[i].depth_m);
    report.primary_rays += out.views[i].radiance.size();
  }
  return report;
}

void CannedKernel::shade(std::span<const kernels::SurfacePoint>, const kernels::SceneFrame&,
                         scheduling::TileScheduler&, std::span<Rgb> out) const {
  std::fill(out.begin(), out.end(), Rgb{0.5F});
}

}  // namespace macula::bench
