#include "server/sdf/march.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/sdf/march_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sdf/marks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

/// How much of a new slope counts (Ban and Valasek 2023).
constexpr float kSlopeShare = 0.3F;
/// What a slope that led too far becomes: as careful as none, but the next counts by its share.
constexpr float kSlopeAfterReturn = -0.999F;
/// A cone stops where the free ball no longer covers it by this factor (measured there: best of
/// 1.02 to 4).
constexpr float kConeStop = 1.02F;
/// Roundings of a position along a ray, relative to it; much less than kFieldRounding.
constexpr float kRounding = 5e-7F;
HWY_INLINE HWY_ATTR IntVec state_vector(LaneState state) {
  return hn::Set(Ints(), static_cast<std::int32_t>(state));
}

HWY_INLINE HWY_ATTR void write_positions(const Chunk& chunk, std::size_t i, PointBatch& out) {
  const Floats d;
  const auto at = hn::Load(d, chunk.at + i);
  hn::Store(hn::Mul(at, hn::Load(d, chunk.x + i)), d, out.x + i);
  hn::Store(hn::Mul(at, hn::Load(d, chunk.y + i)), d, out.y + i);
  hn::Store(hn::Mul(at, hn::Load(d, chunk.z + i)), d, out.z + i);
}

HWY_ATTR void positions_vectors(const Chunk& chunk, std::size_t count, PointBatch& out) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) write_positions(chunk, i, out);
}

HWY_ATTR void direction_vectors(const float* tangent_x, const float* tangent_y, std::size_t count,
                                const Mat3& m, const DirectionPlanes& out) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto u = hn::Load(d, tangent_x + i), v = hn::Load(d, tangent_y + i);
    const auto square = hn::MulAdd(u, u, hn::MulAdd(v, v, set(1.0F)));
    const auto inverse = hn::Div(set(1.0F), hn::Sqrt(square));
    // m (u, -v, -1), columns of m; frames.h: the tangent's y points down.
    const auto axis = [&](int row) HWY_ATTR {
      const auto sum =
          hn::NegMulAdd(set(m[1][row]), v, hn::Sub(hn::Mul(set(m[0][row]), u), set(m[2][row])));
      return hn::Mul(sum, inverse);
    };
    hn::Store(axis(0), d, out.x + i);
    hn::Store(axis(1), d, out.y + i);
    hn::Store(axis(2), d, out.z + i);
  }
}

/// One vector of lanes while it is moved.
struct Moving {
  Chunk& chunk;
  std::size_t i;
  FloatVec found, at;
  IntVec state;
  FloatMask live;

  HWY_INLINE HWY_ATTR Moving(Chunk& all, std::size_t first, const DistanceBatch& distances)
      : chunk(all),
        i(first),
        found(hn::Load(Floats(), distances.at + first)),
        at(hn::Load(Floats(), all.at + first)),
        state(hn::Load(Ints(), all.state + first)),
        live(hn::RebindMask(Floats(), hn::Eq(state, state_vector(LaneState::Live)))) {
    const auto broken = hn::And(live, hn::Not(hn::Eq(found, found)));
    end(broken, LaneState::Broken);
    const auto steps = hn::Load(Ints(), all.steps + first);
    const auto one = hn::IfThenElseZero(hn::RebindMask(Ints(), live), hn::Set(Ints(), 1));
    hn::Store(hn::Add(steps, one), Ints(), all.steps + first);
  }
  /// Lanes of the mask that are live end in this state.
  HWY_INLINE HWY_ATTR void end(FloatMask mask, LaneState with) {
    const auto ends = hn::And(mask, live);
    state = hn::IfThenElse(hn::RebindMask(Ints(), ends), state_vector(with), state);
    live = hn::AndNot(ends, live);
  }
  HWY_INLINE HWY_ATTR std::size_t finish(FloatVec next, const MarchLimits& limits,
                                         PointBatch& points) {
    const Ints di;
    at = hn::IfThenElse(live, next, at);
    const auto steps = hn::Load(di, chunk.steps + i);
    end(hn::RebindMask(Floats(), hn::Gt(steps, hn::Set(di, limits.max_steps - 1))),
        LaneState::Capped);
    end(hn::Or(hn::Lt(at, set(limits.slab_low)), hn::Ge(at, set(limits.slab_high))),
        LaneState::Left);
    hn::Store(at, Floats(), chunk.at + i);
    hn::Store(state, di, chunk.state + i);
    write_positions(chunk, i, points);
    return hn::CountTrue(Floats(), live);
  }
};

