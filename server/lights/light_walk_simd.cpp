// A block of sixteen nodes, weighed from one receiver. tests/server/lights/tree_oracle.h has the
// same in double, one node at a time.
#include "server/lights/light_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sampling/frame.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/light_walk_simd.cpp"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, NodeBlock::kNodes>;
using FloatVec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
constexpr std::size_t kNodes = NodeBlock::kNodes;

/// A linear form over boxes: its value at their centres, and how far it varies to either side.
struct Form {
  Vec3 axis, extent;

  explicit Form(const Vec3& v) : axis(v), extent(glm::abs(v)) {}
};
/// Everything about the receiver that no node changes.
struct Eye {
  Vec3 position;
  Form normal, tangent, bitangent;

  explicit Eye(const Receiver& receiver)
      : Eye(receiver, sampling::frame_from_normal(receiver.normal)) {}
  Eye(const Receiver& receiver, const Mat3& frame)
      : position(receiver.position), normal(frame[2]), tangent(frame[0]), bitangent(frame[1]) {}
};

struct Box {
  FloatVec cx, cy, cz;  ///< centre as seen from the receiver
  FloatVec hx, hy, hz;
};
struct Range {
  FloatVec centre, reach;
};
HWY_INLINE HWY_ATTR FloatVec dot(const Vec3& a, FloatVec x, FloatVec y, FloatVec z) {
  const Floats d;
  return hn::MulAdd(hn::Set(d, a.x), x,
                    hn::MulAdd(hn::Set(d, a.y), y, hn::Mul(hn::Set(d, a.z), z)));
}
HWY_INLINE HWY_ATTR Range range_of(const Form& form, const Box& box) {
  return {dot(form.axis, box.cx, box.cy, box.cz), dot(form.extent, box.hx, box.hy, box.hz)};
}
HWY_INLINE HWY_ATTR FloatVec least_magnitude(const Range& range) {
  return hn::Max(hn::Sub(hn::Abs(range.centre), range.reach), hn::Zero(Floats()));
}

/// Numerator and denominator of a quotient to come: divisions are what a visit waits for.
struct Ratio {
  FloatVec over, under;
};

/// Largest cosine at the receiver towards any point of the box. It rises with the height over the
/// receiver's plane and falls with the distances along it, so it is no larger than at the highest
/// height and the least distances, wherever in the box each of them lies.
HWY_INLINE HWY_ATTR Ratio cosine_bound(const Eye& eye, const Box& box) {
  const Floats d;
  const Range height = range_of(eye.normal, box);
  // Rounding of a form of three terms: a bound of 0 that is not one would lose light.
  const auto magnitude = hn::Add(hn::Abs(box.cx), hn::Add(hn::Abs(box.cy), hn::Abs(box.cz)));
  const auto slack = hn::Mul(hn::Set(d, 0x1p-21F), magnitude);
  const auto top = hn::Max(hn::Add(hn::Add(height.centre, height.reach), slack), hn::Zero(d));
  const auto t = least_magnitude(range_of(eye.tangent, box));
  const auto b = least_magnitude(range_of(eye.bitangent, box));
  return {top, hn::Sqrt(hn::MulAdd(top, top, hn::MulAdd(t, t, hn::Mul(b, b))))};
}

