#include "shared/codec/jpeg.h"

#include <turbojpeg.h>

#include <memory>

#include "shared/base/text.h"
#include "shared/codec/scratch.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;
using base::runtime_error;

constexpr const char* kPlace = "JPEG";

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Destroy>;

Handle checked(tjhandle handle) {
  MACULA_CHECK(handle != nullptr, "libjpeg-turbo has no memory for a handle");
  return Handle(handle);
}

int subsampling(Chroma chroma) {
  return chroma == Chroma::Full ? TJSAMP_444 : TJSAMP_420;
}

const unsigned char* as_chars(const std::byte* bytes) {
  return reinterpret_cast<const unsigned char*>(bytes);
}

/// libjpeg-turbo's bytes between two rows of a plane.
int pitch_of(const image::Plane<Rgb8>& picture) {
  return picture.width() * static_cast<int>(sizeof(Rgb8));
}

/// Compares what the header says with what is expected, before pixels are touched.
Result<void> check_header(tjhandle handle, std::span<const std::byte> bytes,
                          const image::Rect& rect) {
  int width = 0, height = 0, samples = 0, color_space = 0;
  if (tjDecompressHeader3(handle, as_chars(bytes.data()), bytes.size(), &width, &height, &samples,
                          &color_space) != 0)
    return bad_input(tjGetErrorStr2(handle), kPlace);
  if (width != rect.width || height != rect.height)
    return bad_input(concat("it claims ", width, " x ", height, " px"), kPlace,
                     concat("expected ", rect.width, " x ", rect.height));
  if (color_space != TJCS_YCbCr || (samples != TJSAMP_444 && samples != TJSAMP_420))
    return bad_input("an unknown colour layout", kPlace, "YCbCr 4:4:4 or 4:2:0");
  return {};
}

}  // namespace

Result<Bytes> encode_jpeg(const image::Plane<Rgb8>& picture, const image::Rect& rect, int quality,
                          Chroma chroma) {
  static thread_local const Handle compressor = checked(tjInitCompress());
  static thread_local Scratch<unsigned char> memory;
  const auto bound = tjBufSize(rect.width, rect.height, subsampling(chroma));
  if (bound == static_cast<unsigned long>(-1))
    return bad_input(concat(rect.width, " x ", rect.height, " px do not fit"), kPlace);
  unsigned char* buffer = memory.take(bound).data();
  unsigned long size = bound;
  const auto* first = &picture.row(rect.y)[static_cast<std::size_t>(rect.x)].r;
  if (tjCompress2(compressor.get(), first, rect.width, pitch_of(picture), rect.height, TJPF_RGB,
                  &buffer, &size, subsampling(chroma), quality, TJFLAG_NOREALLOC) != 0)
    return runtime_error(tjGetErrorStr2(compressor.get()), kPlace);
  const auto* written = reinterpret_cast<const std::byte*>(buffer);
  return Bytes(written, written + size);
}

Result<void> decode_jpeg(std::span<const std::byte> bytes, const image::Rect& rect,
                         image::Plane<Rgb8>& picture) {
  static thread_local const Handle decompressor = checked(tjInitDecompress());
  if (auto ok = check_header(decompressor.get(), bytes, rect); !ok) return ok;
  auto* first = &picture.row(rect.y)[static_cast<std::size_t>(rect.x)].r;
  if (tjDecompress2(decompressor.get(), as_chars(bytes.data()), bytes.size(), first, rect.width,
                    pitch_of(picture), rect.height, TJPF_RGB,
                    TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS) != 0)
    return bad_input(tjGetErrorStr2(decompressor.get()), kPlace);
  return {};
}

}  // namespace macula::codec
