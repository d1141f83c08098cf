#include "server/kernels/lightcuts/atrous.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace macula::kernels::lightcuts {
namespace {

constexpr int kMostPasses = 4;
constexpr float kPerDegree = std::numbers::pi_v<float> / 180.0F;
/// Standard deviations that differences may have; Schied et al. take 4, with variances over time,
/// which hold no edges of shadows.
constexpr float kStops = 3.0F;
/// B3 spline, at distances 0, 1 and 2.
constexpr float kSpline[3] = {3.0F / 8.0F, 1.0F / 4.0F, 1.0F / 16.0F};

/// What a cell is compared by. depth_m is the distance to the eye; 0: no surface.
struct Guide {
  Vec3 position{0.0F}, normal{0.0F};
  float depth_m = 0.0F;
  int passes = 0;
};
struct Noisy {
  Rgb light{0.0F};
  float luminance = 0.0F, variance = 0.0F;
};

/// How alike two surfaces are, in [0, 1]: light does not change much along a plane.
float alike(const Guide& a, const Guide& b) {
  if (!(b.depth_m > 0.0F)) return 0.0F;
  const float facing = glm::dot(a.normal, b.normal);
  if (facing < 0.8F) return 0.0F;
  const Vec3 between = b.position - a.position;
  // Planes may be apart by an eighth of what lies between, and by what a cell spans.
  const float off = std::abs(glm::dot(a.normal, between));
  const float allowed = 0.125F * glm::length(between) + 2e-3F * a.depth_m;
  if (off > allowed) return 0.0F;
  const float square = facing * facing, fourth = square * square;
  return fourth * fourth * fourth * fourth;
}

class Smoother {
 public:
  Smoother(const ViewSurfaces& surfaces, const Vec3& eye, const Plane<float>& eccentricity,
           TileScheduler& scheduler, Plane<Rgb>& light)
      : scheduler_(scheduler), light_(light), guides_(light.width(), light.height()) {
    for (const SurfaceTile& tile : surfaces.tiles) {
      for (std::size_t i = 0; i < tile.points.count; ++i) {
        const image::Pixel at = tile.pixel(i);
        const Vec3 position = tile.points.position[i];
        guides_(at.x, at.y) = {position, tile.points.reflectors.shading[i],
                               glm::length(position - eye), passes(eccentricity(at.x, at.y))};
      }
    }
  }

  scheduling::Outcome run() {
    Plane<Noisy> now(light_.width(), light_.height()), next(light_.width(), light_.height());
    if (rows([&](int x, int y) { now(x, y) = without_spike(x, y); })) return kStopped;
    if (rows([&](int x, int y) { next(x, y) = with_variance(now, x, y); })) return kStopped;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      std::swap(now, next);
      if (rows([&](int x, int y) { next(x, y) = filtered(now, x, y, pass); })) return kStopped;
    }
    for (std::size_t i = 0; i < light_.size(); ++i) light_.pixels()[i] = next.pixels()[i].light;
    return scheduling::Outcome::Completed;
  }

 private:
  static constexpr auto kStopped = scheduling::Outcome::Stopped;

  /// The last one spans 2^passes cells to either side.
  static int passes(float eccentricity) {
    return 2 + (eccentricity > 10.0F * kPerDegree) + (eccentricity > 25.0F * kPerDegree);
  }
  /// True: stopped.
  template <class Body>
  bool rows(const Body& body) {
    const auto outcome =
        scheduler_.run(static_cast<std::size_t>(light_.height()), [&](std::size_t row) {
          for (int x = 0; x < light_.width(); ++x) body(x, static_cast<int>(row));
        });
    return outcome == kStopped;
  }
  template <class Visit>
  void around(int x, int y, int step, int reach, const Visit& visit) const {
    for (int dy = -reach; dy <= reach; ++dy) {
      const int ny = y + step * dy;
      if (ny < 0 || ny >= light_.height()) continue;
      for (int dx = -reach; dx <= reach; ++dx) {
        const int nx = x + step * dx;
        if (nx >= 0 && nx < light_.width()) visit(nx, ny, dx, dy);
      }
    }
  }

  /// No brighter than the brightest like surface beside it.
  Noisy without_spike(int x, int y) const {
    const Guide& guide = guides_(x, y);
    Noisy mine{light_(x, y), image::luminance(light_(x, y)), 0.0F};
    if (!(guide.depth_m > 0.0F)) return mine;
    float most = -1.0F;
    around(x, y, 1, 1, [&](int nx, int ny, int dx, int dy) {
      if ((dx == 0 && dy == 0) || alike(guide, guides_(nx, ny)) < 0.5F) return;
      most = std::max(most, image::luminance(light_(nx, ny)));
    });
    if (most >= 0.0F && mine.luminance > most) {
      mine.light *= most / mine.luminance;
      mine.luminance = most;
    }
    return mine;
  }
  /// Of the luminances of like surfaces within two cells.
  Noisy with_variance(const Plane<Noisy>& from, int x, int y) const {
    Noisy mine = from(x, y);
    const Guide& guide = guides_(x, y);
    if (!(guide.depth_m > 0.0F)) return mine;
    float weight = 0.0F, sum = 0.0F, square = 0.0F;
    around(x, y, 1, 2, [&](int nx, int ny, int, int) {
      const float w = alike(guide, guides_(nx, ny));
      const float luminance = from(nx, ny).luminance;
      weight += w, sum += w * luminance, square += w * luminance * luminance;
    });
    const float mean = sum / weight;
    mine.variance = std::max(square / weight - mean * mean, 0.0F);
    return mine;
  }
  Noisy filtered(const Plane<Noisy>& from, int x, int y, int pass) const {
    const Noisy& mine = from(x, y);
    const Guide& guide = guides_(x, y);
    if (pass >= guide.passes || !(mine.variance > 0.0F)) return mine;
    const float tolerance = 1.0F / (kStops * std::sqrt(mine.variance));
    float weight = 0.0F, squares = 0.0F;
    Noisy sum;
    around(x, y, 1 << pass, 2, [&](int nx, int ny, int dx, int dy) {
      const float surface = alike(guide, guides_(nx, ny));
      if (!(surface > 0.0F)) return;
      const Noisy& other = from(nx, ny);
      const float off = tolerance * std::abs(other.luminance - mine.luminance);
      const float w = surface * kSpline[std::abs(dx)] * kSpline[std::abs(dy)] * std::exp(-off);
      weight += w, squares += w * w * other.variance, sum.light += w * other.light;
    });
    sum.light /= weight;
    sum.luminance = image::luminance(sum.light);
    sum.variance = squares / (weight * weight);
    return sum;
  }

  TileScheduler& scheduler_;
  Plane<Rgb>& light_;
  Plane<Guide> guides_;
};

}  // namespace

scheduling::Outcome smooth(const ViewSurfaces& surfaces, const Vec3& eye,
                           const Plane<float>& eccentricity, TileScheduler& scheduler,
                           Plane<Rgb>& light) {
  return Smoother(surfaces, eye, eccentricity, scheduler, light).run();
}

}  // namespace macula::kernels::lightcuts