/// How much farther than `at` no mark is near, nor how much before it, when `found` is the distance
/// there: at s the field is at least found - |s - at| and near below width s + hit_m.
HWY_INLINE HWY_ATTR FloatVec clear_way(FloatVec at, FloatVec found, FloatVec width,
                                       const MarchLimits& limits) {
  const auto per_meter = hn::Add(width, set(kFieldRounding));
  const auto kept = hn::MulSub(found, hn::Sub(set(1.0F), per_meter), set(limits.hit_m));
  return hn::NegMulAdd(per_meter, at, kept);
}

/// Where a ray asks next that has nothing near up to `clear`: at the first mark beyond, or farther.
struct Onward {
  FloatVec mark, next;

  HWY_INLINE HWY_ATTR Onward(FloatVec clear, FloatVec forward, FloatVec width,
                             const MarchLimits& limits)
      : mark(next_mark(clear, mark_spacing(clear, width, set(limits.hit_m)))),
        next(hn::Max(mark, forward)) {}
};

HWY_ATTR std::size_t advance_plain(Chunk& chunk, std::size_t count, const DistanceBatch& found,
                                   const MarchLimits& limits, PointBatch& points) {
  const Floats d;
  std::size_t live = 0;
  const auto zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    Moving lanes(chunk, i, found);
    const auto moved = lanes.live;
    const auto at = lanes.at, width = hn::Load(d, chunk.width + i);
    const auto radius = hn::Max(clear_way(at, lanes.found, width, limits), zero);
    lanes.end(hn::And(hn::Eq(at, zero), hn::Le(lanes.found, zero)), LaneState::Inside);
    lanes.end(hn::Lt(lanes.found, hn::MulAdd(width, at, set(limits.hit_m))), LaneState::Hit);
    const auto clear = hn::Add(at, radius);
    lanes.end(hn::Ge(clear, set(limits.far_m)), LaneState::Miss);
    const auto before = hn::Load(d, chunk.radius + i);
    hn::Store(hn::IfThenElse(moved, lanes.found, before), d, chunk.radius + i);
    live += lanes.finish(Onward(clear, clear, width, limits).next, limits, points);
  }
  return live;
}

// No mark up to t + radius is near, and `at` may lie beyond that. If the clear ways about t and
// `at` do not touch, something could lie between the two: then the step is taken back. At the first
// mark beyond what is clear there is nothing between; if that mark is near, it is the first.
HWY_ATTR std::size_t advance_relaxed(Chunk& chunk, std::size_t count, const DistanceBatch& found,
                                     const MarchLimits& limits, PointBatch& points) {
  const Floats d;
  std::size_t live = 0;
  const auto zero = hn::Zero(d), one = set(1.0F), minus_one = set(-1.0F), far = set(limits.far_m);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    Moving lanes(chunk, i, found);
    const auto moved = lanes.live;  // the others wait with what they know
    const auto t = hn::Load(d, chunk.t + i), radius = hn::Load(d, chunk.radius + i);
    const auto slope = hn::Load(d, chunk.slope + i), width = hn::Load(d, chunk.width + i);
    const auto first = hn::Load(d, chunk.first + i), at = lanes.at, step = hn::Sub(at, t);
    const auto way = clear_way(at, lanes.found, width, limits), r = hn::Max(way, zero);
    const auto is_first = hn::Eq(at, first);
    const auto touch = hn::MulAdd(set(kRounding), at, hn::Add(radius, r));
    const auto apart = hn::AndNot(is_first, hn::Gt(step, touch));
    lanes.end(hn::And(hn::Eq(at, zero), hn::Le(lanes.found, zero)), LaneState::Inside);
    const auto near = hn::Lt(lanes.found, hn::MulAdd(width, at, set(limits.hit_m)));
    const auto hits = hn::And(hn::And(is_first, near), lanes.live);
    lanes.end(hits, LaneState::Hit);
    const auto reach = hn::IfThenElse(apart, radius, hn::Max(r, hn::Sub(radius, step)));
    const auto from = hn::IfThenElse(apart, t, at), clear = hn::Add(from, reach);
    lanes.end(hn::Ge(clear, far), LaneState::Miss);
    // Where the slope along the ray is m, balls of radius r and r + m z touch for z = 2 r / (1 -
    // m).
    const auto seen = hn::Div(hn::Sub(way, radius), step);
    // The first slope seen counts whole: there is nothing to blend it with.
    const auto share = hn::IfThenElse(hn::Gt(slope, minus_one), set(kSlopeShare), one);
    auto slope_now = hn::MulAdd(share, hn::Sub(seen, slope), slope);
    slope_now = hn::IfThenElse(hn::Gt(step, zero), slope_now, minus_one);
    const auto stretch = hn::Div(set(2.0F), hn::Max(hn::Sub(one, slope_now), set(0.25F)));
    const auto forward = hn::MulAdd(r, hn::Max(stretch, one), at);
    const Onward then(clear, hn::IfThenElse(apart, clear, hn::Min(forward, far)), width, limits);
    slope_now = hn::IfThenElse(apart, set(kSlopeAfterReturn), slope_now);
    hn::Store(hn::IfThenElse(moved, slope_now, slope), d, chunk.slope + i);
    hn::Store(hn::IfThenElse(moved, from, t), d, chunk.t + i);
    const auto kept = hn::IfThenElse(hits, lanes.found, reach);
    hn::Store(hn::IfThenElse(moved, kept, radius), d, chunk.radius + i);
    hn::Store(hn::IfThenElse(moved, then.mark, first), d, chunk.first + i);
    live += lanes.finish(then.next, limits, points);
  }
  return live;
}

