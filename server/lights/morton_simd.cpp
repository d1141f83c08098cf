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

HWY_INLINE HWY_ATTR CodeVec cells(hn::Vec<Floats> coordinates, double corner,
                                  double cells_per_meter) {
  const Doubles d;
  const auto at = hn::Mul(hn::Sub(hn::PromoteTo(d, coordinates), hn::Set(d, corner)),
                          hn::Set(d, cells_per_meter));
  constexpr std::int32_t kLast = (1 << kMortonBits) - 1;
  const auto cell = hn::Min(hn::DemoteTo(Ints(), at), hn::Set(Ints(), kLast));
  return hn::PromoteTo(Codes(), hn::BitCast(Words(), cell));
}

HWY_ATTR void make_keys(std::span<const Vec4> points, const MortonCube& cube,
                        std::span<std::uint64_t> keys) {
  const Codes d;
  const std::size_t lanes = hn::Lanes(d);
  const auto make = [&](const Vec4* from, std::size_t first, std::uint64_t* to) HWY_ATTR {
    hn::Vec<Floats> x, y, z, other;
    hn::LoadInterleaved4(Floats(), &from->x, x, y, z, other);
    const auto cx = spread(cells(x, cube.corner.x, cube.cells_per_meter));
    const auto cy = spread(cells(y, cube.corner.y, cube.cells_per_meter));
    const auto cz = spread(cells(z, cube.corner.z, cube.cells_per_meter));
    const auto code = hn::Or(cx, hn::Or(hn::ShiftLeft<1>(cy), hn::ShiftLeft<2>(cz)));
    const auto upper = hn::ShiftLeft<32>(hn::ShiftRight<kLowerBits>(code));
    hn::StoreU(hn::Or(upper, hn::Iota(d, first)), d, to);
  };
  std::size_t i = 0;
  for (; i + lanes <= points.size(); i += lanes) make(points.data() + i, i, keys.data() + i);
  // The last ones, fewer than a vector.
  Vec4 rest[hn::MaxLanes(Codes())];
  std::uint64_t made[hn::MaxLanes(Codes())];
  std::ranges::fill(rest, Vec4(Vec3(cube.corner), 0.0F));
  std::ranges::copy(points.subspan(i), rest);
  make(rest, i, made);
  std::copy_n(made, points.size() - i, keys.data() + i);
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(make_keys);

void morton_keys(std::span<const Vec4> points, const MortonCube& cube,
                 std::span<std::uint64_t> keys) {
  HWY_DYNAMIC_DISPATCH(make_keys)(points, cube, keys);
}

}  // namespace macula::lights
#endif