/// Largest cosine at the lights, past their cones. The receiver lies theta from the cone's axis as
/// seen from the centre, at `distance`; from elsewhere in the box's sphere by up to u =
/// asin(radius / distance) less. All cosines and sines below are times the distance.
HWY_INLINE HWY_ATTR Ratio emission_bound(const NodeBlock& block, std::size_t lane, const Box& box) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);
  const auto distance2 =
      hn::MulAdd(box.cx, box.cx, hn::MulAdd(box.cy, box.cy, hn::Mul(box.cz, box.cz)));
  const auto radius2 =
      hn::MulAdd(box.hx, box.hx, hn::MulAdd(box.hy, box.hy, hn::Mul(box.hz, box.hz)));
  const auto inside = hn::Ge(radius2, distance2);
  const auto sin_u = hn::Sqrt(radius2);
  const auto cos_u = hn::Sqrt(hn::Max(hn::Sub(distance2, radius2), zero));
  const auto away = hn::MulAdd(hn::Load(d, block.axis_x + lane), box.cx,
                               hn::MulAdd(hn::Load(d, block.axis_y + lane), box.cy,
                                          hn::Mul(hn::Load(d, block.axis_z + lane), box.cz)));
  const auto cos_theta = hn::Neg(away);
  const auto sin_theta = hn::Sqrt(hn::Max(hn::NegMulAdd(away, away, distance2), zero));
  const auto half = hn::Load(d, block.half_sine + lane);
  const auto half2 = hn::Mul(half, half);
  const auto cos_o = hn::NegMulAdd(two, half2, one);
  const auto sin_o = hn::Mul(hn::Mul(two, half), hn::Sqrt(hn::Max(hn::Sub(one, half2), zero)));
  // The cone widened by u; from a straight line on it holds every direction.
  const auto cos_w = hn::MulSub(cos_o, cos_u, hn::Mul(sin_o, sin_u));
  const auto sin_w = hn::MulAdd(sin_o, cos_u, hn::Mul(cos_o, sin_u));
  // Sines of angles near 0 and pi are good to half a milliradian. A bound of 0 that is not one
  // would be bias, a little too much is only noise: a milliradian is given away.
  const auto milliradian = hn::Set(d, 1e-3F);
  const auto wide =
      hn::And(hn::Lt(cos_w, zero), hn::Le(sin_w, hn::Mul(milliradian, hn::Neg(cos_w))));
  const auto full = hn::Or(hn::Or(inside, wide), hn::Ge(cos_theta, cos_w));
  const auto past = hn::MulAdd(cos_theta, cos_w, hn::Mul(sin_theta, sin_w));
  const auto bound = hn::MulAdd(milliradian, distance2, past);
  const auto ends = hn::Mul(hn::Load(d, block.cos_emission + lane), distance2);
  const auto alive = hn::IfThenElseZero(hn::Gt(bound, ends), hn::Min(bound, distance2));
  return {hn::IfThenElse(full, one, alive), hn::IfThenElse(full, one, distance2)};
}

/// A vector for every part of a block.
constexpr std::size_t kParts = kNodes / hn::MaxLanes(Floats());
struct Views {
  FloatVec weight[kParts], near2[kParts], far2[kParts];
};

HWY_INLINE HWY_ATTR Box box_of(const Eye& eye, const NodeBlock& block, std::size_t lane) {
  const Floats d;
  return {hn::Sub(hn::Load(d, block.centre_x + lane), hn::Set(d, eye.position.x)),
          hn::Sub(hn::Load(d, block.centre_y + lane), hn::Set(d, eye.position.y)),
          hn::Sub(hn::Load(d, block.centre_z + lane), hn::Set(d, eye.position.z)),
          hn::Load(d, block.half_x + lane),
          hn::Load(d, block.half_y + lane),
          hn::Load(d, block.half_z + lane)};
}