// Section 5.3 of the method: with h = sin(th / 2) the step is sqrt(d^2 - t^2 sin^2 th) - 2 t h^2.
HWY_ATTR std::size_t advance_cones(Chunk& chunk, std::size_t count, const DistanceBatch& found,
                                   const MarchLimits& limits, PointBatch& points) {
  const Floats d;
  std::size_t live = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    Moving lanes(chunk, i, found);
    // Beyond the end of the world nothing matters, and infinities would not survive below.
    const auto at = lanes.at, found_here = hn::Min(lanes.found, set(2.0F * limits.far_m));
    const auto r = clear_way(at, found_here, set(limits.hit_width), limits);
    const auto sine = hn::Load(d, chunk.width + i), half = hn::Load(d, chunk.half + i);
    const auto chord = hn::Mul(hn::Mul(set(2.0F), at), half);
    lanes.end(hn::Not(hn::Gt(r, hn::Mul(set(kConeStop), chord))), LaneState::Stopped);
    const auto across = hn::Mul(at, sine);
    const auto along = hn::Sqrt(hn::Max(hn::NegMulAdd(across, across, hn::Mul(r, r)), hn::Zero(d)));
    const auto step = hn::NegMulAdd(chord, half, along);
    // Rounded down, so that what lies before `next` is free for certain.
    const auto next = hn::NegMulAdd(set(kRounding), hn::Add(at, r), hn::Add(at, step));
    lanes.end(hn::Le(next, at), LaneState::Stopped);
    lanes.end(hn::Ge(next, set(limits.far_m)), LaneState::Miss);
    live += lanes.finish(next, limits, points);
  }
  return live;
}

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::sdf {

HWY_EXPORT(positions_vectors);
HWY_EXPORT(direction_vectors);
HWY_EXPORT(advance_plain);
HWY_EXPORT(advance_relaxed);
HWY_EXPORT(advance_cones);

void positions(const Chunk& chunk, std::size_t count, PointBatch& out) {
  HWY_DYNAMIC_DISPATCH(positions_vectors)(chunk, count, out);
}

void directions(const float* tangent_x, const float* tangent_y, std::size_t count,
                const Mat3& scene_from_view, const DirectionPlanes& out) {
  HWY_DYNAMIC_DISPATCH(direction_vectors)(tangent_x, tangent_y, count, scene_from_view, out);
}

std::size_t advance(Stepping stepping, Chunk& chunk, std::size_t count, const DistanceBatch& found,
                    const MarchLimits& limits, PointBatch& next) {
  // Entries behind the last lane of its vector belong to nobody.
  for (std::size_t i = count; i % 16 != 0; ++i)
    chunk.state[i] = static_cast<std::int32_t>(LaneState::Left);
  switch (stepping) {
    case Stepping::Plain:
      return HWY_DYNAMIC_DISPATCH(advance_plain)(chunk, count, found, limits, next);
    case Stepping::Relaxed:
      return HWY_DYNAMIC_DISPATCH(advance_relaxed)(chunk, count, found, limits, next);
    case Stepping::Cone:
      return HWY_DYNAMIC_DISPATCH(advance_cones)(chunk, count, found, limits, next);
  }
  return 0;
}

}  // namespace macula::sdf
#endif
