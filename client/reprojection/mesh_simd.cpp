// MeshProjector::project (mesh.cpp) is the oracle: the same operations in the same order.
#include <limits>

#include "client/reprojection/mesh.h"
#include "client/reprojection/mesh_rules.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/mesh_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using F = hn::Vec<Floats>;

HWY_INLINE HWY_ATTR F set(float value) {
  return hn::Set(Floats(), value);
}

/// sound_inverse_depth.
HWY_INLINE HWY_ATTR F sound(F value) {
  const auto usable =
      hn::And(hn::Gt(value, set(0.0F)), hn::Lt(value, set(std::numeric_limits<float>::infinity())));
  return hn::IfThenElseZero(usable, hn::Min(value, set(kNearest_per_m)));
}

/// A vertex a lane.
struct Vertices {
  F x, y, inverse_depth, nearness;
};
/// `upto_y`: from_forward + y_tangent * from_y.
HWY_INLINE HWY_ATTR Vertices project(const Projection& p, const F* upto_y, F x_tangent, F inverse) {
  const auto along = [&](int axis) HWY_ATTR {
    return hn::Add(hn::Add(upto_y[axis], hn::Mul(x_tangent, set(p.from_x[axis]))),
                   hn::Mul(inverse, set(p.offset_m[axis])));
  };
  const F x = along(0), y = along(1), forward = hn::Neg(along(2));
  const auto seen =
      hn::And(hn::Gt(forward, set(kLeastForward)), hn::Gt(forward, hn::Mul(set(kNear_m), inverse)));
  const F scale = hn::Div(set(1.0F), forward);
  const auto pixel = [&](F direction, int axis) HWY_ATTR {
    const F place = hn::Add(hn::Mul(hn::Mul(direction, scale), set(p.pixels_per_tangent[axis])),
                            set(p.first_pixel[axis]));
    return hn::IfThenElse(seen, place, set(std::numeric_limits<float>::quiet_NaN()));
  };
  return {pixel(x, 0), pixel(hn::Neg(y), 1), hn::Mul(inverse, scale), scale};
}

HWY_ATTR void load_depths(const DepthRows& depths, Patch& patch) {
  const Floats d;
  for (int row = 0; row <= patch.rows; ++row) {
    const float* const from = depths[static_cast<std::size_t>(row)];
    float* const to = patch.source_inverse.data() + Patch::at(0, row);
    for (int column = 0; column <= patch.columns; column += static_cast<int>(hn::Lanes(d))) {
      hn::Store(sound(hn::LoadU(d, from + column)), d, to + column);
    }
  }
}

HWY_ATTR void project_patch(const Projection& p, Patch& patch) {
  const Floats d;
  for (int row = 0; row <= patch.rows; ++row) {
    const Vec3 base = p.from_forward + patch.y_tangents[static_cast<std::size_t>(row)] * p.from_y;
    const F upto_y[3] = {set(base.x), set(base.y), set(base.z)};
    for (int column = 0; column <= patch.columns; column += static_cast<int>(hn::Lanes(d))) {
      const std::size_t at = Patch::at(column, row);
      const F inverse = hn::Load(d, patch.source_inverse.data() + at);
      const F tangent = hn::LoadU(d, patch.x_tangents.data() + column);
      const Vertices seen = project(p, upto_y, tangent, inverse);
      hn::Store(seen.x, d, patch.x.data() + at);
      hn::Store(seen.y, d, patch.y.data() + at);
      hn::Store(seen.inverse_depth, d, patch.inverse_depth.data() + at);
      hn::Store(seen.nearness, d, patch.nearness.data() + at);
    }
  }
}

HWY_ATTR void project_points(const Projection& p, Points& points) {
  const Floats d;
  for (int i = 0; i < Points::kCount; i += static_cast<int>(hn::Lanes(d))) {
    const F y_tangent = hn::Load(d, points.y_tangent + i);
    const auto upto_y = [&](int axis) HWY_ATTR {
      return hn::Add(set(p.from_forward[axis]), hn::Mul(y_tangent, set(p.from_y[axis])));
    };
    const F bases[3] = {upto_y(0), upto_y(1), upto_y(2)};
    const Vertices seen = project(p, bases, hn::Load(d, points.x_tangent + i),
                                  hn::Load(d, points.source_inverse + i));
    hn::Store(seen.x, d, points.x + i);
    hn::Store(seen.y, d, points.y + i);
    hn::Store(seen.inverse_depth, d, points.inverse_depth + i);
    hn::Store(seen.nearness, d, points.nearness + i);
  }
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {

HWY_EXPORT(load_depths);
HWY_EXPORT(project_patch);
HWY_EXPORT(project_points);

void load_depths(const DepthRows& depths, Patch& patch) {
  HWY_DYNAMIC_DISPATCH(load_depths)(depths, patch);
}
void project_patch(const Projection& projection, Patch& patch) {
  HWY_DYNAMIC_DISPATCH(project_patch)(projection, patch);
}
void project_points(const Projection& projection, Points& points) {
  HWY_DYNAMIC_DISPATCH(project_points)(projection, points);
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
