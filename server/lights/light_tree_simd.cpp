// Sixteen parents at once: their children are two neighbouring blocks, left ones on even lanes.
#include "server/lights/light_tree_simd.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/light_tree_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, NodeBlock::kNodes>;
using FloatVec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;

struct Pair {
  FloatVec left, right;
};
/// The children of parents lane .. lane + Lanes of the block made from `children` and the next.
HWY_INLINE HWY_ATTR Pair children_of(const NodeBlock* children, NodeBlock::Row NodeBlock::*row,
                                     std::size_t lane) {
  const Floats d;
  const std::size_t first = 2 * lane, second = first + hn::Lanes(d);
  const auto a = hn::Load(d, (children[first / 16].*row) + first % 16);
  const auto b = hn::Load(d, (children[second / 16].*row) + second % 16);
  return {hn::ConcatEven(d, b, a), hn::ConcatOdd(d, b, a)};
}

/// Writes only where there is a parent.
HWY_INLINE HWY_ATTR void store(Mask parents, FloatVec value, float* to) {
  const Floats d;
  hn::Store(hn::IfThenElse(parents, value, hn::Load(d, to)), d, to);
}

struct Merge {
  Mask parents;      ///< lanes that are inner nodes
  Mask left, right;  ///< whether a child has a light
  const NodeBlock* children;
  NodeBlock* out;
  std::size_t lane;
};

HWY_INLINE HWY_ATTR void merge_axis(const Merge& m, NodeBlock::Row NodeBlock::*centre,
                                    NodeBlock::Row NodeBlock::*half) {
  const Floats d;
  const Pair c = children_of(m.children, centre, m.lane), h = children_of(m.children, half, m.lane);
  const auto infinite = hn::Inf(d);
  const auto low = hn::Min(hn::IfThenElse(m.left, hn::Sub(c.left, h.left), infinite),
                           hn::IfThenElse(m.right, hn::Sub(c.right, h.right), infinite));
  const auto high = hn::Max(hn::IfThenElse(m.left, hn::Add(c.left, h.left), hn::Neg(infinite)),
                            hn::IfThenElse(m.right, hn::Add(c.right, h.right), hn::Neg(infinite)));
  const auto any = hn::Or(m.left, m.right);
  const auto middle = hn::IfThenElseZero(any, hn::Mul(hn::Set(d, 0.5F), hn::Add(low, high)));
  // Both ends and the middle were rounded: a few halves of a unit in the last place.
  const auto reach = hn::Max(hn::Abs(low), hn::Abs(high));
  const auto span = hn::Mul(hn::Set(d, 0.5F), hn::Sub(high, low));
  const auto padded = hn::MulAdd(hn::Set(d, 0x1p-21F), reach, span);
  // A point stays a point: coincident lights have nothing to round.
  const auto width = hn::IfThenElse(hn::Gt(span, hn::Zero(d)), padded, hn::Zero(d));
  store(m.parents, middle, (m.out->*centre) + m.lane);
  store(m.parents, hn::IfThenElseZero(any, width), (m.out->*half) + m.lane);
}

/// cos of an angle in [0, pi/2] from its sine.
HWY_INLINE HWY_ATTR FloatVec cofunction(FloatVec sine) {
  const Floats d;
  return hn::Sqrt(hn::Max(hn::NegMulAdd(sine, sine, hn::Set(d, 1.0F)), hn::Zero(d)));
}

/// A cone by half its half-angle, in [0, pi/2]: narrow ones keep their digits.
struct Cone {
  FloatVec x, y, z, sine, cosine;
};
struct Angle {
  FloatVec sine, cosine;
};
HWY_INLINE HWY_ATTR Angle sum(const Angle& a, const Angle& b) {
  return {hn::MulAdd(a.sine, b.cosine, hn::Mul(a.cosine, b.sine)),
          hn::MulSub(a.cosine, b.cosine, hn::Mul(a.sine, b.sine))};
}
HWY_INLINE HWY_ATTR Angle difference(const Angle& a, const Angle& b) {
  return {hn::MulSub(a.sine, b.cosine, hn::Mul(a.cosine, b.sine)),
          hn::MulAdd(a.cosine, b.cosine, hn::Mul(a.sine, b.sine))};
}
HWY_INLINE HWY_ATTR Cone choose(Mask mask, const Cone& yes, const Cone& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z), hn::IfThenElse(mask, yes.sine, no.sine),
          hn::IfThenElse(mask, yes.cosine, no.cosine)};
}

