#include "server/kernels/ray/surface_view.h"

#include <limits>

#include "server/kernels/ray/shading_point.h"
#include "server/visibility/ray_offset.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/kernels/ray/surface_view_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::kernels::ray::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

HWY_ATTR void footprint_vectors(const MeetingRays& rays, const shading::SurfaceBatch& surfaces,
                                std::size_t count, shading::FootprintBatch& out) {
  const Floats d;
  const auto least = hn::Set(d, kLeastSlant);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s direction = load(rays.direction, i);
    const auto cosine = hn::Div(hn::Set(d, 1.0F), hn::Sqrt(dot(direction, direction)));
    const Vec3s to_eye = scaled(hn::Neg(cosine), direction);
    store(to_eye, out.to_eye, i);
    const auto area = hn::Mul(hn::Load(d, rays.sample_area.at + i), cosine);
    const auto width = hn::Mul(hn::Load(d, rays.t.at + i), hn::Sqrt(area));
    hn::Store(width, d, out.width_m.at + i);
    const auto slant = hn::Abs(dot(load(surfaces.geometric, i), to_eye));
    const auto grown = hn::Div(width, hn::Sqrt(hn::Max(slant, least)));
    hn::Store(hn::Mul(hn::Load(d, surfaces.uv_per_meter.at + i), grown), d, out.uv.at + i);
  }
}

HWY_ATTR void origin_vectors(const shading::SurfaceBatch& surfaces,
                             const sampling::Vec3Batch& normal, std::size_t count,
                             sampling::Vec3Batch& out) {
  const Floats d;
  const auto ulps = hn::Set(d, visibility::kPointUlps),
             span_ulps = hn::Set(d, visibility::kSpanUlps);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s point = load(surfaces.position, i);
    const auto largest = hn::Max(hn::Max(hn::Abs(point.x), hn::Abs(point.y)), hn::Abs(point.z));
    const auto span = hn::Mul(span_ulps, hn::Load(d, surfaces.span_m.at + i));
    const auto reach = hn::Max(hn::Max(hn::Mul(ulps, largest), span),
                               hn::Set(d, std::numeric_limits<float>::min()));
    const auto offset = hn::Mul(hn::Set(d, std::numeric_limits<float>::epsilon()), reach);
    store(plus(point, offset, load(normal, i)), out, i);
  }
}

}  // namespace macula::kernels::ray::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::kernels::ray {

HWY_EXPORT(footprint_vectors);
HWY_EXPORT(origin_vectors);

void measure_footprints(const MeetingRays& rays, const shading::SurfaceBatch& surfaces,
                        std::size_t count, shading::FootprintBatch& out) {
  HWY_DYNAMIC_DISPATCH(footprint_vectors)(rays, surfaces, count, out);
}

void offset_origins(const shading::SurfaceBatch& surfaces, const sampling::Vec3Batch& normal,
                    std::size_t count, sampling::Vec3Batch& out) {
  HWY_DYNAMIC_DISPATCH(origin_vectors)(surfaces, normal, count, out);
}

}  // namespace macula::kernels::ray
#endif