HWY_INLINE HWY_ATTR FloatVec near2(const Box& box) {
  const auto zero = hn::Zero(Floats());
  const auto x = hn::Max(hn::Sub(hn::Abs(box.cx), box.hx), zero);
  const auto y = hn::Max(hn::Sub(hn::Abs(box.cy), box.hy), zero);
  const auto z = hn::Max(hn::Sub(hn::Abs(box.cz), box.hz), zero);
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}
HWY_INLINE HWY_ATTR FloatVec far2(const Box& box) {
  const auto x = hn::Add(hn::Abs(box.cx), box.hx), y = hn::Add(hn::Abs(box.cy), box.hy),
             z = hn::Add(hn::Abs(box.cz), box.hz);
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

HWY_INLINE HWY_ATTR void look(const LightTree& tree, const Eye& eye, const NodeBlock& block,
                              Views& views) {
  const Floats d;
  const bool oriented = tree.oriented() == Oriented::Yes;
  for (std::size_t k = 0; k < kParts; ++k) {
    const std::size_t lane = k * hn::Lanes(d);
    const Box box = box_of(eye, block, lane);
    const auto intensity = hn::Load(d, block.intensity + lane);
    Ratio bound = cosine_bound(eye, box);
    if (oriented) {
      const Ratio emitted = emission_bound(block, lane, box);
      bound = {hn::Mul(bound.over, emitted.over), hn::Mul(bound.under, emitted.under)};
    }
    // Nodes without a light hold what was there before, be it not a number.
    const auto alive = hn::And(hn::Gt(intensity, hn::Zero(d)), hn::Gt(bound.over, hn::Zero(d)));
    views.weight[k] =
        hn::IfThenElseZero(alive, hn::Mul(intensity, hn::Div(bound.over, bound.under)));
    views.near2[k] = near2(box);
    views.far2[k] = far2(box);
  }
}

/// How likely each of sixteen nodes is: shares of `total`.
struct alignas(64) Chances {
  float at[kNodes];
  float total = 0.0F;
};

/// Squared distances below this, a nanometer's, are all alike: at distance 0 a node outweighs every
/// node that is not, and among those the weight decides. The product of two is still a number.
constexpr float kLeastDistance2 = 1e-18F;

HWY_INLINE HWY_ATTR FloatVec at_least(FloatVec distance2) {
  return hn::Max(distance2, hn::Set(Floats(), kLeastDistance2));
}
HWY_INLINE HWY_ATTR float total_of(const FloatVec (&parts)[kParts]) {
  const Floats d;
  auto sum = parts[0];
  for (std::size_t k = 1; k < kParts; ++k) sum = hn::Add(sum, parts[k]);
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

HWY_INLINE HWY_ATTR void near_and_far(const Views& views, Chances& out) {
  const Floats d;
  FloatVec near[kParts], far[kParts];
  for (std::size_t k = 0; k < kParts; ++k) {
    // weight / near2 and weight / far2 by one division.
    const auto n = at_least(views.near2[k]), f = at_least(views.far2[k]);
    const auto both = hn::Div(views.weight[k], hn::Mul(n, f));
    near[k] = hn::Mul(both, f), far[k] = hn::Mul(both, n);
  }
  const float near_total = total_of(near), far_total = total_of(far);
  if (!(near_total > 0.0F) || !(far_total > 0.0F)) return;
  const auto near_scale = hn::Set(d, 0.5F / near_total), far_scale = hn::Set(d, 0.5F / far_total);
  for (std::size_t k = 0; k < kParts; ++k) {
    hn::Store(hn::MulAdd(near[k], near_scale, hn::Mul(far[k], far_scale)), d,
              out.at + k * hn::Lanes(d));
  }
  out.total = 1.0F;
}

HWY_INLINE HWY_ATTR void near_or_intensity(const Views& views, const NodeBlock& block,
                                           Chances& out) {
  const Floats d;
  FloatVec near[kParts];
  bool by_intensity = false;
  for (std::size_t k = 0; k < kParts; ++k) {
    const std::size_t lane = k * hn::Lanes(d);
    const auto hx = hn::Load(d, block.half_x + lane), hy = hn::Load(d, block.half_y + lane),
               hz = hn::Load(d, block.half_z + lane);
    const auto half2 = hn::MulAdd(hx, hx, hn::MulAdd(hy, hy, hn::Mul(hz, hz)));
    const auto diagonal2 = hn::Max(hn::Mul(hn::Set(d, 4.0F), half2), hn::Set(d, kLeastDistance2));
    const auto live = hn::Gt(views.weight[k], hn::Zero(d));
    by_intensity |= !hn::AllFalse(d, hn::And(live, hn::Lt(views.near2[k], diagonal2)));
    near[k] = hn::Div(views.weight[k], at_least(views.near2[k]));
  }
  for (std::size_t k = 0; k < kParts; ++k) {
    if (by_intensity) near[k] = views.weight[k];
    hn::Store(near[k], d, out.at + k * hn::Lanes(d));
  }
  out.total = total_of(near);
}

/// After near_and_far, whose weights are those of `below` alone.
HWY_INLINE HWY_ATTR void defend(const NodeBlock& block, const Mask (&below)[kParts], Chances& out) {
  const Floats d;
  FloatVec intensity[kParts];
  for (std::size_t k = 0; k < kParts; ++k) {
    // Nodes without a light hold what was there before, be it not a number.
    const auto all = hn::Load(d, block.intensity + k * hn::Lanes(d));
    intensity[k] = hn::IfThenElseZero(hn::And(below[k], hn::Gt(all, hn::Zero(d))), all);
  }
  const float total = total_of(intensity);
  if (!(total > 0.0F)) return;
  const float kept = out.total > 0.0F ? 1.0F - kDefensiveShare : 0.0F;
  const auto scale = hn::Set(d, (1.0F - kept) / total), keep = hn::Set(d, kept);
  for (std::size_t k = 0; k < kParts; ++k) {
    float* at = out.at + k * hn::Lanes(d);
    const auto before = kept > 0.0F ? hn::Mul(keep, hn::Load(d, at)) : hn::Zero(d);
    hn::Store(hn::MulAdd(scale, intensity[k], before), d, at);
  }
  out.total = 1.0F;
}

/// How a walk may go on from `node`.
struct Step {
  std::size_t block, first, count;
  int levels;
};
HWY_INLINE Step step_below(NodeId node, NodeId first_leaf) {
  const int left = level_of(first_leaf) - level_of(node);
  const int levels = left % 4 == 0 ? 4 : left % 4;
  const NodeId child = node << levels;
  return {child / kNodes, child % kNodes, std::size_t{1} << levels, levels};
}

/// Total 0: no light below can reach the receiver.
HWY_INLINE HWY_ATTR void chances_below(const LightTree& tree, const Eye& eye, WeightRule rule,
                                       const Step& step, Chances& out) {
  const Floats d;
  const NodeBlock& block = tree.blocks()[step.block];
  Views views;
  look(tree, eye, block, views);
  const auto begin = hn::Set(d, static_cast<float>(step.first));
  const auto end = hn::Set(d, static_cast<float>(step.first + step.count));
  Mask below[kParts];
  for (std::size_t k = 0; k < kParts; ++k) {
    const auto id = hn::Iota(d, static_cast<float>(k * hn::Lanes(d)));
    below[k] = hn::And(hn::Ge(id, begin), hn::Lt(id, end));
    views.weight[k] = hn::IfThenElseZero(below[k], views.weight[k]);
  }
  if (rule == WeightRule::NearOrIntensity) {
    near_or_intensity(views, block, out);
    return;
  }
  near_and_far(views, out);
  if (rule == WeightRule::Defensive) defend(block, below, out);
}

// ---- walks ----

struct Picked {
  std::size_t lane = 0;
  float before = 0.0F;  ///< of the lanes before it
};
/// The lane whose stretch of the total holds u in [0, 1): first the four, then the one; comparisons
/// are added up, since no branch could be foretold. A lane without a chance has no stretch.
HWY_INLINE HWY_ATTR Picked pick(const Chances& chances, double u) {
  const Floats d;
  // Within each four: of the lanes up to each, and of those before it.
  alignas(64) float sums[kNodes], before[kNodes];
  for (std::size_t lane = 0; lane < kNodes; lane += hn::Lanes(d)) {
    auto x = hn::Load(d, chances.at + lane);
    x = hn::Add(x, hn::ShiftLeftLanes<1>(d, x));
    x = hn::Add(x, hn::ShiftLeftLanes<2>(d, x));
    hn::Store(x, d, sums + lane);
    hn::Store(hn::ShiftLeftLanes<1>(d, x), d, before + lane);
  }
  const auto target = static_cast<float>(u * static_cast<double>(chances.total));
  const float four[4] = {0.0F, sums[3], sums[3] + sums[7], sums[3] + sums[7] + sums[11]};
  const auto reached = [target](float x) { return static_cast<std::size_t>(target >= x); };
  const std::size_t group = reached(four[1]) + reached(four[2]) + reached(four[3]);
  const float* in_group = sums + 4 * group;
  const float rest = target - four[group];
  const auto passed = [rest](float x) { return static_cast<std::size_t>(rest >= x); };
  std::size_t lane = 4 * group + passed(in_group[0]) + passed(in_group[1]) + passed(in_group[2]);
  // Rounding may carry the target past the last stretch.
  while (!(chances.at[lane] > 0.0F)) lane = (lane + kNodes - 1) % kNodes;
  return {lane, four[lane / 4] + before[lane]};
}

/// A walk on its way down.
struct Walk {
  Eye eye{Receiver{}};
  NodeId node = 0;  ///< where it is; 0: no light below reaches the receiver
  double u = 0.0, probability = 0.0;
  std::size_t descent = 0;  ///< which one it is

  Walk() = default;
  Walk(const Descent& from, std::size_t which)
      : eye(from.receiver), node(from.node), u(from.u), probability(1.0), descent(which) {}
  bool has_ended(const LightTree& tree) const { return node == 0 || tree.is_leaf(node); }
  LeafChoice choice() const { return {node, probability}; }
};

/// A visit's outcome before it is drawn.
struct Visit {
  Chances chances;
  std::size_t block = 0;
};
HWY_INLINE HWY_ATTR void weigh_below(const LightTree& tree, WeightRule rule, const Walk& walk,
                                     Visit& visit) {
  const Step step = step_below(walk.node, tree.first_leaf());
  visit.block = step.block;
  visit.chances.total = 0.0F;
  chances_below(tree, walk.eye, rule, step, visit.chances);
}
HWY_INLINE HWY_ATTR void go_down(const Visit& visit, Walk& walk) {
  const Chances& chances = visit.chances;
  if (!(chances.total > 0.0F)) {
    walk.node = 0, walk.probability = 0.0;
    return;
  }
  const Picked picked = pick(chances, walk.u);
  const double chance = chances.at[picked.lane], total = chances.total;
  walk.probability *= chance / total;
  // What is left of u inside its stretch is uniform again.
  constexpr double kBelowOne = 1.0 - 0x1p-53;
  const double left = (walk.u * total - static_cast<double>(picked.before)) / chance;
  walk.u = std::min(std::max(left, 0.0), kBelowOne);
  walk.node = static_cast<NodeId>(visit.block * kNodes + picked.lane);
}

HWY_ATTR LeafChoice choose_leaf(const LightTree& tree, WeightRule rule, const Descent& descent) {
  Walk walk(descent, 0);
  Visit visit;
  while (!walk.has_ended(tree)) {
    weigh_below(tree, rule, walk, visit);
    go_down(visit, walk);
  }
  return walk.choice();
}

/// Fetches what the walk's next visit reads.
HWY_INLINE void foresee(const LightTree& tree, const Walk& walk) {
  if (walk.has_ended(tree)) return;
  const NodeBlock& block = tree.blocks()[step_below(walk.node, tree.first_leaf()).block];
  const auto fetch = [](const NodeBlock::Row& row) { hwy::Prefetch(&row[0]); };
  for (const auto* row : {&block.centre_x, &block.centre_y, &block.centre_z, &block.half_x,
                          &block.half_y, &block.half_z, &block.intensity}) {
    fetch(*row);
  }
  if (tree.oriented() == Oriented::No) return;
  for (const auto* row :
       {&block.axis_x, &block.axis_y, &block.axis_z, &block.half_sine, &block.cos_emission}) {
    fetch(*row);
  }
}

/// Walks on their way at a time. A visit waits for its walk's visit before, never for another's;
/// all are weighed before any is drawn, since a draw is a chain of short steps that would keep the
/// next one's arithmetic out of the processor's sight.
constexpr std::size_t kTogether = 8;

HWY_ATTR void choose_leaves(const LightTree& tree, WeightRule rule,
                            std::span<const Descent> descents, std::span<LeafChoice> choices) {
  Walk walks[kTogether];
  Visit visits[kTogether];
  std::size_t begun = 0, going = 0;
  // Begins the next descent that has a way to go; false: there is none.
  const auto begin = [&](Walk& walk) {
    while (begun < descents.size()) {
      walk = Walk(descents[begun], begun);
      ++begun;
      if (!walk.has_ended(tree)) {
        foresee(tree, walk);
        return true;
      }
      choices[walk.descent] = walk.choice();
    }
    return false;
  };
  while (going < kTogether && begin(walks[going])) ++going;
  while (going > 0) {
    for (std::size_t k = 0; k < going; ++k) weigh_below(tree, rule, walks[k], visits[k]);
    for (std::size_t k = 0; k < going; ++k) {
      go_down(visits[k], walks[k]);
      foresee(tree, walks[k]);
    }
    for (std::size_t k = 0; k < going;) {
      Walk& walk = walks[k];
      if (walk.has_ended(tree)) {
        choices[walk.descent] = walk.choice();
        if (!begin(walk)) {
          walk = walks[--going];
          continue;
        }
      }
      ++k;
    }
  }
}

HWY_ATTR double node_probability(const LightTree& tree, const Receiver& receiver, WeightRule rule,
                                 NodeId node, NodeId inner) {
  const Eye eye(receiver);
  double probability = 1.0;
  while (node != inner) {
    const Step step = step_below(node, tree.first_leaf());
    Chances chances;
    chances_below(tree, eye, rule, step, chances);
    if (!(chances.total > 0.0F)) return 0.0;
    // The step may pass `inner` by: then all of its nodes below that count.
    const int down = level_of(inner) - level_of(node), past = std::max(step.levels - down, 0);
    node = past > 0 ? inner : inner >> (down - step.levels);
    const std::size_t first = (std::size_t{node} << past) % kNodes;
    double chance = 0.0;
    for (std::size_t k = 0; k < std::size_t{1} << past; ++k) {
      chance += static_cast<double>(chances.at[first + k]);
    }
    probability *= chance / static_cast<double>(chances.total);
  }
  return probability;
}

HWY_ATTR NodeView view_of(const LightTree& tree, const Receiver& receiver, NodeId node) {
  const Floats d;
  Views views;
  look(tree, Eye(receiver), tree.blocks()[node / kNodes], views);
  alignas(64) float weight[kNodes], near[kNodes], far[kNodes];
  for (std::size_t k = 0; k < kParts; ++k) {
    hn::Store(views.weight[k], d, weight + k * hn::Lanes(d));
    hn::Store(views.near2[k], d, near + k * hn::Lanes(d));
    hn::Store(views.far2[k], d, far + k * hn::Lanes(d));
  }
  const std::size_t lane = node % kNodes;
  return {weight[lane], near[lane], far[lane]};
}

// ---- the cut ----

/// Of a heap: the largest bound on top, of equals the smaller id.
bool is_less_urgent(const LightCut::Candidate& a, const LightCut::Candidate& b) {
  return a.bound != b.bound ? a.bound < b.bound : a.node > b.node;
}

/// What every node of a block may send at most, in shares of the brightest light's intensity.
HWY_INLINE HWY_ATTR const float* bounds_in(const LightTree& tree, const Eye& eye, NodeId block,
                                           float least2, LightCut& cut) {
  const Floats d;
  LightCut::Seen& seen = cut.seen[block % cut.seen.size()];
  if (seen.block == block) return seen.bound;
  seen.block = block;
  Views views;
  look(tree, eye, tree.blocks()[block], views);
  for (std::size_t k = 0; k < kParts; ++k) {
    const auto distance2 = hn::Max(views.near2[k], hn::Set(d, least2));
    hn::Store(hn::Div(views.weight[k], distance2), d, seen.bound + k * hn::Lanes(d));
  }
  return seen.bound;
}

HWY_ATTR void cut_tree(const LightTree& tree, const Receiver& receiver, std::size_t most_nodes,
                       LightCut& cut) {
  cut.nodes.clear(), cut.dark.clear();
  for (LightCut::Seen& seen : cut.seen) seen.block = LightCut::kNoBlock;
  const Eye eye(receiver);
  const float least = kLeastCutDistance * tree.radius_m();
  const float least2 = std::max(least * least, kLeastDistance2);
  std::vector<LightCut::Candidate>& heap = cut.candidates;
  heap.clear();
  const auto add = [&](NodeId node) {
    const float bound = bounds_in(tree, eye, node / kNodes, least2, cut)[node % kNodes];
    if (!(bound > 0.0F)) {
      if (tree.blocks()[node / kNodes].intensity[node % kNodes] > 0.0F) cut.dark.push_back(node);
      return;
    }
    if (tree.is_leaf(node)) {
      cut.nodes.push_back(node);
      return;
    }
    heap.push_back({bound, node});
    std::push_heap(heap.begin(), heap.end(), is_less_urgent);
  };
  add(1);
  while (!heap.empty() && cut.nodes.size() + heap.size() < most_nodes) {
    std::pop_heap(heap.begin(), heap.end(), is_less_urgent);
    const NodeId split = heap.back().node;
    heap.pop_back();
    add(2 * split);
    add(2 * split + 1);
  }
  for (const LightCut::Candidate& left : heap) cut.nodes.push_back(left.node);
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(choose_leaf);
HWY_EXPORT(choose_leaves);
HWY_EXPORT(node_probability);
HWY_EXPORT(view_of);
HWY_EXPORT(cut_tree);

LightWalk::LightWalk(const LightTree& tree, const Receiver& receiver, WeightRule rule)
    : tree_(tree), receiver_(receiver), rule_(rule) {}

void LightWalk::cut(std::size_t most_nodes, LightCut& cut) const {
  HWY_DYNAMIC_DISPATCH(cut_tree)(tree_, receiver_, most_nodes, cut);
}

LeafChoice LightWalk::choose(NodeId node, double u) const {
  return HWY_DYNAMIC_DISPATCH(choose_leaf)(tree_, rule_, {receiver_, node, u});
}

double LightWalk::probability(NodeId node, NodeId inner) const {
  return HWY_DYNAMIC_DISPATCH(node_probability)(tree_, receiver_, rule_, node, inner);
}

NodeView LightWalk::view(NodeId node) const {
  return HWY_DYNAMIC_DISPATCH(view_of)(tree_, receiver_, node);
}

void choose_each(const LightTree& tree, WeightRule rule, std::span<const Descent> descents,
                 std::span<LeafChoice> choices) {
  MACULA_DCHECK(choices.size() >= descents.size());
  HWY_DYNAMIC_DISPATCH(choose_leaves)(tree, rule, descents, choices);
}

}  // namespace macula::lights
#endif
