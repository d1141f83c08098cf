#include "shared/codec/packed.h"

#include <zstd.h>

#include <memory>

#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;

constexpr std::size_t kHeaderBytes = 4;
constexpr const char* kPlace = "packed samples";

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, FreeContext>;
using Decompressor = std::unique_ptr<ZSTD_DCtx, FreeContext>;

Compressor make_compressor() {
  Compressor context(ZSTD_createCCtx());
  MACULA_CHECK(context != nullptr, "zstd has no memory for a context");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 1);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  return context;
}

Decompressor make_decompressor() {
  Decompressor context(ZSTD_createDCtx());
  MACULA_CHECK(context != nullptr, "zstd has no memory for a context");
  return context;
}

void write_header(PackedSize size, std::span<std::byte, kHeaderBytes> header) {
  const auto put_u16 = [&](std::size_t at, int value) {
    header[at] = static_cast<std::byte>(value & 0xFF);
    header[at + 1] = static_cast<std::byte>((value >> 8) & 0xFF);
  };
  put_u16(0, size.width);
  put_u16(2, size.height);
}

PackedSize size_of(std::span<const std::byte, kHeaderBytes> header) {
  const auto u16 = [&](std::size_t at) {
    return std::to_integer<int>(header[at]) | (std::to_integer<int>(header[at + 1]) << 8);
  };
  return {u16(0), u16(2)};
}

Result<void> check_claims(std::span<const std::byte> bytes, PackedSize size, std::size_t count) {
  if (bytes.size() < kHeaderBytes)
    return bad_input(concat(bytes.size(), " bytes are too few"), kPlace);
  const PackedSize claimed = size_of(bytes.first<kHeaderBytes>());
  if (claimed.width != size.width || claimed.height != size.height)
    return bad_input(concat("they claim ", claimed.width, " x ", claimed.height), kPlace,
                     concat("expected ", size.width, " x ", size.height));
  const auto frame = bytes.subspan(kHeaderBytes);
  const auto content = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (content == ZSTD_CONTENTSIZE_ERROR || content == ZSTD_CONTENTSIZE_UNKNOWN)
    return bad_input("no zstd frame that states its size", kPlace);
  if (content != count)
    return bad_input(concat("they unpack to ", content, " bytes"), kPlace,
                     concat("expected ", count));
  return {};
}

}  // namespace

std::vector<std::byte> pack(PackedSize size, std::span<const std::uint8_t> samples) {
  static thread_local const Compressor compressor = make_compressor();
  static thread_local Scratch<std::byte> memory;
  MACULA_CHECK(size.width >= 0 && size.width <= kMaxPackedSide && size.height >= 0 &&
               size.height <= kMaxPackedSide);
  const auto packed = memory.take(kHeaderBytes + ZSTD_compressBound(samples.size()));
  write_header(size, packed.first<kHeaderBytes>());
  const auto frame = packed.subspan(kHeaderBytes);
  const auto written =
      ZSTD_compress2(compressor.get(), frame.data(), frame.size(), samples.data(), samples.size());
  MACULA_CHECK(!ZSTD_isError(written), ZSTD_getErrorName(written));
  return {packed.data(), packed.data() + kHeaderBytes + written};
}

std::optional<PackedSize> packed_size(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes) return std::nullopt;
  return size_of(bytes.first<kHeaderBytes>());
}

Result<std::span<const std::uint8_t>> unpack(std::span<const std::byte> bytes, PackedSize size,
                                             std::size_t count, Scratch<std::uint8_t>& memory) {
  static thread_local const Decompressor decompressor = make_decompressor();
  if (auto ok = check_claims(bytes, size, count); !ok) return base::forward(ok);
  const auto frame = bytes.subspan(kHeaderBytes);
  const auto samples = memory.take(count);
  const auto unpacked = ZSTD_decompressDCtx(decompressor.get(), samples.data(), samples.size(),
                                            frame.data(), frame.size());
  if (ZSTD_isError(unpacked)) return bad_input(ZSTD_getErrorName(unpacked), kPlace);
  if (unpacked != count)
    return bad_input(concat("only ", unpacked, " of ", count, " bytes came out"), kPlace);
  return samples;
}

}  // namespace macula::codec
