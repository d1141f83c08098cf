#include "server/sdf/surfaces.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "server/sdf/crossing.h"

namespace macula::sdf {
namespace {

using Ids = std::vector<std::uint32_t>;

/// A run with gradients carries a value and three derivatives.
constexpr std::uint64_t kGradientRuns = 4;

std::uint32_t cell_of(float t) {
  return std::bit_cast<std::uint32_t>(t) / kCellSteps;
}
float begin_of(std::uint32_t cell) {
  return std::bit_cast<float>(cell * kCellSteps);
}

/// A ray that grazes, on its way back to where it came within the hit distance: outside at the
/// begin of cell `low`, inside at that of `high`, once both are known.
struct Grazing {
  std::uint32_t id = 0;
  std::uint32_t high = 0, low = 0;
  float f_high = 0.0F, f_low = 0.0F;  ///< distances less the hit distance there
  enum class Phase { Inside, Outside, Between, Done, Lost } phase = Phase::Inside;

  std::uint32_t asks() const {
    if (phase == Phase::Inside) return high;
    return phase == Phase::Outside ? low : low + (high - low) / 2;
  }
};

class SlabSurfaces {
 public:
  SlabSurfaces(const MarchLimits& limits, TraceScratch& scratch, Slab& slab, std::vector<Hit>& hits)
      : limits_(limits),
        s_(scratch),
        slab_(slab),
        tape_(scratch.block_slabs.tape_of(slab, 0, scratch.registers)),
        hits_(hits) {}

  MarchWork run() {
    find_crossings();
    find_touches();
    take_surfaces();
    work_.operations *= slab_.operations;
    return work_;
  }

 private:
  template <class Each>
  void in_batches(std::span<const std::uint32_t> ids, Each each) {
    for (std::size_t first = 0; first < ids.size(); first += kBatch)
      each(ids.subspan(first, std::min(kBatch, ids.size() - first)));
  }
  void measure(const PointBatch& points, std::size_t count, DistanceBatch& found) {
    evaluate(tape_, points, count, s_.registers, found);
    work_.evaluations += count, work_.operations += count;
  }

  // ---- rays that cross ----

  void find_crossings() {
    constexpr int kRounds = 4;
    Ids open = slab_.hits, next;
    for (const std::uint32_t id : open) s_.results[id].stopped = s_.results[id].at;
    for (int round = 0; round < kRounds && !open.empty(); ++round, std::swap(open, next)) {
      next.clear();
      in_batches(open, [&](std::span<const std::uint32_t> ids) { look(ids, next); });
    }
    grazing_.insert(grazing_.end(), open.begin(), open.end());
  }
  void look(std::span<const std::uint32_t> ids, Ids& next) {
    Crossings& rays = s_.crossings;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const LaneResult& result = s_.results[ids[i]];
      rays.x[i] = s_.rays.x[ids[i]], rays.y[i] = s_.rays.y[ids[i]], rays.z[i] = s_.rays.z[ids[i]];
      rays.at[i] = result.at, rays.found[i] = result.found, rays.slope[i] = result.slope;
    }
    choose_cells(rays, ids.size(), s_.points, s_.ends);
    measure(s_.points, ids.size(), s_.distances);
    measure(s_.ends, ids.size(), s_.at_ends);
    cross_cells(rays, ids.size(), s_.distances, s_.at_ends);
    for (std::size_t i = 0; i < ids.size(); ++i) take(i, ids[i], next);
  }
  void take(std::size_t i, std::uint32_t id, Ids& next) {
    const Crossings& rays = s_.crossings;
    LaneResult& result = s_.results[id];
    const bool near = std::abs(rays.at[i] - result.stopped) <= kCrossingReach * result.stopped;
    if (!near) return grazing_.push_back(id);
    result.at = rays.at[i], result.found = rays.found[i], result.slope = rays.slope[i];
    if (static_cast<CrossingState>(rays.state[i]) == CrossingState::Open) next.push_back(id);
  }

  // ---- rays that only touch ----

