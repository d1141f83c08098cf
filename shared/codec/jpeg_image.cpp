#include "shared/codec/jpeg_image.h"

#include <turbojpeg.h>

#include <algorithm>
#include <memory>

#include "shared/base/text.h"

namespace macula::codec {
namespace {

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

Result<image::Plane<Rgb8>> decode_jpeg_image(std::span<const std::byte> bytes,
                                             const std::string& name, int max_side_px) {
  const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
  if (!decoder) return base::runtime_error("cannot start the JPEG decoder", name);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto fail = [&] {
    return base::bad_input(base::concat("not a readable JPEG: ", tjGetErrorStr2(decoder.get())),
                           name, "a baseline or progressive JPEG, grey or colour");
  };
  int width = 0, height = 0, subsampling = 0, colorspace = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling,
                          &colorspace) != 0) {
    return fail();
  }
  if (colorspace == TJCS_CMYK || colorspace == TJCS_YCCK) {
    return base::bad_input("the JPEG is CMYK", name, "convert it to RGB");
  }
  if (width <= 0 || height <= 0 || std::max(width, height) > max_side_px) {
    return base::bad_input(base::concat("the JPEG is ", width, " x ", height, " pixels"), name,
                           base::concat("at most ", max_side_px, " a side"));
  }
  image::Plane<Rgb8> picture(width, height);
  if (tjDecompress2(decoder.get(), data, bytes.size(),
                    reinterpret_cast<unsigned char*>(picture.data()), width, 0, height, TJPF_RGB,
                    TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS) != 0) {
    return fail();
  }
  return picture;
}

}  // namespace macula::codec
