// Colour slices as a client decodes them: the first byte chooses the codec.
#include "shared/codec/color.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr int kSide = 24;
constexpr image::Rect kRect{0, 0, kSide, kSide};

codec::ColorCodec codec_of(std::uint8_t first) {
  return first % 2 == 0 ? codec::ColorCodec::Jpeg : codec::ColorCodec::Lossless;
}

}  // namespace

void try_input(Input input) {
  if (input.empty()) return;
  image::Plane<Rgb8> picture(kSide, kSide);
  (void)codec::decode_color(as_bytes(input.subspan(1)), codec_of(input[0]), kRect, picture);
}

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  image::Plane<Rgb8> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(10 * x), static_cast<std::uint8_t>(x * y),
                       static_cast<std::uint8_t>(7 * y)};
  for (int i = 0; i < 6; ++i) {
    codec::ColorOptions options;
    options.codec = codec_of(static_cast<std::uint8_t>(i));
    options.jpeg_quality = 10 + 15 * i;
    options.chroma = i < 3 ? codec::Chroma::Half : codec::Chroma::Full;
    const auto encoded = codec::encode_color(picture, kRect, options);
    require(encoded.has_value(), "a seed cannot be encoded");
    seeds.emplace_back(1, static_cast<char>(i));
    seeds.back().append(reinterpret_cast<const char*>(encoded->data()), encoded->size());
  }
  return seeds;
}

}  // namespace macula::fuzz
