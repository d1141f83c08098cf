#include "server/sdf/lane_march.h"

namespace macula::sdf {
namespace {

class SlabMarch {
 public:
  SlabMarch(Stepping stepping, MarchLimits limits, TraceScratch& scratch, Slab& slab)
      : stepping_(stepping), limits_(limits), s_(scratch), slab_(slab) {
    limits_.slab_low = slab.low, limits_.slab_high = slab.high;
  }

  // A page is marched until half its lanes have ended; the rest joins other lanes in a new page.
  std::uint64_t run() {
    if (slab_.open && limits_.free_way == FreeWay::Leap) return leap();
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
  /// Nothing is in the way here: lanes go to the slab's end without an evaluation. One that a
  /// stretched step brought here is not known to be free before it: it goes back to where it is.
  std::uint64_t leap() {
    while (!slab_.waiting.empty()) {
      const Page page = slab_.waiting.take();
      Chunk& lanes = *page.lanes;
      for (std::size_t i = 0; i < page.count; ++i) {
        const float free = lanes.t[i] + lanes.radius[i];
        const bool knows = stepping_ == Stepping::Cone || free >= slab_.low;
        const float to = knows ? slab_.high : free;
        const LaneState state = to < limits_.far_m ? LaneState::Left : LaneState::Miss;
        lanes.at[i] = lanes.t[i] = lanes.first[i] = to;
        lanes.radius[i] = 0.0F, lanes.slope[i] = -1.0F;
        lanes.state[i] = static_cast<std::int32_t>(state);
        leave(lanes, i);
      }
      s_.pool.give(page.lanes);
    }
    return 0;
  }
  void leave(const Chunk& lanes, std::size_t i) {
    const auto state = static_cast<LaneState>(lanes.state[i]);
    if (state == LaneState::Live) return slab_.waiting.push(lanes, i, s_.pool);
    if (state == LaneState::Left)
      return s_.block_slabs.of(lanes.at[i], s_.registers).waiting.push(lanes, i, s_.pool);
    const std::uint32_t id = lanes.id[i];
    s_.results[id] = {lanes.at[i], lanes.radius[i], static_cast<std::uint16_t>(lanes.steps[i]),
                      state};
    if (state == LaneState::Hit) slab_.hits.push_back(id);
  }

  Stepping stepping_;
  MarchLimits limits_;
  TraceScratch& s_;
  Slab& slab_;
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
