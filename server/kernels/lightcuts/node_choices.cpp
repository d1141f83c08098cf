#include "server/kernels/lightcuts/node_choices.h"

#include <algorithm>

namespace macula::kernels::lightcuts {
namespace {

/// 1 for points of one plane; small for normals 25 degrees apart, and for planes apart by a third
/// of the distance.
float alike(const lights::Receiver& a, const lights::Receiver& b) {
  constexpr float kLeastDistance_m = 1e-6F;  // a point is of its own plane
  const float facing = std::max(glm::dot(a.normal, b.normal), 0.0F);
  const Vec3 between = b.position - a.position;
  const float apart =
      std::abs(glm::dot(a.normal, between)) / (glm::length(between) + kLeastDistance_m);
  const float square = facing * facing, fourth = square * square;
  return fourth * fourth * std::exp(-8.0F * apart * apart);
}

}  // namespace

LowNeighbours::LowNeighbours(const LowPicture& low, const image::Pixel& cell,
                             const lights::Receiver& receiver) {
  const auto place = [&](int at) {
    return (static_cast<float>(at) + 0.5F) / static_cast<float>(low.factor) - 0.5F;
  };
  const Vec2 here{place(cell.x), place(cell.y)};
  const int x = static_cast<int>(std::floor(here.x)), y = static_cast<int>(std::floor(here.y));
  for (int k = 0; k < 4; ++k) add(low, here, {x + k % 2, y + k / 2}, receiver);
}

void LowNeighbours::add(const LowPicture& low, const Vec2& place, const image::Pixel& pixel,
                        const lights::Receiver& receiver) {
  const float wx = 1.0F - std::abs(place.x - static_cast<float>(pixel.x));
  const float wy = 1.0F - std::abs(place.y - static_cast<float>(pixel.y));
  const int x = std::clamp(pixel.x, 0, low.width - 1), y = std::clamp(pixel.y, 0, low.height - 1);
  const auto index = static_cast<std::size_t>(y * low.width + x);
  const int k = count_++;
  pixel_[k] = &low.pixels[index];
  weight_[k] = low.hit[index] ? wx * wy * alike(pixel_[k]->receiver(), receiver) : 0.0F;
  sum_ += weight_[k];
}

bool LowNeighbours::any() const {
  constexpr float kLeastAlike = 0.05F;
  return sum_ >= kLeastAlike;
}

const LowSamples& LowNeighbours::choose(float u) const {
  float rest = u * sum_;
  int last = 0;
  for (int k = 0; k < count_; ++k) {
    if (!(weight_[k] > 0.0F)) continue;
    last = k;
    if (rest < weight_[k]) break;
    rest -= weight_[k];
  }
  return *pixel_[last];
}

}  // namespace macula::kernels::lightcuts