  /// Back by one cell, two, four, until the ray is outside the hit distance; then between.
  void find_touches() {
    std::vector<Grazing> rays;
    for (const std::uint32_t id : grazing_) {
      LaneResult& result = s_.results[id];
      result.at = result.stopped;
      rays.push_back({id, cell_of(result.at), 0, 0.0F, 0.0F, Grazing::Phase::Inside});
    }
    while (!rays.empty()) {
      for (std::size_t first = 0; first < rays.size(); first += kBatch)
        step(std::span(rays).subspan(first, std::min(kBatch, rays.size() - first)));
      std::erase_if(rays, [](const Grazing& ray) { return ray.phase >= Grazing::Phase::Done; });
    }
  }
  void step(std::span<Grazing> rays) {
    for (std::size_t i = 0; i < rays.size(); ++i)
      s_.points.set(i, begin_of(rays[i].asks()) * s_.rays[rays[i].id]);
    measure(s_.points, rays.size(), s_.distances);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Grazing& ray = rays[i];
      const float t = begin_of(ray.asks());
      move(ray, s_.distances.at[i] - (s_.widths[ray.id] * t + limits_.hit_m));
    }
  }
  void move(Grazing& ray, float f) {
    const float stopped = s_.results[ray.id].stopped;
    switch (ray.phase) {
      case Grazing::Phase::Inside:
        ray.f_high = f;
        ray.low = ray.high - 1;
        ray.phase = f < 0.0F && ray.high > 1 ? Grazing::Phase::Outside : Grazing::Phase::Lost;
        return;
      case Grazing::Phase::Outside:
        if (f < 0.0F) {
          const std::uint32_t stride = 2 * (ray.high - ray.low);
          ray.f_high = f;
          ray.high = ray.low;
          ray.low = ray.high > stride ? ray.high - stride : 0;
          if (begin_of(ray.low) < (1.0F - kCrossingReach) * stopped)
            ray.phase = Grazing::Phase::Lost;
          return;
        }
        ray.f_low = f;
        ray.phase = f >= 0.0F ? Grazing::Phase::Between : Grazing::Phase::Lost;
        break;
      default:
        (f < 0.0F ? ray.high : ray.low) = ray.asks();
        (f < 0.0F ? ray.f_high : ray.f_low) = f;
    }
    if (ray.phase == Grazing::Phase::Between && ray.high - ray.low == 1) finish(ray);
  }
  void finish(Grazing& ray) {
    const float low = begin_of(ray.low), high = begin_of(ray.high);
    s_.results[ray.id].at = low + (high - low) * (ray.f_low / (ray.f_low - ray.f_high));
    ray.phase = Grazing::Phase::Done;
  }

  // ---- what is there ----

  /// Where the gradient is asked for: the hit distance in front of the surface. On it the way to
  /// the nearest of its points is shorter than roundings, and so would its direction be made of
  /// them.
  float before(std::uint32_t id) const {
    constexpr float kMost = 0.1F * kCrossingReach;
    const float at = s_.results[id].at;
    return at - std::min(s_.widths[id] * at + limits_.hit_m, kMost * at);
  }
  void take_surfaces() {
    in_batches(slab_.hits, [&](std::span<const std::uint32_t> ids) {
      for (std::size_t i = 0; i < ids.size(); ++i)
        s_.points.set(i, before(ids[i]) * s_.rays[ids[i]]);
      evaluate_surface(tape_, s_.points, ids.size(), s_.registers, s_.surfaces);
      work_.evaluations += ids.size(), work_.operations += kGradientRuns * ids.size();
      make_normals(s_.surfaces, ids.size());
      for (std::size_t i = 0; i < ids.size(); ++i) {
        Hit& hit = hits_[ids[i]];
        const Vec3 normal{s_.surfaces.x[i], s_.surfaces.y[i], s_.surfaces.z[i]};
        hit.t = s_.results[ids[i]].at;
        // A ridge or the middle of a shell may have no gradient: such a point faces the eye.
        hit.normal = normal == Vec3{0.0F} ? -hit.direction : normal;
        hit.material = s_.surfaces.material[i];
      }
    });
  }

  const MarchLimits& limits_;
  TraceScratch& s_;
  Slab& slab_;
  const Tape& tape_;
  std::vector<Hit>& hits_;
  Ids grazing_;
  MarchWork work_;
};

}  // namespace

MarchWork find_surfaces(const MarchLimits& limits, TraceScratch& scratch, std::vector<Hit>& hits) {
  MarchWork work;
  scratch.block_slabs.each_with_hits([&](Slab& slab) {
    const MarchWork own = SlabSurfaces(limits, scratch, slab, hits).run();
    work.evaluations += own.evaluations;
    work.operations += own.operations;
    slab.hits.clear();
  });
  return work;
}

}  // namespace macula::sdf
