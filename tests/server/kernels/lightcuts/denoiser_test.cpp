#include "server/kernels/lightcuts/denoiser.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = ray::kTileSide;

/// One tile: a floor on the left half, a wall on the right, nothing in the last row.
ViewSurfaces corner() {
  ViewSurfaces view;
  view.columns = 1, view.width = kSide, view.height = kSide;
  view.tiles.resize(1);
  SurfaceTile& tile = view.tiles.front();
  tile.rect = {0, 0, kSide, kSide};
  tile.point_of.fill(SurfaceTile::kNone);
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const std::size_t cell = SurfaceTile::cell_index(x, y), point = tile.points.count++;
      tile.cell_of[point] = static_cast<std::uint16_t>(cell);
      tile.point_of[cell] = static_cast<std::uint16_t>(point);
      const bool floor = x < kSide / 2;
      const float u = 0.02F * static_cast<float>(x - kSide / 2), v = 0.02F * static_cast<float>(y);
      tile.points.position.set(point,
                               floor ? Vec3{u, -1.0F, v - 3.0F} : Vec3{0, u - 1.0F, v - 3.0F});
      tile.points.reflectors.shading.set(point, floor ? Vec3{0, 1, 0} : Vec3{-1, 0, 0});
    }
  }
  return view;
}
float noise(int x, int y) {
  return math::unit_float(math::hash_combine(3, static_cast<std::uint64_t>(y * kSide + x)));
}
struct Seen {
  std::uint16_t samples = 1;  ///< a cell
  float eccentricity = 0.5F;  ///< radians
};
Plane<Rgb> smoothed(Plane<Rgb> light, const Seen& seen = {}) {
  const Plane<float> eccentricity(light.width(), light.height(), seen.eccentricity);
  TileScheduler scheduler(1);
  View view;
  for (int i = 0; i <= kSide; ++i) {
    view.grid.x_edges.push_back(0.01F * static_cast<float>(i - kSide / 2));
  }
  view.grid.y_edges = view.grid.x_edges;
  LightMemory memory;
  const Plane<std::uint16_t> samples(light.width(), light.height(), seen.samples);
  denoise({view, corner(), eccentricity, samples}, scheduler, light, memory);
  return light;
}

TEST(Denoiser, NoiseOnEachSideOfACornerGoesAndTheSidesStayApart) {
  Plane<Rgb> light(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      light(x, y) = Rgb{(x < kSide / 2 ? 1.0F : 2.0F) + noise(x, y) - 0.5F};
    }
  }
  const Plane<Rgb> after = smoothed(light);
  double square = 0.0;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double off = static_cast<double>(after(x, y).x) - (x < kSide / 2 ? 1.0 : 2.0);
      square += off * off / (kSide * (kSide - 1));
    }
  }
  EXPECT_LT(square, 1.0 / 12.0 / 10.0) << "a tenth of the variance that was there";
  for (int x = 0; x < kSide; ++x) EXPECT_EQ(after(x, kSide - 1), light(x, kSide - 1));
}

TEST(Denoiser, EvenLightStaysAndALoneSpikeAlmostGoes) {
  Plane<Rgb> light(kSide, kSide, Rgb{0.7F, 0.5F, 0.3F});
  const Plane<Rgb> even = smoothed(light);
  light(3, 5) = Rgb{900.0F};
  const Plane<Rgb> after = smoothed(light);
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      EXPECT_NEAR(even(x, y).x, 0.7F, 1e-6F);
      EXPECT_LT(after(x, y).x, 2.0F) << "of 900";
    }
  }
}

/// Smoothing within the noise darkens what is skewed a little; spikes cut to the brightest beside
/// them, however like it, would take away twice as much.
TEST(Denoiser, FewSamplesKeepTheirMean) {
  Plane<Rgb> light(kSide, kSide);
  double before = 0.0, after = 0.0;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      light(x, y) = Rgb{-std::log(1.0F - noise(x, y))};
      before += static_cast<double>(light(x, y).x);
    }
  }
  light = smoothed(light);
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x < kSide; ++x) after += static_cast<double>(light(x, y).x);
  EXPECT_GT(after, 0.85 * before);
}

TEST(Denoiser, SmoothsWhatManySamplesFoundNearTheGazeLessThanTheRest) {
  Plane<Rgb> light(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) light(x, y) = Rgb{0.5F + noise(x, y)};
  }
  const auto left = [&](const Seen& seen) {
    const Plane<Rgb> after = smoothed(light, seen);
    double square = 0.0;
    for (int y = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        square += std::pow(static_cast<double>(after(x, y).x) - 1.0, 2) / (kSide * (kSide - 1));
    }
    return square;
  };
  constexpr float kNear = 0.2F, kFar = 0.5F;
  const double many_near = left({16, kNear});
  EXPECT_LT(many_near, 1.0 / 12.0 / 2.0) << "one pass";
  EXPECT_GT(many_near, 1.5 * left({1, kNear}));
  EXPECT_GT(many_near, 1.5 * left({16, kFar}));
}

}  // namespace
}  // namespace macula::kernels::lightcuts
