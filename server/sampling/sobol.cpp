#include "server/sampling/sobol.h"

#include "shared/math/hash.h"

namespace macula::sampling {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  x = ((x >> 8) & 0x00FF00FFU) | ((x & 0x00FF00FFU) << 8);
  return (x >> 16) | (x << 16);
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

std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  return reverse_bits(laine_karras(reverse_bits(x), seed));
}

/// Second dimension of Sobol's sequence: its direction numbers are Pascal's triangle mod 2.
std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t direction = 0x80000000U; index != 0; index >>= 1) {
    if ((index & 1U) != 0) result ^= direction;
    direction ^= direction >> 1;
  }
  return result;
}

float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24F;
}

}  // namespace

Vec2 sobol_owen_2d(std::uint32_t index, std::uint32_t seed) {
  const std::uint64_t order_and_x = math::hash_mix(seed);
  const std::uint64_t y = math::hash_mix(order_and_x);
  const std::uint32_t shuffled = owen_scramble(index, static_cast<std::uint32_t>(order_and_x));
  return {unit_float(
              owen_scramble(reverse_bits(shuffled), static_cast<std::uint32_t>(order_and_x >> 32))),
          unit_float(owen_scramble(sobol_second(shuffled), static_cast<std::uint32_t>(y)))};
}

}  // namespace macula::sampling
