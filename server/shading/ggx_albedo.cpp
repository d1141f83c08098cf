#include "server/shading/ggx_albedo.h"

#include <algorithm>
#include <array>

#include "server/shading/ggx.h"

namespace macula::shading {
namespace {

constexpr int kNodes = GgxAlbedoNodes::kNodes;
constexpr int kSamplesSide = 24;  // stratified samples a side of one node's integral

float node_value(int i) {
  // Squares put the nodes where the lobe changes fastest: grazing angles and smooth surfaces.
  const float t = static_cast<float>(i) / (kNodes - 1);
  return t * t;
}

struct Cell {
  int node;
  float blend;
};
Cell locate(float value) {
  const float t = std::sqrt(std::clamp(value, 0.0F, 1.0F)) * (kNodes - 1);
  const int node = std::min(static_cast<int>(t), kNodes - 2);
  const float low = node_value(node), high = node_value(node + 1);
  return {node, std::clamp((value - low) / (high - low), 0.0F, 1.0F)};
}

GgxAlbedo mix(const GgxAlbedo& x, const GgxAlbedo& y, float t) {
  return {x.a + t * (y.a - x.a), x.b + t * (y.b - x.b)};
}

/// Visible-normal sampling leaves the weight F G2 / G1; the two parts of F are averaged apart.
GgxAlbedo integrate(float mu, float alpha) {
  const float cos_v = std::max(mu, 1e-4F);
  const Vec3 view{std::sqrt(1.0F - cos_v * cos_v), 0.0F, cos_v};
  double a = 0.0, b = 0.0;
  for (int j = 0; j < kSamplesSide; ++j) {
    for (int i = 0; i < kSamplesSide; ++i) {
      const Vec2 u{(static_cast<float>(i) + 0.5F) / kSamplesSide,
                   (static_cast<float>(j) + 0.5F) / kSamplesSide};
      const Vec3 half = ggx_sample_half(view, alpha, u);
      const float cos_vh = glm::dot(view, half);
      const float cos_l = 2.0F * cos_vh * half.z - cos_v;
      if (cos_l <= 0.0F) continue;
      const float g = (1.0F + ggx_lambda(cos_v, alpha)) /
                      (1.0F + ggx_lambda(cos_v, alpha) + ggx_lambda(cos_l, alpha));
      const float grazing = schlick_weight(cos_vh);
      a += g * (1.0F - grazing);
      b += g * grazing;
    }
  }
  constexpr double kCount = kSamplesSide * kSamplesSide;
  return {static_cast<float>(a / kCount), static_cast<float>(b / kCount)};
}

class Tables {
 public:
  Tables() {
    for (int j = 0; j < kNodes; ++j) {
      const float alpha = std::max(node_value(j), kLeastAlpha);
      for (int i = 0; i < kNodes; ++i) at(i, j) = integrate(node_value(i), alpha);
      mean_[static_cast<std::size_t>(j)] = mean_of_row(j);
    }
    std::transform(table_.begin(), table_.end(), packed_.begin(), pack);
  }
  const std::int32_t* packed() const { return packed_.data(); }
  const float* directional() const { return &table_.front().a; }
  const float* means() const { return &mean_.front().a; }
  GgxAlbedo directional(float mu, float alpha) const {
    const Cell x = locate(mu), y = locate(alpha);
    return mix(mix(at(x.node, y.node), at(x.node + 1, y.node), x.blend),
               mix(at(x.node, y.node + 1), at(x.node + 1, y.node + 1), x.blend), y.blend);
  }
  GgxAlbedo mean(float alpha) const {
    const Cell y = locate(alpha);
    return mix(mean_[static_cast<std::size_t>(y.node)], mean_[static_cast<std::size_t>(y.node + 1)],
               y.blend);
  }

 private:
  GgxAlbedo& at(int i, int j) { return table_[static_cast<std::size_t>(j * kNodes + i)]; }
  const GgxAlbedo& at(int i, int j) const {
    return table_[static_cast<std::size_t>(j * kNodes + i)];
  }
  static std::int32_t pack(const GgxAlbedo& albedo) {
    const auto code = [](float part) {
      return static_cast<std::uint32_t>(std::clamp(part, 0.0F, 1.0F) * 65535.0F + 0.5F);
    };
    return static_cast<std::int32_t>(code(albedo.a) | code(albedo.b) << 16);
  }
  /// Exact for the piecewise linear table: the integral of (linear) x mu over each interval.
  GgxAlbedo mean_of_row(int j) const {
    GgxAlbedo sum;
    for (int i = 0; i + 1 < kNodes; ++i) {
      const float m0 = node_value(i), m1 = node_value(i + 1), width = m1 - m0;
      const float w0 = width * (2.0F * m0 + m1) / 3.0F, w1 = width * (m0 + 2.0F * m1) / 3.0F;
      sum.a += w0 * at(i, j).a + w1 * at(i + 1, j).a;
      sum.b += w0 * at(i, j).b + w1 * at(i + 1, j).b;
    }
    return sum;
  }

  std::array<GgxAlbedo, kNodes * kNodes> table_{};
  std::array<GgxAlbedo, kNodes> mean_{};
  std::array<std::int32_t, kNodes * kNodes> packed_{};
};

const Tables& tables() {
  static const Tables made;
  return made;
}

}  // namespace

GgxAlbedo ggx_albedo(float mu, float alpha) {
  return tables().directional(mu, alpha);
}
const std::int32_t* GgxAlbedoNodes::packed() {
  return tables().packed();
}
const float* GgxAlbedoNodes::directional() {
  return tables().directional();
}
const float* GgxAlbedoNodes::mean() {
  return tables().means();
}
GgxAlbedo ggx_mean_albedo(float alpha) {
  return tables().mean(alpha);
}

}  // namespace macula::shading