/// The smallest cone about two, without a trigonometric function. With half-angles 2a and 2b and
/// axes 2c apart, its half-angle is a + b + c, and its axis lies b + c - a from the first towards
/// the second; a cone whose neighbour is not reached by that turn holds both already.
HWY_INLINE HWY_ATTR Cone smallest_about(const Cone& first, const Cone& second) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F), half = hn::Set(d, 0.5F);
  const auto dx = hn::Sub(second.x, first.x), dy = hn::Sub(second.y, first.y),
             dz = hn::Sub(second.z, first.z);
  const auto chord2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
  const auto half_chord = hn::Min(hn::Mul(half, hn::Sqrt(chord2)), one);
  const Angle a{first.sine, first.cosine}, b{second.sine, second.cosine},
      c{half_chord, cofunction(half_chord)};
  const Angle turn = difference(sum(b, c), a), back = difference(sum(a, c), b);
  const Angle width = sum(sum(a, b), c);
  // a + b + c reaches up to 3 pi / 2: from pi on its sine is not positive; a milliradian earlier
  // still, the axis has digits left.
  const auto beyond = hn::And(hn::Le(width.sine, hn::Set(d, 1e-3F)), hn::Lt(width.cosine, zero));
  const auto full = hn::Or(beyond, hn::Ge(half_chord, one));
  // The unit vector across the first axis, in the plane of both: (second - first) plus the first
  // times 1 - cos 2c.
  const auto lift = hn::Mul(hn::Set(d, 2.0F), hn::Mul(half_chord, half_chord));
  const auto ex = hn::MulAdd(lift, first.x, dx), ey = hn::MulAdd(lift, first.y, dy),
             ez = hn::MulAdd(lift, first.z, dz);
  const auto length2 = hn::MulAdd(ex, ex, hn::MulAdd(ey, ey, hn::Mul(ez, ez)));
  const auto across =
      hn::IfThenElseZero(hn::Gt(length2, zero), hn::Div(turn.sine, hn::Sqrt(length2)));
  Cone both;
  both.x = hn::MulAdd(turn.cosine, first.x, hn::Mul(across, ex));
  both.y = hn::MulAdd(turn.cosine, first.y, hn::Mul(across, ey));
  both.z = hn::MulAdd(turn.cosine, first.z, hn::Mul(across, ez));
  const auto norm =
      hn::Sqrt(hn::MulAdd(both.x, both.x, hn::MulAdd(both.y, both.y, hn::Mul(both.z, both.z))));
  both.x = hn::IfThenElse(full, first.x, hn::Div(both.x, norm));
  both.y = hn::IfThenElse(full, first.y, hn::Div(both.y, norm));
  both.z = hn::IfThenElse(full, first.z, hn::Div(both.z, norm));
  both.cosine = hn::Sqrt(hn::Max(hn::Mul(half, hn::Add(one, width.cosine)), zero));
  both.sine = hn::IfThenElse(full, one, hn::Div(hn::Mul(half, width.sine), both.cosine));
  both = choose(hn::Le(back.sine, zero), second, both);
  return choose(hn::Le(turn.sine, zero), first, both);
}

HWY_INLINE HWY_ATTR void merge_cones(const Merge& m) {
  const Floats d;
  const Pair x = children_of(m.children, &NodeBlock::axis_x, m.lane);
  const Pair y = children_of(m.children, &NodeBlock::axis_y, m.lane);
  const Pair z = children_of(m.children, &NodeBlock::axis_z, m.lane);
  const Pair s = children_of(m.children, &NodeBlock::half_sine, m.lane);
  const Pair e = children_of(m.children, &NodeBlock::cos_emission, m.lane);
  const Cone left{x.left, y.left, z.left, s.left, cofunction(s.left)};
  const Cone right{x.right, y.right, z.right, s.right, cofunction(s.right)};
  Cone both = smallest_about(left, right);
  both = choose(m.right, choose(m.left, both, right), left);
  const auto one = hn::Set(d, 1.0F);
  const auto emission =
      hn::Min(hn::IfThenElse(m.left, e.left, one), hn::IfThenElse(m.right, e.right, one));
  store(m.parents, both.x, m.out->axis_x + m.lane);
  store(m.parents, both.y, m.out->axis_y + m.lane);
  store(m.parents, both.z, m.out->axis_z + m.lane);
  store(m.parents, both.sine, m.out->half_sine + m.lane);
  store(m.parents, emission, m.out->cos_emission + m.lane);
}

