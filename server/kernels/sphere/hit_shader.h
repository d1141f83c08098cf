// HitShader: turns what a tracer hands over into colours, block by block, in the tracer's order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "server/kernels/sphere/view_context.h"

namespace macula::kernels::sphere {

struct ShadedHit {
  const sdf::Hit& hit;
  float depth_m;  ///< view depth; +infinity for a miss
  Rgb radiance;   ///< the sky's for a miss
  Rgb albedo;     ///< base colour; black for a miss
};

class HitShader {
 public:
  /// Hits come from cells of `grid`, `samples` each.
  HitShader(const ViewContext& context, const PixelGrid& grid, int samples)
      : context_(context),
        grid_(grid),
        per_sample_(1.0F / std::sqrt(static_cast<float>(samples))),
        occlusion_(context.program) {}

  /// each(const ShadedHit&) for every hit of the block in its order. Samples that are not finite
  /// are black and counted.
  template <class Each>
  void shade(const sdf::HitBlock& block, Each each) {
    for (std::size_t first = 0; first < block.hits.size(); first += sampling::kBatch) {
      const auto hits = std::span(block.hits)
                            .subspan(first, std::min(sampling::kBatch, block.hits.size() - first));
      light(hits);
      for (std::size_t i = 0; i < hits.size(); ++i)
        each(ShadedHit{hits[i], depth_[i], radiance_[i], albedo_[i]});
    }
  }
  ShadeWork work() const {
    ShadeWork work = occlusion_.work();
    work.non_finite = non_finite_;
    return work;
  }

 private:
  void light(std::span<const sdf::Hit> hits);
  void gather(std::span<const sdf::Hit> hits);
  const ViewContext& context_;
  const PixelGrid& grid_;
  float per_sample_;
  Occlusion occlusion_;
  std::uint64_t non_finite_ = 0;
  SurfaceBatch surfaces_{};
  std::array<std::uint16_t, sampling::kBatch> owner_;  ///< which hit a surface is
  std::array<float, sampling::kBatch> depth_;
  std::array<Rgb, sampling::kBatch> radiance_, albedo_, surface_radiance_, surface_albedo_;
};

/// Whether a ray met a surface: Hit, or Inside a solid.
bool met_surface(const sdf::Hit& hit);

}  // namespace macula::kernels::sphere
