#include "server/sampling/sobol.h"

namespace macula::sampling {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  return __builtin_bswap32(x);
}

/// Each bit of the result depends only on the bits at and below its place: on reversed bits that is
/// Owen's tree, where a digit is flipped by the digits before it. Constants: Burley 2020,
/// listing 2.
std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6C50B47CU;
  x ^= x * 0xB82F1E52U;
  x ^= x * 0xC7AFE638U;
  x ^= x * 0x8D22F6E6U;
  return x;
}

/// Second dimension of Sobol's sequence, bits reversed. Its direction numbers are Pascal's triangle
/// mod 2: bit i of the index brings the coefficients of (1 + t)^i, so the whole is the index read
/// as a polynomial over GF(2) and shifted from t to t + 1, one power of two a step.
std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555U;
  index ^= (index >> 2) & 0x33333333U;
  index ^= (index >> 4) & 0x0F0F0F0FU;
  index ^= (index >> 8) & 0x00FF00FFU;
  return index ^ (index >> 16);
}

float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24F;
}

}  // namespace

Vec2 sobol_owen_2d(std::uint32_t index, std::uint32_t seed) {
  const Scrambling scrambling(seed);
  const std::uint32_t shuffled = reverse_bits(laine_karras(reverse_bits(index), scrambling.order));
  // The first dimension is the reversed index, and scrambling works on reversed bits.
  return {unit_float(reverse_bits(laine_karras(shuffled, scrambling.x))),
          unit_float(reverse_bits(laine_karras(sobol_second_reversed(shuffled), scrambling.y)))};
}

}  // namespace macula::sampling
