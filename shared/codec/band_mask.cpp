#include "shared/codec/band_mask.h"

#include "shared/codec/packed.h"

namespace macula::codec {
namespace {

std::size_t row_bytes(const Mask& mask) {
  return (static_cast<std::size_t>(mask.width()) + 7) / 8;
}

}  // namespace

std::vector<std::byte> encode_mask(const Mask& mask) {
  static thread_local Scratch<std::uint8_t> memory;
  const std::size_t stride = row_bytes(mask);
  const auto bits = memory.take(stride * static_cast<std::size_t>(mask.height()));
  for (int y = mask.height() - 1; y >= 0; --y) {
    const auto row = mask.row(y), above = mask.row(y > 0 ? y - 1 : 0);
    std::uint8_t* const out = bits.data() + stride * static_cast<std::size_t>(y);
    for (std::size_t i = 0; i < stride; ++i) {
      unsigned byte = 0;
      for (std::size_t bit = 0; bit < 8 && 8 * i + bit < row.size(); ++bit) {
        const unsigned before = y > 0 ? above[8 * i + bit] : 0U;
        byte |= (row[8 * i + bit] ^ before) << bit;
      }
      out[i] = static_cast<std::uint8_t>(byte);
    }
  }
  return pack({mask.width(), mask.height()}, bits);
}

Result<void> decode_mask(std::span<const std::byte> bytes, Mask& mask) {
  static thread_local Scratch<std::uint8_t> memory;
  const std::size_t stride = row_bytes(mask);
  const auto bits = unpack(bytes, {mask.width(), mask.height()},
                           stride * static_cast<std::size_t>(mask.height()), memory);
  if (!bits) return base::forward(bits);
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    const std::uint8_t* const in = bits->data() + stride * static_cast<std::size_t>(y);
    for (std::size_t x = 0; x < row.size(); ++x) {
      const auto bit = static_cast<std::uint8_t>(in[x / 8] >> (x % 8) & 1U);
      row[x] = y > 0 ? mask.row(y - 1)[x] ^ bit : bit;
    }
  }
  return {};
}

}  // namespace macula::codec
