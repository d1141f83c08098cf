#include "server/sdf/lane_march.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace macula::sdf {
namespace {

/// Rays along which the distance falls less than this (met at one degree or less) stay where they
/// are: there a Newton step would be long and its direction chance.
constexpr float kNewtonSlope = 1.0F / 64.0F;
/// A run with gradients carries a value and three derivatives.
constexpr std::size_t kGradientRuns = 4;
/// What a Newton step must leave of the distance at most.
constexpr float kNewtonGain = 0.5F;

class SlabMarch {
 public:
  SlabMarch(Stepping stepping, MarchLimits limits, TraceScratch& scratch, Slab& slab)
      : stepping_(stepping), limits_(limits), s_(scratch), slab_(slab) {
    limits_.slab_low = slab.low, limits_.slab_high = slab.high;
  }

  // A page is marched until half its lanes have ended; the rest joins other lanes in a new page.
  std::uint64_t run() {
    const Tape& tape = s_.block_slabs.tape_of(slab_, slab_.waiting.size(), s_.registers);
    std::uint64_t evaluations = 0;
    while (!slab_.waiting.empty()) {
      const Page page = slab_.waiting.take();
      positions(*page.lanes, page.count, s_.points);
      std::size_t live = page.count;
      do {
        evaluate(tape, s_.points, page.count, s_.registers, s_.distances);
        evaluations += live;
        live = advance(stepping_, *page.lanes, page.count, s_.distances, limits_, s_.points);
      } while (2 * live > page.count);
      for (std::size_t i = 0; i < page.count; ++i) leave(*page.lanes, i);
      s_.pool.give(page.lanes);
    }
    return evaluations;
  }

 private:
  void leave(const Chunk& lanes, std::size_t i) {
    const auto state = static_cast<LaneState>(lanes.state[i]);
    if (state == LaneState::Live) return slab_.waiting.push(lanes, i, s_.pool);
    if (state == LaneState::Left)
      return s_.block_slabs.of(lanes.at[i], s_.registers).waiting.push(lanes, i, s_.pool);
    const std::uint32_t id = lanes.id[i];
    s_.results[id] = {lanes.at[i], static_cast<std::uint16_t>(lanes.steps[i]), state};
    if (state == LaneState::Hit) slab_.hits.push_back(id);
  }

  Stepping stepping_;
  MarchLimits limits_;
  TraceScratch& s_;
  Slab& slab_;
};

class SurfaceFinder {
 public:
  SurfaceFinder(TraceScratch& scratch, std::vector<Hit>& hits) : s_(scratch), hits_(hits) {}

  void run(Slab& slab) {
    const Tape& tape = s_.block_slabs.tape_of(slab, 0, s_.registers);
    for (std::size_t first = 0; first < slab.hits.size(); first += kBatch) {
      const std::span<const std::uint32_t> ids(slab.hits.data() + first,
                                               std::min(kBatch, slab.hits.size() - first));
      for (std::size_t i = 0; i < ids.size(); ++i)
        s_.points.set(i, s_.results[ids[i]].at * s_.rays[ids[i]]);
      evaluate_surface(tape, s_.points, ids.size(), s_.registers, s_.surfaces);
      for (std::size_t i = 0; i < ids.size(); ++i) take(i, ids[i]);
      evaluate(tape, s_.points, ids.size(), s_.registers, s_.distances);
      for (std::size_t i = 0; i < ids.size(); ++i) settle(i, ids[i]);
    }
  }

 private:
  /// Normal and material; the point a Newton step ahead into s_.points.
  void take(std::size_t i, std::uint32_t id) {
    const float at = s_.results[id].at;
    Hit& hit = hits_[id];
    const Vec3 gradient{s_.surfaces.x[i], s_.surfaces.y[i], s_.surfaces.z[i]};
    const float length = glm::length(gradient);
    // A ridge or the middle of a shell may have no gradient: such a point faces the eye.
    const bool usable = length > 1e-6F && std::isfinite(length);
    hit.normal = usable ? gradient / length : -hit.direction;
    hit.material = s_.surfaces.material[i];
    const float falls = -glm::dot(gradient, hit.direction);
    const float ahead = at + s_.surfaces.distance[i] / falls;
    // Within the slab's margin wherever in the slab the hit is.
    const bool holds = std::abs(ahead - at) <= 0.9F * kSlabMargin * at;
    const bool moves = usable && falls > kNewtonSlope && holds;
    hit.t = moves ? ahead : at;
    s_.points.set(i, hit.t * hit.direction);
  }
  /// Near an edge the gradient may be that of a face the ray does not meet: the step counts only
  /// where it led closer.
  void settle(std::size_t i, std::uint32_t id) {
    const float before = std::abs(s_.surfaces.distance[i]), after = std::abs(s_.distances.at[i]);
    if (!(after <= kNewtonGain * before)) hits_[id].t = s_.results[id].at;
  }

  TraceScratch& s_;
  std::vector<Hit>& hits_;
};

}  // namespace

MarchWork march(Stepping stepping, MarchLimits limits, TraceScratch& scratch) {
  MarchWork work;
  while (Slab* slab = scratch.block_slabs.nearest_waiting()) {
    const std::uint64_t done = SlabMarch(stepping, limits, scratch, *slab).run();
    work.evaluations += done;
    work.operations += done * slab->operations;
  }
  return work;
}

MarchWork find_surfaces(TraceScratch& scratch, std::vector<Hit>& hits) {
  MarchWork work;
  SurfaceFinder finder(scratch, hits);
  scratch.block_slabs.each_with_hits([&](Slab& slab) {
    finder.run(slab);
    work.evaluations += 2 * slab.hits.size();
    work.operations += (kGradientRuns + 1) * slab.hits.size() * slab.operations;
    slab.hits.clear();
  });
  return work;
}

void Directions::resize(std::size_t count) {
  const std::size_t padded = (count + 15) / 16 * 16;
  tangent_x = block_.at_least(5 * padded);
  tangent_y = tangent_x + padded;
  x = tangent_y + padded, y = x + padded, z = y + padded;
}

void Directions::point_along(std::size_t count, const Mat3& scene_from_view) {
  directions(tangent_x, tangent_y, count, scene_from_view, {x, y, z});
}

}  // namespace macula::sdf
