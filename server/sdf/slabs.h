// What a program needs inside a cone around a bundle of rays, by depth: the range of t is cut into
// slabs whose length grows with t, and what cannot win in a slab's ball is pruned when the slab is
// first asked for. Where nothing is met over a longer way that way is one slab: lanes cross it in
// few steps, and together. Bundles inside a bundle start from what the outer one kept. Inside
// server/sdf.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "server/sdf/evaluate.h"
#include "server/sdf/lane_queue.h"
#include "server/sdf/program.h"
#include "server/sdf/tape.h"

namespace macula::sdf {

/// Directions within an angle th of a unit axis.
struct Cone {
  Vec3 axis{0.0F, 0.0F, -1.0F};
  float half = 0.0F;  ///< sin(th / 2)

  float sine() const { return 2.0F * half * std::sqrt(std::max(0.0F, 1.0F - half * half)); }
};
/// Around the unit directions, with room for their roundings.
Cone cone_around(std::span<const Vec3> directions);

/// In which the cone's directions stay over some range of t.
struct Ball {
  Vec3 centre{0.0F};
  float radius = 0.0F;
};

/// How far beyond its ends a slab's code still holds, relative to t: room to find crossings.
inline constexpr float kSlabMargin = 4e-3F;

struct Slab {
  std::uint32_t key = 0;          ///< the first that it holds; grows with depth
  float low = 0.0F, high = 0.0F;  ///< t in [low, high)
  bool open = false;              ///< its ball is free: it may be longer than others
  std::vector<Instruction> code;
  Tape tape;               ///< empty until tape_of asks for it
  Slab* shared = nullptr;  ///< whose code and tape serve as long as this one is not pruned, or null
  std::size_t seen = 0;    ///< lanes that came here
  std::size_t operations = 0;       ///< of the tape, a point
  LaneQueue waiting;                ///< lanes to march here
  std::vector<std::uint32_t> hits;  ///< lanes that hit here
};

class Slabs {
 public:
  enum class Pruning { None, ByDepth };

  /// Forgets everything. `outer` (or null) and `program` must live while slabs are asked for.
  void reset(const Program& program, Slabs* outer, const Cone& cone, Pruning pruning);

  /// The slab that holds t >= 0.
  Slab& of(float t, Registers& registers);
  /// Of a slab of these, for so many more lanes: pruning waits until enough have come to pay for
  /// it.
  const Tape& tape_of(Slab& slab, std::size_t lanes, Registers& registers);
  /// The nearest slab with waiting lanes; null when there are none.
  Slab* nearest_waiting();
  template <class Each>
  void each_with_hits(Each each) {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!slabs_[i].hits.empty()) each(slabs_[i]);
    }
  }
  std::uint64_t prunings() const { return prunings_; }

 private:
  std::uint32_t key_of(float t) const;
  Slab& make(std::uint32_t key, Registers& registers);
  void cut_outermost(Slab& slab, Registers& registers);
  void cut_within(Slab& slab, Registers& registers);
  void prune(Slab& slab, const std::vector<Instruction>& from, Registers& registers);
  /// Around the part of the cone where t is in [low, high), with margins.
  Ball ball_of(float low, float high) const;

  const Program* program_ = nullptr;
  Slabs* outer_ = nullptr;
  Cone cone_;
  Pruning pruning_ = Pruning::None;
  std::uint32_t shift_ = 23, first_key_ = 0;
  std::vector<std::int16_t> place_;  ///< by key - first_key_; -1: not made
  std::vector<Slab> slabs_;          ///< kept for their memory; the first count_ are in use
  std::size_t count_ = 0;
  std::uint64_t prunings_ = 0;
};

}  // namespace macula::sdf
