// What a program needs inside a cone around a bundle of rays, by depth: the range of t is cut into
// slabs whose length grows with t, and what cannot win in a slab's ball is pruned when the slab is
// first asked for. Where nothing is met over a longer way that way is one slab, and lanes go to its
// end at once. Bundles inside a bundle start from what the outer one kept. Inside server/sdf.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "server/sdf/ball.h"
#include "server/sdf/evaluate.h"
#include "server/sdf/lane_queue.h"
#include "server/sdf/program.h"
#include "server/sdf/tape.h"
#include "server/sdf/union_tree.h"

namespace macula::sdf {

/// Directions within an angle th of a unit axis.
struct Cone {
  Vec3 axis{0.0F, 0.0F, -1.0F};
  float half = 0.0F;  ///< sin(th / 2)

  float sine() const { return 2.0F * half * std::sqrt(std::max(0.0F, 1.0F - half * half)); }
};
/// Around the unit directions, with room for their roundings.
Cone cone_around(std::span<const Vec3> directions);

/// How far beyond its ends a slab's code still holds, relative to t: room to find crossings.
inline constexpr float kSlabMargin = 4e-3F;

struct Slab {
  std::uint32_t key = 0;          ///< the first that it holds; grows with depth
  float low = 0.0F, high = 0.0F;  ///< t in [low, high)
  /// Nothing in its ball is as near as a ray's hit distance: it may be longer than others, and
  /// lanes may go to its end at once.
  bool open = false;
  std::vector<Instruction> code;  ///< empty until the tape is made
  Tape tape;                      ///< empty until tape_of asks for it
  Slab* shared = nullptr;         ///< whose tape serves as long as this one is not pruned, or null
  std::size_t seen = 0;           ///< lanes that came here
  std::size_t operations = 0;     ///< of the tape, a point
  LaneQueue waiting;              ///< lanes to march here
  std::vector<std::uint32_t> hits;  ///< lanes that hit here
};

class Slabs {
 public:
  /// What slabs are cut from; all must live while slabs are asked for.
  struct Source {
    const Program& program;
    const UnionTree* tree = nullptr;       ///< of the program, or null: its branches are few
    float hit_width = 0.0F, hit_m = 0.0F;  ///< a hit is nearer than hit_width t + hit_m
  };
  /// One slab with all of the program. These forget everything.
  void reset_whole(const Program& program);
  void reset(const Source& source, const Cone& cone);
  void reset_within(Slabs& outer, const Cone& cone);

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
  enum class Cut { Whole, Outermost, Within };
  void begin(const Program& program, Slabs* outer, const Cone& cone, Cut cut);
  std::uint32_t key_of(float t) const;
  Slab& make(std::uint32_t key, Registers& registers);
  void cut_outermost(Slab& slab, Registers& registers);
  void cut_within(Slab& slab, Registers& registers);
  bool pays(const Slab& slab) const;
  void prune(Slab& slab, const std::vector<Instruction>& from, Registers& registers);
  /// Around the part of the cone where t is in [low, high), with margins: there its directions
  /// stay.
  Ball ball_of(float low, float high) const;
  /// Whether nothing is so near as a hit at `high` to any place of a ball, ball by ball. At most
  /// kRecordedPoints. `rest` has what is not in the tree, nothing if it is empty.
  using FreeBalls = std::array<bool, kRecordedPoints>;
  FreeBalls are_free(std::span<const Ball> balls, float high, const Tape& rest,
                     Registers& registers) const;

  const Program* program_ = nullptr;
  const UnionTree* tree_ = nullptr;
  UnionTree::Query query_;
  /// Of the program, or of what is not in the tree; empty if that is nothing.
  Tape rest_;
  float hit_width_ = 0.0F, hit_m_ = 0.0F;
  Slabs* outer_ = nullptr;
  Cone cone_;
  Cut cut_ = Cut::Whole;
  std::uint32_t shift_ = 23, first_key_ = 0;
  std::vector<std::int16_t> place_;  ///< by key - first_key_; -1: not made
  std::vector<Slab> slabs_;          ///< kept for their memory; the first count_ are in use
  std::size_t count_ = 0;
  std::uint64_t prunings_ = 0;
};

}  // namespace macula::sdf
