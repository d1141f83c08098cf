// Depth slices as a client decodes them.
#include <cmath>

#include "shared/codec/depth.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {
constexpr int kWidth = 37, kHeight = 21;
}

void try_input(Input input) {
  image::Plane<float> inverse_depth(kWidth, kHeight);
  if (!codec::decode_depth(as_bytes(input), 2.0F, inverse_depth)) return;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      require(std::isfinite(inverse_depth(x, y)) && inverse_depth(x, y) >= 0.0F,
              "a decoded depth is not a depth");
}

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (int i = 0; i < 6; ++i) {
    image::Plane<float> depth(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        depth(x, y) = 0.5F + static_cast<float>((x * (i + 1)) % 17) +
                      (i > 2 ? 0.01F * static_cast<float>(y * x % 31) : 0.0F);
    const auto encoded = codec::encode_depth(depth);
    require(encoded.has_value(), "a seed cannot be encoded");
    seeds.emplace_back(reinterpret_cast<const char*>(encoded->bytes.data()), encoded->bytes.size());
  }
  return seeds;
}

}  // namespace macula::fuzz
