#include "server/disocclusion/hidden_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "server/disocclusion/hidden_sights.h"
#include "server/sampling/sample.h"

namespace macula::disocclusion {
namespace {

using image::Pixel;
using kernels::SurfacePoint;
using scheduling::Outcome;
using visibility::kStreamCapacity;

/// The band's cells, row by row.
std::vector<Pixel> cells_of(const Band& band) {
  std::vector<Pixel> cells;
  for (int y = 0; y < band.height(); ++y) {
    const auto row = band.row(y);
    for (int x = 0; x < band.width(); ++x) {
      if (row[x] != 0) cells.push_back({x, y});
    }
  }
  return cells;
}

/// Finds and describes what the band hides; parts of kStreamCapacity cells, any thread each.
class Tracer {
 public:
  Tracer(const HiddenRequest& request, const kernels::SceneFrame& scene,
         std::span<const Pixel> cells, HiddenLayer& out)
      : request_(request),
        scene_(scene),
        cells_(cells),
        out_(out),
        world_from_view_(glm::mat3_cast(request.view.world_from_view.rotation)),
        points_(cells.size()),
        is_hit_(cells.size()) {
    if (scene.scene().field) {
      field_.emplace(*scene.scene().field, units::to_s(scene.time().since_start));
    }
  }

  std::size_t parts() const { return (cells_.size() + kStreamCapacity - 1) / kStreamCapacity; }

  void trace(std::size_t part) {
    const std::size_t first = part * kStreamCapacity;
    const std::size_t count = std::min<std::size_t>(kStreamCapacity, cells_.size() - first);
    HiddenSights sights;
    sights.rays.clear();
    for (std::size_t i = 0; i < count; ++i) aim(cells_[first + i], sights.rays);
    if (field_) {
      field_->find(sights);
    } else {
      walk_surfaces(scene_.triangles(), sights);
    }
    for (std::size_t i = 0; i < count; ++i) note(first + i, sights, static_cast<int>(i));
  }

  /// Shades what was met; the rest is what lies beyond everything.
  Outcome shade(const kernels::Kernel& kernel, scheduling::TileScheduler& scheduler) {
    std::vector<SurfacePoint> met;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_hit_[i] == 0) continue;
      met.push_back(points_[i]);
      owners.push_back(i);
    }
    std::vector<Rgb> radiance(met.size());
    kernel.shade(met, scene_, scheduler, radiance);
    for (std::size_t i = 0; i < met.size(); ++i) {
      const Pixel& cell = cells_[owners[i]];
      out_.radiance(cell.x, cell.y) = radiance[i];
    }
    return scheduler.run(1, [](std::size_t) {});  // a stop on the way leaves points dark
  }

 private:
  void aim(const Pixel& cell, visibility::RayStream& rays) const {
    const float depth_m = request_.depth_m(cell.x, cell.y);
    const float limit =
        far_limit(request_.view.grid, cell.x, cell.y, 1.0F / depth_m, request_.view_cell_m);
    constexpr float kFar = std::numeric_limits<float>::infinity();
    const Vec3 direction = world_from_view_ * request_.view.grid.ray(cell.x, cell.y);
    const Vec3 origin(request_.view.world_from_view.position);
    rays.push(origin, direction, limit > 0.0F ? 1.0F / limit : std::numeric_limits<float>::max(),
              kFar);
  }

  void note(std::size_t index, const HiddenSights& sights, int i) {
    const Pixel& cell = cells_[index];
    const Vec3 direction = sights.rays.direction(i);
    is_hit_[index] = sights.hits.hit(i) ? 1 : 0;
    if (!sights.hits.hit(i)) {
      out_.depth_m(cell.x, cell.y) = std::numeric_limits<float>::infinity();
      out_.radiance(cell.x, cell.y) = scene_.beyond(glm::normalize(direction));
      return;
    }
    const visibility::Hit hit = sights.hits.at(i);
    out_.depth_m(cell.x, cell.y) = hit.t;
    const DVec3 place = request_.view.world_from_view.position + DVec3(hit.t * direction);
    SurfacePoint& point = points_[index];
    point.position = scene_.surface(hit, place).position;
    point.to_eye = -glm::normalize(direction);
    point.geometric_normal = glm::dot(hit.normal, point.to_eye) < 0.0F ? -hit.normal : hit.normal;
    point.instance = hit.instance, point.triangle = hit.triangle;
    point.barycentric = {hit.u, hit.v};
    point.footprint_m = hit.t * side(cell, direction);
    point.key = sampling::SampleKey(request_.seed, request_.frame,
                                    request_.view.grid.cell_key(cell.x, cell.y))
                    .value;
  }

  /// Of the square that a cell stands for across its ray, at view depth 1: a tangent area A covers
  /// the solid angle A cos^3 and, at distance 1 / cos, the area A cos.
  float side(const Pixel& cell, const Vec3& direction) const {
    const Vec2 footprint = request_.view.grid.footprint(cell.x, cell.y);
    return std::sqrt(footprint.x * footprint.y / glm::length(direction));
  }

  const HiddenRequest& request_;
  const kernels::SceneFrame& scene_;
  const std::span<const Pixel> cells_;
  HiddenLayer& out_;
  const Mat3 world_from_view_;
  std::optional<FieldWalk> field_;
  std::vector<SurfacePoint> points_;
  std::vector<std::uint8_t> is_hit_;
};

}  // namespace

Outcome trace_hidden_layer(const HiddenRequest& request, const kernels::Kernel& kernel,
                           const kernels::SceneFrame& scene, scheduling::TileScheduler& scheduler,
                           HiddenLayer& out) {
  find_band(request.depth_m, request.view.grid, request.view_cell_m, scheduler, out.band);
  const std::vector<Pixel> cells = cells_of(out.band);
  out.cells = cells.size();
  out.radiance.resize(out.band.width(), out.band.height());
  out.depth_m.resize(out.band.width(), out.band.height());
  Tracer tracer(request, scene, cells, out);
  const Outcome traced =
      scheduler.run(tracer.parts(), [&](std::size_t part) { tracer.trace(part); });
  if (traced == Outcome::Stopped) return traced;
  return tracer.shade(kernel, scheduler);
}

}  // namespace macula::disocclusion
