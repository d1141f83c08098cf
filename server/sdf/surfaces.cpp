#include "server/sdf/surfaces.h"

#include <algorithm>
#include <span>

#include "server/sdf/crossing.h"

namespace macula::sdf {
namespace {

/// A run with gradients carries a value and three derivatives.
constexpr std::uint64_t kGradientRuns = 4;

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

  // ---- crossings ----

  /// As many rays as a batch holds at a time; the next come in where others are done.
  void find_crossings() {
    std::size_t next = 0;
    do {
      while (open_ < kBatch && next < slab_.hits.size()) begin(slab_.hits[next++]);
      aim_crossings(s_.crossings, open_, limits_.hit_m, s_.points);
      measure(s_.points, open_, s_.distances);
      take_crossings(s_.crossings, open_, s_.distances);
      keep_open();
    } while (open_ > 0 || next < slab_.hits.size());
  }
  void begin(std::uint32_t id) {
    Crossings& rays = s_.crossings;
    const std::size_t i = open_++;
    rays.x[i] = s_.rays.x[id], rays.y[i] = s_.rays.y[id], rays.z[i] = s_.rays.z[id];
    rays.mark[i] = s_.results[id].at, rays.width[i] = s_.widths[id];
    rays.f_low[i] = s_.results[id].found;
    rays.phase[i] = static_cast<std::int32_t>(CrossingPhase::New);
    rays.id[i] = id;
  }
  void keep_open() {
    Crossings& rays = s_.crossings;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < open_; ++i) {
      if (static_cast<CrossingPhase>(rays.phase[i]) >= CrossingPhase::Found) {
        s_.results[rays.id[i]].at = rays.at[i];
      } else {
        move_ray(rays, i, kept++);
      }
    }
    open_ = kept;
  }
  static void move_ray(Crossings& rays, std::size_t from, std::size_t to) {
    if (from == to) return;
    for (float* of : {rays.x, rays.y, rays.z, rays.mark, rays.width, rays.at, rays.low, rays.high,
                      rays.f_low, rays.f_high, rays.step, rays.least})
      of[to] = of[from];
    rays.phase[to] = rays.phase[from], rays.id[to] = rays.id[from];
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
  std::size_t open_ = 0;  ///< rays of scratch.crossings that look for their crossing
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
