#include "tests/bench/ray_raw.h"

#include <limits>
#include <vector>

#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"
#include "shared/base/cpu_time.h"

namespace macula::bench {
namespace {

constexpr int kSide = 16;
static_assert(kSide * kSide == visibility::kStreamCapacity);
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RawWork {
  std::uint64_t rays = 0;
  double cpu_ms = 0.0;
};

/// One tile's queries. Making rays is not timed.
class RawTile {
 public:
  RawTile(const RaySetting& setting, const kernels::View& view, const image::Rect& tile)
      : setting_(setting), view_(view), tile_(tile) {}

  RawWork run() {
    make_primary();
    timed([&] {
      setting_.scene->triangles().intersect(rays_, hits_, visibility::Coherence::Coherent);
    });
    const int shadows = setting_.lighting == PaperLighting::Point   ? 1
                        : setting_.lighting == PaperLighting::Area8 ? 8
                                                                    : 16;
    const auto coherence = setting_.lighting == PaperLighting::Ao16
                               ? visibility::Coherence::Incoherent
                               : visibility::Coherence::Coherent;
    for (int k = 0; k < shadows; ++k) {
      make_shadow(k);
      timed([&] { setting_.scene->triangles().occluded(shadow_, hidden_, coherence); });
    }
    return work_;
  }

 private:
  template <class Query>
  void timed(Query&& query) {
    const double begin = base::thread_cpu_ms();
    query();
    work_.cpu_ms += base::thread_cpu_ms() - begin;
  }

  void make_primary() {
    const Mat3 rotation(glm::mat3_cast(view_.world_from_view.rotation));
    const Vec3 eye(view_.world_from_view.position);
    rays_.clear();
    for (int by = 0; by < tile_.height; by += 4) {
      for (int bx = 0; bx < tile_.width; bx += 4) {
        for (int y = by; y < std::min(by + 4, tile_.height); ++y) {
          for (int x = bx; x < std::min(bx + 4, tile_.width); ++x) {
            const Vec3 ray = rotation * view_.grid.ray(tile_.x + x, tile_.y + y);
            rays_.push(eye, ray, 0.0F, kInfinity);
          }
        }
      }
    }
    work_.rays += rays_.count;
  }

  void make_shadow(int k) {
    const auto reach = static_cast<float>(setting_.scene->scene().settings.ambient_distance_m);
    shadow_.clear();
    for (int i = 0; i < rays_.count; ++i) {
      if (!hits_.hit(i)) {
        shadow_.push(Vec3{0.0F}, Vec3{0.0F, 1.0F, 0.0F}, 0.0F, -1.0F);
        continue;
      }
      Vec3 normal = hits_.normal(i);
      if (glm::dot(normal, rays_.direction(i)) > 0.0F) normal = -normal;
      const Vec3 point = rays_.origin(i) + hits_.t[i] * rays_.direction(i);
      const Vec3 origin = visibility::offset_ray_origin(
          point, normal, hits_.t[i] * glm::length(rays_.direction(i)));
      const Vec2 u = sampling::sample_2d(
          {1, static_cast<std::uint64_t>(k), view_.grid.cell_key(tile_.x, tile_.y) + i}, 0);
      push_shadow(origin, normal, u, reach);
      ++work_.rays;
    }
  }
  void push_shadow(const Vec3& origin, const Vec3& normal, const Vec2& u, float reach) {
    if (setting_.lighting == PaperLighting::Ao16) {
      const Vec3 direction = sampling::frame_from_normal(normal) * sampling::cosine_hemisphere(u);
      shadow_.push(origin, direction, 0.0F, reach);
      return;
    }
    const bool area = setting_.lighting == PaperLighting::Area8;
    const Vec3 aside = area ? Vec3{u.x - 0.5F, 0.0F, u.y - 0.5F} : Vec3{0.0F};
    shadow_.push(origin, 0.999F * (setting_.light + aside - origin), 0.0F, 1.0F);
  }

  const RaySetting& setting_;
  const kernels::View& view_;
  image::Rect tile_;
  visibility::RayStream rays_, shadow_;
  visibility::HitStream hits_;
  visibility::OcclusionStream hidden_;
  RawWork work_;
};

}  // namespace

double raw_mrays_per_s(const RaySetting& setting, const kernels::View& view,
                       scheduling::TileScheduler& scheduler) {
  const int columns = (view.grid.width() + kSide - 1) / kSide;
  const int rows = (view.grid.height() + kSide - 1) / kSide;
  std::vector<RawWork> parts(static_cast<std::size_t>(columns) * rows);
  scheduler.run(parts.size(), [&](std::size_t i) {
    const int x = static_cast<int>(i) % columns * kSide, y = static_cast<int>(i) / columns * kSide;
    const image::Rect tile{x, y, std::min(kSide, view.grid.width() - x),
                           std::min(kSide, view.grid.height() - y)};
    parts[i] = RawTile(setting, view, tile).run();
  });
  RawWork sum;
  for (const RawWork& part : parts) sum.rays += part.rays, sum.cpu_ms += part.cpu_ms;
  return sum.cpu_ms > 0.0 ? static_cast<double>(sum.rays) / (1e3 * sum.cpu_ms) : 0.0;
}

}  // namespace macula::bench
