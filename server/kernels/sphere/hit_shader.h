// HitShader: turns what a tracer hands over into colours, block by block, in the tracer's order.
#pragma once

#include <algorithm>
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
      std::size_t n = 0;
      for (const sdf::Hit& hit : hits) {
        if (hit.status == sdf::RayStatus::Hit) {
          each(ShadedHit{hit, depth_.at[n], lit_.radiance[n], lit_.base_color[n]});
          ++n;
        } else {
          each(without_surface(hit));
        }
      }
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
  /// The sky, or the black inside of a solid.
  ShadedHit without_surface(const sdf::Hit& hit) const;

  const ViewContext& context_;
  const PixelGrid& grid_;
  float per_sample_;
  Occlusion occlusion_;
  std::uint64_t non_finite_ = 0;
  SurfaceBatch surfaces_{};  ///< of the hits, in their order
  LitBatch lit_{};
  sampling::FloatBatch ways_{}, depth_{};
};

/// Whether a ray met a surface: Hit, or Inside a solid.
bool met_surface(const sdf::Hit& hit);

}  // namespace macula::kernels::sphere