HWY_INLINE HWY_ATTR void merge_block(NodeBlock* blocks, std::size_t block, NodeId first_leaf,
                                     Oriented oriented) {
  const Floats d;
  for (std::size_t lane = 0; lane < NodeBlock::kNodes; lane += hn::Lanes(d)) {
    const Pair intensity = children_of(blocks + 2 * block, &NodeBlock::intensity, lane);
    const auto id = hn::Iota(d, static_cast<float>(lane));
    const float inner = block == 0 ? static_cast<float>(first_leaf) : 16.0F;
    const Merge m{hn::Lt(id, hn::Set(d, inner)),
                  hn::Gt(intensity.left, hn::Zero(d)),
                  hn::Gt(intensity.right, hn::Zero(d)),
                  blocks + 2 * block,
                  blocks + block,
                  lane};
    merge_axis(m, &NodeBlock::centre_x, &NodeBlock::half_x);
    merge_axis(m, &NodeBlock::centre_y, &NodeBlock::half_y);
    merge_axis(m, &NodeBlock::centre_z, &NodeBlock::half_z);
    if (oriented == Oriented::Yes) merge_cones(m);
  }
}

/// However dim, a light that shines keeps a chance.
HWY_INLINE float share(double intensity) {
  return std::max(static_cast<float>(intensity), std::numeric_limits<float>::min());
}

/// Intensities of a block's parents, then all else.
HWY_INLINE HWY_ATTR void merge_nodes(const TreeNodes& nodes, std::size_t block, Oriented oriented) {
  const std::size_t first = block * NodeBlock::kNodes;
  const std::size_t begin = std::max<std::size_t>(first, 1);
  const std::size_t end = std::min<std::size_t>(first + NodeBlock::kNodes, nodes.first_leaf);
  NodeBlock::Row& row = nodes.blocks[block].intensity;
  const auto intensity_of = [&](std::size_t node) {
    if (node < nodes.first_leaf) return nodes.intensity[node];
    const NodeBlock& leaves = nodes.blocks[node / NodeBlock::kNodes];
    return static_cast<double>(leaves.intensity[node % NodeBlock::kNodes]);
  };
  for (std::size_t node = end; node-- > begin;) {
    const double sum = intensity_of(2 * node) + intensity_of(2 * node + 1);
    nodes.intensity[node] = sum;
    row[node - first] = sum > 0.0 ? share(sum) : 0.0F;
  }
  // Block 0 holds four levels, each made from the one below it: one level a pass.
  for (int level = 0; level < (block == 0 ? 4 : 1); ++level) {
    merge_block(nodes.blocks.data(), block, nodes.first_leaf, oriented);
  }
}

HWY_INLINE void put(const LightBounds& light, Oriented oriented, NodeBlock& block,
                    std::size_t lane) {
  block.centre_x[lane] = light.centre.x;
  block.centre_y[lane] = light.centre.y;
  block.centre_z[lane] = light.centre.z;
  block.half_x[lane] = light.half.x;
  block.half_y[lane] = light.half.y;
  block.half_z[lane] = light.half.z;
  if (oriented == Oriented::No) return;
  block.axis_x[lane] = light.axis.x;
  block.axis_y[lane] = light.axis.y;
  block.axis_z[lane] = light.axis.z;
  block.half_sine[lane] = light.half_sine;
  block.cos_emission[lane] = light.cos_emission;
}

