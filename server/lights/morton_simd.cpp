// morton_code is the oracle of this.
#include "server/lights/morton_simd.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/morton_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Words = hn::Rebind<std::uint32_t, Doubles>;
using Codes = hn::Rebind<std::uint64_t, Doubles>;
using CodeVec = hn::Vec<Codes>;

/// Points that are taken apart into coordinates at a time.
constexpr std::size_t kPage = 256;
struct alignas(64) Coordinates {
  float x[kPage], y[kPage], z[kPage];
};

/// Two empty places after every bit.
HWY_INLINE HWY_ATTR CodeVec spread(CodeVec x) {
  const auto step = [](CodeVec bits, CodeVec moved, std::uint64_t kept)
                        HWY_ATTR { return hn::And(hn::Or(bits, moved), hn::Set(Codes(), kept)); };
  x = step(x, hn::ShiftLeft<32>(x), 0x001F00000000FFFFULL);
  x = step(x, hn::ShiftLeft<16>(x), 0x001F0000FF0000FFULL);
  x = step(x, hn::ShiftLeft<8>(x), 0x100F00F00F00F00FULL);
  x = step(x, hn::ShiftLeft<4>(x), 0x10C30C30C30C30C3ULL);
  return step(x, hn::ShiftLeft<2>(x), 0x1249249249249249ULL);
}

HWY_INLINE HWY_ATTR CodeVec cells(const float* coordinates, double corner, double cells_per_meter) {
  const Doubles d;
  const auto at =
      hn::Mul(hn::Sub(hn::PromoteTo(d, hn::Load(Floats(), coordinates)), hn::Set(d, corner)),
              hn::Set(d, cells_per_meter));
  constexpr std::int32_t kLast = (1 << kMortonBits) - 1;
  const auto cell = hn::Min(hn::DemoteTo(Ints(), at), hn::Set(Ints(), kLast));
  return hn::PromoteTo(Codes(), hn::BitCast(Words(), cell));
}

HWY_ATTR void code_points(std::span<const Vec3> points, const MortonCube& cube,
                          std::span<std::uint64_t> codes) {
  const Codes d;
  Coordinates page{};
  alignas(64) std::uint64_t made[kPage];
  for (std::size_t first = 0; first < points.size(); first += kPage) {
    const std::size_t count = std::min(kPage, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& point = points[first + i];
      page.x[i] = point.x, page.y[i] = point.y, page.z[i] = point.z;
    }
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
      const auto x = spread(cells(page.x + i, cube.corner.x, cube.cells_per_meter));
      const auto y = spread(cells(page.y + i, cube.corner.y, cube.cells_per_meter));
      const auto z = spread(cells(page.z + i, cube.corner.z, cube.cells_per_meter));
      hn::Store(hn::Or(x, hn::Or(hn::ShiftLeft<1>(y), hn::ShiftLeft<2>(z))), d, made + i);
    }
    std::copy_n(made, count, codes.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(code_points);

void morton_codes(std::span<const Vec3> points, const MortonCube& cube,
                  std::span<std::uint64_t> codes) {
  HWY_DYNAMIC_DISPATCH(code_points)(points, cube, codes);
}

}  // namespace macula::lights
#endif
