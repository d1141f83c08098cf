// H.264 colour as a client decodes it: a key frame, then frames that lean on it, each with two
// bytes of length before it. A build without H.264 has nothing to try.
#include "shared/codec/h264.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr int kSide = 40;
constexpr image::Rect kRect{0, 0, kSide, kSide};

image::Plane<Rgb8> picture_of(int frame) {
  image::Plane<Rgb8> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(6 * (x + frame)), static_cast<std::uint8_t>(x * y),
                       static_cast<std::uint8_t>(5 * y)};
  return picture;
}

}  // namespace

void try_input(Input input) {
  auto decoder = codec::H264Decoder::create();
  if (!decoder) return;
  image::Plane<Rgb8> picture(kSide, kSide);
  while (input.size() >= 2) {
    const std::size_t wanted = input[0] | input[1] << 8U;
    const std::size_t size = std::min(wanted, input.size() - 2);
    (void)(*decoder)->decode(as_bytes(input.subspan(2, size)), kRect, picture);
    input = input.subspan(2 + size);
  }
}

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (const double quantiser : {10.0, 25.0, 40.0}) {
    auto encoder = codec::H264Encoder::create({});
    if (!encoder) return {std::string(4, '\0')};
    seeds.emplace_back();
    for (int frame = 0; frame < 3; ++frame) {
      const auto coded = (*encoder)->encode(picture_of(frame), {.quantiser = quantiser});
      require(coded.has_value(), "a seed cannot be encoded");
      const std::size_t size = coded->bytes.size();
      seeds.back().push_back(static_cast<char>(size & 0xFFU));
      seeds.back().push_back(static_cast<char>(size >> 8U));
      seeds.back().append(reinterpret_cast<const char*>(coded->bytes.data()), size);
    }
  }
  return seeds;
}

}  // namespace macula::fuzz