/// The lights of a block's lanes; kNobody: none.
struct alignas(64) LaneLights {
  static constexpr std::int32_t kNobody = -1;
  std::int32_t at[NodeBlock::kNodes];
};
/// Leaves' lights lie in memory in another order: those of later blocks are asked for in advance.
template <class Fetch>
HWY_INLINE HWY_ATTR LaneLights lights_of(std::span<const std::uint32_t> order, NodeId first_leaf,
                                         std::size_t block, const Fetch& fetch) {
  constexpr std::size_t kNodes = NodeBlock::kNodes, kAhead = 3 * kNodes;
  const std::size_t first = block * kNodes;
  LaneLights lights;
  if (first >= first_leaf && first - first_leaf + kNodes <= order.size()) {
    const hn::CappedTag<std::uint32_t, kNodes> d;
    const std::size_t place = first - first_leaf;
    for (std::size_t lane = 0; lane < kNodes; lane += hn::Lanes(d)) {
      const auto here = hn::LoadU(d, order.data() + place + lane);
      hn::Store(hn::BitCast(hn::RebindToSigned<decltype(d)>(), here),
                hn::RebindToSigned<decltype(d)>(), lights.at + lane);
    }
    const std::size_t end = std::min(place + kAhead + kNodes, order.size());
    for (std::size_t k = place + kAhead; k < end; ++k) fetch(order[k]);
    return lights;
  }
  for (std::size_t lane = 0; lane < kNodes; ++lane) {
    const std::size_t node = first + lane, place = node - first_leaf;
    const bool any = node >= first_leaf && place < order.size();
    lights.at[lane] = any ? static_cast<std::int32_t>(order[place]) : LaneLights::kNobody;
  }
  return lights;
}

/// The leaves of a block; what lies past the last light is empty.
HWY_INLINE HWY_ATTR void place_leaves(const BoundLights& leaves, const TreeNodes& nodes,
                                      std::size_t block) {
  NodeBlock& out = nodes.blocks[block];
  const LaneLights lights =
      lights_of(leaves.order, nodes.first_leaf, block,
                [&](std::uint32_t light) { __builtin_prefetch(&leaves.lights[light]); });
  for (std::size_t lane = 0; lane < NodeBlock::kNodes; ++lane) {
    if (block * NodeBlock::kNodes + lane < nodes.first_leaf) continue;
    out.intensity[lane] = 0.0F;
    if (lights.at[lane] == LaneLights::kNobody) continue;
    const LightBounds& light = leaves.lights[static_cast<std::size_t>(lights.at[lane])];
    out.intensity[lane] = share(light.intensity / leaves.brightest);
    put(light, leaves.oriented, out, lane);
  }
}

// ---- leaves by the rows of a table ----

using Ints = hn::Rebind<std::int32_t, Floats>;
using IntVec = hn::Vec<Ints>;

/// One float of every lane's row.
struct RowReader {
  const float* rows;
  IntVec row;  ///< times the floats of a row

  HWY_INLINE HWY_ATTR FloatVec operator()(std::size_t column) const {
    return hn::GatherIndex(Floats(), rows + column, row);
  }
};
/// Columns of PlacedLightRow.
enum Column : std::size_t { kPosition = 0, kEdge1 = 3, kEdge2 = 6, kNormal = 9, kEmission = 12 };
constexpr std::size_t kArea = 15;

struct LeafKind {
  Mask triangle;  ///< with two edges
  Mask lamp;      ///< with cosines of cones
};

/// Of the point or of the triangle's corners, as receivers work them out.
HWY_INLINE HWY_ATTR void put_axis(const RowReader& read, const LeafKind& kind, std::size_t axis,
                                  float* centre, float* half) {
  const Floats d;
  const auto zero = hn::Zero(d);
  const auto from = read(kPosition + axis);
  auto low = zero, high = zero;
  if (!hn::AllFalse(d, kind.triangle)) {
    const auto e1 = hn::IfThenElseZero(kind.triangle, read(kEdge1 + axis));
    const auto e2 = hn::IfThenElseZero(kind.triangle, read(kEdge2 + axis));
    low = hn::Min(zero, hn::Min(e1, e2)), high = hn::Max(zero, hn::Max(e1, e2));
  }
  const auto middle = hn::MulAdd(hn::Set(d, 0.5F), hn::Add(low, high), from);
  // Sums of three terms and the middle were rounded: a few halves of a unit in the last place.
  const auto reach = hn::Max(hn::Abs(hn::Add(from, low)), hn::Abs(hn::Add(from, high)));
  const auto span = hn::Mul(hn::Set(d, 0.5F), hn::Sub(high, low));
  const auto padded = hn::MulAdd(hn::Set(d, 0x1p-21F), reach, span);
  hn::Store(middle, d, centre);
  hn::Store(hn::IfThenElseZero(hn::Gt(span, zero), padded), d, half);
}

