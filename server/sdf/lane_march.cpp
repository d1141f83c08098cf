#include "server/sdf/lane_march.h"

#include <algorithm>
#include <cmath>

namespace macula::sdf {
namespace {

/// How far a hit may be moved onto the surface, in hit distances: enough for rays that meet it at
/// 4 degrees or more.
constexpr float kNewtonReach = 16.0F;

class SlabMarch {
 public:
  SlabMarch(Stepping stepping, MarchLimits limits, TraceScratch& scratch, Slab& slab)
      : stepping_(stepping), limits_(limits), s_(scratch), slab_(slab) {
    limits_.slab_low = slab.low, limits_.slab_high = slab.high;
  }

  std::uint64_t run() {
    const Tape& tape = s_.block_slabs.tape_of(slab_);
    // Lanes that step back may come to wait here again while the slab is worked on.
    std::uint64_t evaluations = 0;
    while (fill()) {
      positions(s_.chunk, count_, s_.points);
      std::size_t live = count_;
      do {
        evaluate(tape, s_.points, count_, s_.registers, s_.distances);
        evaluations += live;
        live = advance(stepping_, s_.chunk, count_, s_.distances, limits_, s_.points);
      } while (4 * live > 3 * count_);
      retire();
    }
    return evaluations;
  }

 private:
  bool fill() {
    while (count_ < kBatch && !slab_.waiting.empty()) {
      const std::uint32_t id = slab_.waiting.back();
      slab_.waiting.pop_back();
      s_.chunk.load(count_++, s_.lanes[id], id);
    }
    return count_ > 0;
  }
  void retire() {
    for (std::size_t i = 0; i < count_;) {
      if (s_.chunk.state[i] == static_cast<std::int32_t>(LaneState::Live)) {
        ++i;
        continue;
      }
      leave(i);
      --count_;
      if (i < count_) s_.chunk.move(count_, i);
    }
  }
  void leave(std::size_t i) {
    const std::uint32_t id = s_.chunk.id[i];
    Lane& lane = s_.lanes[id];
    s_.chunk.save(i, lane);
    if (lane.state == LaneState::Hit) slab_.hits.push_back(id);
    if (lane.state == LaneState::Left)
      s_.block_slabs.of(lane.at, s_.registers).waiting.push_back(id);
  }

  Stepping stepping_;
  MarchLimits limits_;
  TraceScratch& s_;
  Slab& slab_;
  std::size_t count_ = 0;
};

class SurfaceFinder {
 public:
  SurfaceFinder(float hit_m, TraceScratch& scratch, std::vector<Hit>& hits)
      : hit_m_(hit_m), s_(scratch), hits_(hits) {}

  void run(Slab& slab) {
    const Tape& tape = s_.block_slabs.tape_of(slab);
    for (std::size_t first = 0; first < slab.hits.size(); first += kBatch) {
      const std::size_t count = std::min(kBatch, slab.hits.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        const Lane& lane = s_.lanes[slab.hits[first + i]];
        s_.points.set(i, lane.at * Vec3(lane.x, lane.y, lane.z));
      }
      evaluate_surface(tape, s_.points, count, s_.registers, s_.surfaces);
      for (std::size_t i = 0; i < count; ++i) take(i, slab.hits[first + i]);
    }
  }

 private:
  void take(std::size_t i, std::uint32_t id) {
    const Lane& lane = s_.lanes[id];
    Hit& hit = hits_[id];
    const Vec3 gradient{s_.surfaces.x[i], s_.surfaces.y[i], s_.surfaces.z[i]};
    const float length = glm::length(gradient);
    // A ridge or the middle of a shell may have no gradient: such a point faces the eye.
    const bool usable = length > 1e-6F && std::isfinite(length);
    hit.normal = usable ? gradient / length : -hit.direction;
    hit.material = s_.surfaces.material[i];
    const float falls = -glm::dot(gradient, hit.direction);
    const float reach = kNewtonReach * (lane.width * lane.at + hit_m_);
    const float rest = s_.surfaces.distance[i] / std::max(falls, 1e-3F);
    if (std::isfinite(rest)) hit.t = std::max(0.0F, lane.at + std::clamp(rest, -reach, reach));
  }

  float hit_m_;
  TraceScratch& s_;
  std::vector<Hit>& hits_;
};

}  // namespace

void march(Stepping stepping, MarchLimits limits, TraceScratch& scratch, std::uint64_t& evaluations,
           std::uint64_t& operations) {
  for (std::uint32_t id = 0; id < scratch.lanes.size(); ++id) {
    const Lane& lane = scratch.lanes[id];
    if (lane.state == LaneState::Live)
      scratch.block_slabs.of(lane.at, scratch.registers).waiting.push_back(id);
  }
  while (Slab* slab = scratch.block_slabs.nearest_waiting()) {
    const std::uint64_t done = SlabMarch(stepping, limits, scratch, *slab).run();
    evaluations += done;
    operations += done * slab->operations;
  }
}

void find_surfaces(float hit_m, TraceScratch& scratch, std::vector<Hit>& hits,
                   TraceCounts& counts) {
  SurfaceFinder finder(hit_m, scratch, hits);
  scratch.block_slabs.each_with_hits([&](Slab& slab) {
    finder.run(slab);
    counts.surface_evaluations += slab.hits.size();
    slab.hits.clear();
  });
}

}  // namespace macula::sdf
