// Colours of four bytes as three, for this room's *_simd.cpp: to be included below hwy/highway.h,
// once for every target.
#if defined(MACULA_CLIENT_REPROJECTION_PACKED_COLORS_SIMD_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_CLIENT_REPROJECTION_PACKED_COLORS_SIMD_H
#undef MACULA_CLIENT_REPROJECTION_PACKED_COLORS_SIMD_H
#else
#define MACULA_CLIENT_REPROJECTION_PACKED_COLORS_SIMD_H
#endif

#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::Full128<std::uint8_t>;

/// Writes `count` colours, a multiple of four, red in the lowest byte of each; four bytes beyond
/// the last are written too. `colors` is aligned to 16 bytes.
HWY_INLINE HWY_ATTR void pack(const std::uint32_t* colors, int count, std::uint8_t* out) {
  const Bytes d8;
  alignas(16) static constexpr std::uint8_t kOrder[16] = {0,  1,  2,  4,  5,   6,   8,   9,
                                                          10, 12, 13, 14, 128, 128, 128, 128};
  const auto order = hn::Load(d8, kOrder);
  for (int i = 0; i < count; i += 4) {
    const auto four = hn::Load(d8, reinterpret_cast<const std::uint8_t*>(colors + i));
    hn::StoreU(hn::TableLookupBytesOr0(four, order), d8, out + 3 * i);
  }
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // one target's copy