/// A lamp's cone by the cosines that receivers compare with: all directions where the inner one
/// is below -1.
HWY_INLINE HWY_ATTR void put_cone(const RowReader& read, const LeafKind& kind, NodeBlock& out,
                                  std::size_t lane) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const auto outer = read(kEdge1), inner = read(kEdge1 + 1);
  const auto everywhere = hn::Lt(inner, hn::Neg(one));
  const auto half2 = hn::Mul(hn::Set(d, 0.5F), hn::Sub(one, inner));
  const auto half_sine = hn::IfThenElse(everywhere, one, hn::Sqrt(hn::Max(half2, zero)));
  // Between its cones a spot's squared ramp stays below the cosine of the angle to the inner one.
  const auto between = hn::MulAdd(outer, inner, hn::Mul(cofunction(outer), cofunction(inner)));
  const auto lamp_ends = hn::IfThenElseZero(hn::Not(everywhere), between);
  hn::Store(hn::IfThenElseZero(kind.lamp, half_sine), d, out.half_sine + lane);
  hn::Store(hn::IfThenElseZero(kind.lamp, lamp_ends), d, out.cos_emission + lane);
  hn::Store(read(kNormal), d, out.axis_x + lane);
  hn::Store(read(kNormal + 1), d, out.axis_y + lane);
  hn::Store(read(kNormal + 2), d, out.axis_z + lane);
}

/// image::luminance.
HWY_INLINE HWY_ATTR FloatVec luminance_of(const RowReader& read) {
  const Floats d;
  const auto red = hn::Set(d, 0.2126F), green = hn::Set(d, 0.7152F), blue = hn::Set(d, 0.0722F);
  return hn::MulAdd(red, read(kEmission),
                    hn::MulAdd(green, read(kEmission + 1), hn::Mul(blue, read(kEmission + 2))));
}

/// Intensities as shares of the brightest light's; the dimmest keep a chance.
struct Shares {
  static constexpr float kLeast = std::numeric_limits<float>::min();
  float scale;

  explicit Shares(const PlacedLightTable& table)
      : scale(1.0F / std::max(table.brightest, kLeast)) {}
  HWY_INLINE HWY_ATTR FloatVec of(FloatVec intensity) const {
    const Floats d;
    return hn::Max(hn::Mul(hn::Set(d, scale), intensity), hn::Set(d, kLeast));
  }
};

/// Lights that shine everywhere are points: their places say it all.
HWY_INLINE HWY_ATTR void place_points(const PlacedLightTable& table, const LaneLights& lights,
                                      NodeBlock& out) {
  const Floats d;
  const Ints di;
  const Shares shares(table);
  for (std::size_t lane = 0; lane < NodeBlock::kNodes; lane += hn::Lanes(d)) {
    const auto light = hn::Load(di, lights.at + lane);
    const auto shines = hn::RebindMask(d, hn::Gt(light, hn::Set(di, LaneLights::kNobody)));
    const RowReader read{&table.places.data()->x, hn::ShiftLeft<2>(hn::Max(light, hn::Zero(di)))};
    hn::Store(read(0), d, out.centre_x + lane);
    hn::Store(read(1), d, out.centre_y + lane);
    hn::Store(read(2), d, out.centre_z + lane);
    for (float* half : {out.half_x, out.half_y, out.half_z}) {
      hn::Store(hn::Zero(d), d, half + lane);
    }
    hn::Store(hn::IfThenElseZero(shines, shares.of(read(3))), d, out.intensity + lane);
  }
}

