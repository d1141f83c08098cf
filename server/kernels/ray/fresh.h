// FreshSamples: what a frame's traced cells brought. They are few among many, so their samples lie
// side by side in the order of tracing, a batch a row, and not where their cells lie in the
// picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/tile.h"
#include "server/reconstruction/texel.h"

namespace macula::kernels::ray {

class FreshSamples {
 public:
  static constexpr std::size_t kBatch = std::size_t{kTileSide} * kTileSide;
  static std::size_t batch_count(std::size_t cells) { return (cells + kBatch - 1) / kBatch; }

  /// Forgets all samples and makes room for those of `cells` cells, in at most two lists, of a view
  /// of this size; `wanted` as in FrameBuffers. Keeps memory that suffices.
  void prepare(int width, int height, unsigned wanted, std::size_t cells);
  /// Gives the cells their places. The row of their first batch; the others follow.
  int place(std::span<const image::Pixel> cells);

  /// Fills chroma() of a batch whose samples are there.
  void add_chroma(int row, std::size_t cells);

  /// By row of the batch and place in it: cell k of a batch is at (k, row).
  ViewBuffers& planes() { return planes_; }
  image::Plane<reconstruction::Texel>& chroma() { return chroma_; }

  /// Where a traced cell's sample lies in every plane; some valid place for other cells.
  std::size_t at(int x, int y) const { return places_(x, y); }
  /// Sends for a sample: all that memory is blended with.
  void fetch(std::size_t at) const {
    __builtin_prefetch(planes_.radiance.data() + at), __builtin_prefetch(chroma_.data() + at);
    __builtin_prefetch(planes_.depth_m.data() + at);
    if (planes_.light.empty()) return;
    __builtin_prefetch(planes_.light.data() + at);
    __builtin_prefetch(planes_.reflectance.data() + at);
  }
  const reconstruction::Texel& chroma(std::size_t at) const { return chroma_.data()[at]; }
  /// Of these three one more number may be read.
  const Rgb& radiance(std::size_t at) const { return planes_.radiance.data()[at]; }
  const Rgb& light(std::size_t at) const { return planes_.light.data()[at]; }
  const Rgb& reflectance(std::size_t at) const { return planes_.reflectance.data()[at]; }
  float depth_m(std::size_t at) const { return planes_.depth_m.data()[at]; }
  const Vec3& normal(std::size_t at) const { return planes_.normal.data()[at]; }
  const Rgb& albedo(std::size_t at) const { return planes_.albedo.data()[at]; }
  std::uint32_t surface_id(std::size_t at) const { return planes_.surface_id.data()[at]; }

 private:
  Rgb color(std::size_t at) const;

  ViewBuffers planes_;
  image::Plane<reconstruction::Texel> chroma_;
  image::Plane<std::uint32_t> places_;  ///< by cell
  unsigned wanted_ = 0;
  int rows_ = 0;  ///< taken so far
};

}  // namespace macula::kernels::ray
