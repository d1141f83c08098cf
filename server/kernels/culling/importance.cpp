#include "server/kernels/culling/importance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/base/check.h"
#include "shared/image/tone.h"

namespace macula::kernels::culling {
namespace {

Rgb encoded(const Rgb& linear) {
  const Rgb in_range = glm::clamp(linear, Rgb{0.0F}, Rgb{1.0F});
  return {image::srgb_from_linear(in_range.x), image::srgb_from_linear(in_range.y),
          image::srgb_from_linear(in_range.z)};
}

class Silhouettes {
 public:
  Silhouettes(const ImportanceInputs& in, const ImportanceConfig& config)
      : in_(in),
        config_(config),
        least_cosine_(static_cast<float>(std::cos(Radians{config.normal_edge}.value()))) {}

  bool at(int x, int y) const {
    constexpr std::array<image::Pixel, 4> kNeighbours{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
    return off_the_plane(x, y, 1, 0) || off_the_plane(x, y, 0, 1) ||
           std::ranges::any_of(kNeighbours, [&](const image::Pixel& to) {
             return in_.depth_m.contains(x + to.x, y + to.y) && differs(x, y, x + to.x, y + to.y);
           });
  }

 private:
  bool differs(int x, int y, int nx, int ny) const {
    if (!std::isfinite(in_.depth_m(nx, ny))) return true;
    return glm::dot(in_.normal(x, y), in_.normal(nx, ny)) < least_cosine_ ||
           color_distance(in_.albedo(x, y), in_.albedo(nx, ny)) > config_.color_edge;
  }
  bool off_the_plane(int x, int y, int dx, int dy) const {
    const bool between =
        in_.depth_m.contains(x - dx, y - dy) && in_.depth_m.contains(x + dx, y + dy);
    if (!between) return false;
    const float z = in_.depth_m(x, y);
    const float expected = 0.5F / in_.depth_m(x - dx, y - dy) + 0.5F / in_.depth_m(x + dx, y + dy);
    return std::abs(expected * z - 1.0F) > config_.depth_edge;
  }

  const ImportanceInputs& in_;
  const ImportanceConfig& config_;
  float least_cosine_;
};

}  // namespace

void focus(const Plane<float>& acuity, float share, Plane<float>& weights) {
  MACULA_CHECK(share < 1.0F && acuity.size() == weights.size());
  double inside = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    (acuity.pixels()[i] < 1.0F ? outside : inside) += static_cast<double>(weights.pixels()[i]);
  const double wanted = outside * static_cast<double>(share) / (1.0 - static_cast<double>(share));
  if (!(inside > 0.0) || inside >= wanted) return;
  const auto factor = static_cast<float>(wanted / inside);
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!(acuity.pixels()[i] < 1.0F)) weights.pixels()[i] *= factor;
}

float color_distance(const Rgb& a, const Rgb& b) {
  const Rgb from = encoded(a), to = encoded(b), d = to - from;
  const float red = 0.5F * (from.x + to.x);
  return 255.0F * std::sqrt((2.0F + red) * d.x * d.x + 4.0F * d.y * d.y + (3.0F - red) * d.z * d.z);
}

Plane<float> make_importance(const ImportanceInputs& inputs, const ImportanceConfig& config) {
  MACULA_CHECK(inputs.normal.rect() == inputs.depth_m.rect(), "planes of one view");
  const Silhouettes silhouettes(inputs, config);
  Plane<float> importance(inputs.depth_m.width(), inputs.depth_m.height());
  for (int y = 0; y < importance.height(); ++y) {
    for (int x = 0; x < importance.width(); ++x) {
      if (!std::isfinite(inputs.depth_m(x, y))) continue;
      const float edge = silhouettes.at(x, y) ? config.silhouette : 0.0F;
      float bright = 1.0F;
      if (!inputs.brightness.empty()) {
        const float told = config.brightness_gain * inputs.brightness(x, y);
        bright = std::clamp(told, config.brightness_floor, 1.0F);
      }
      importance(x, y) = std::max(inputs.acuity(x, y), edge) * bright;
    }
  }
  return importance;
}

}  // namespace macula::kernels::culling