HWY_INLINE HWY_ATTR void place_rows(const PlacedLightTable& table, const LaneLights& lights,
                                    NodeBlock& out) {
  const Floats d;
  const Ints di;
  const Shares shares(table);
  for (std::size_t lane = 0; lane < NodeBlock::kNodes; lane += hn::Lanes(d)) {
    const auto light = hn::Load(di, lights.at + lane);
    const auto shines = hn::RebindMask(d, hn::Gt(light, hn::Set(di, LaneLights::kNobody)));
    const RowReader read{table.floats(), hn::ShiftLeft<4>(hn::Max(light, hn::Zero(di)))};
    const auto area = read(kArea);
    const LeafKind kind{hn::Gt(area, hn::Zero(d)), hn::Eq(area, hn::Zero(d))};
    put_axis(read, kind, 0, out.centre_x + lane, out.half_x + lane);
    put_axis(read, kind, 1, out.centre_y + lane, out.half_y + lane);
    put_axis(read, kind, 2, out.centre_z + lane, out.half_z + lane);
    put_cone(read, kind, out, lane);
    const auto emitted = luminance_of(read);
    const auto intensity = hn::IfThenElse(kind.triangle, hn::Mul(area, emitted), emitted);
    hn::Store(hn::IfThenElseZero(shines, shares.of(intensity)), d, out.intensity + lane);
  }
}

/// Lanes before the first leaf are parents, made from these.
HWY_INLINE HWY_ATTR void place_leaves(const TableLights& leaves, const TreeNodes& nodes,
                                      std::size_t block) {
  const PlacedLightTable& table = leaves.table;
  NodeBlock& out = nodes.blocks[block];
  if (leaves.order.empty()) {
    std::ranges::fill(out.intensity, 0.0F);
    return;
  }
  if (table.oriented == Oriented::No) {
    place_points(table,
                 lights_of(leaves.order, nodes.first_leaf, block,
                           [&](std::uint32_t light) { __builtin_prefetch(&table.places[light]); }),
                 out);
    return;
  }
  place_rows(table,
             lights_of(leaves.order, nodes.first_leaf, block,
                       [&](std::uint32_t light) { __builtin_prefetch(&table.rows[light]); }),
             out);
}

/// A block's children are blocks 2 k and 2 k + 1: it is made when the second of them is.
HWY_INLINE HWY_ATTR void merge_above(const TreeNodes& nodes, std::size_t block, Oriented oriented) {
  while (block % 2 == 1 && block > 1) merge_nodes(nodes, block /= 2, oriented);
}

template <class Leaves>
HWY_INLINE HWY_ATTR void grow(const Leaves& leaves, Oriented oriented, const TreeNodes& nodes) {
  nodes.blocks[0].intensity[0] = 0.0F;  // no node
  const std::size_t first = nodes.first_leaf / NodeBlock::kNodes, end = nodes.blocks.size();
  // Leaves are written lane by lane; vectors that read them at once would wait for the stores.
  constexpr std::size_t kLag = 2;
  for (std::size_t block = first; block < end; ++block) {
    place_leaves(leaves, nodes, block);
    if (block >= first + kLag) merge_above(nodes, block - kLag, oriented);
  }
  for (std::size_t block = std::max(first + kLag, end) - kLag; block < end; ++block) {
    merge_above(nodes, block, oriented);
  }
  merge_nodes(nodes, 0, oriented);
}
HWY_ATTR void grow_from_bounds(const BoundLights& leaves, const TreeNodes& nodes) {
  grow(leaves, leaves.oriented, nodes);
}
HWY_ATTR void grow_from_table(const TableLights& leaves, const TreeNodes& nodes) {
  grow(leaves, leaves.table.oriented, nodes);
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(grow_from_bounds);
HWY_EXPORT(grow_from_table);

void grow_tree(const BoundLights& leaves, const TreeNodes& nodes) {
  HWY_DYNAMIC_DISPATCH(grow_from_bounds)(leaves, nodes);
}
void grow_tree(const TableLights& leaves, const TreeNodes& nodes) {
  HWY_DYNAMIC_DISPATCH(grow_from_table)(leaves, nodes);
}

}  // namespace macula::lights
#endif
