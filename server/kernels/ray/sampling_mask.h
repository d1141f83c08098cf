// SamplingMask: which cells of a view are traced in one frame, and why (sections 3.1 and 3.3): the
// support set, every cell with probability p, cells that must be resampled as far as the budget
// goes. p is the frame's rate model at the cell's eccentricity times its area in nominal pixels, so
// that a foveal grid, which has thinned the samples itself, is thinned no further.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/support.h"

namespace macula::kernels::ray {

/// Why a cell is traced.
enum class Reason : std::uint8_t { None, Support, Fovea, Chance, Resampled };

/// min(1, p) of every cell, from a table over sin(e / 2): a rate never rises with eccentricity, so
/// taking the table's nearer end never undersamples. Immutable.
class Probability {
 public:
  explicit Probability(const FoveationMap::ViewInput& view, const foveation::RateModel& model);
  float at(int x, int y) const;
  void row(int y, std::span<float> out) const;

 private:
  const FoveationMap::ViewInput& view_;
  Vec3 gaze_;
  float per_area_;  ///< nominal pixels in a unit of the tangent plane
  std::vector<float> rates_;
};

struct MaskCounts {
  std::size_t chance = 0;  ///< fovea and chance
  std::size_t resampled = 0;
  std::size_t forgotten = 0;  ///< cells nothing is remembered of, before resampling
};

class SamplingMask {
 public:
  SamplingMask(const Support& support, int width, int height);

  /// Sets the support cells.
  void mark_support();
  /// Adds the cells that chance chooses; `remembered` may be null: nothing is.
  void draw(const Probability& probability, const Cache* remembered, std::uint64_t frame,
            std::uint64_t seed, const FoveatedConfig& config, TileScheduler& scheduler);
  /// Adds cells nothing is remembered of and the quads with the highest scores > 0, all within the
  /// budget. `scores` is of Support::broken's size and already weighed by acuity.
  void resample(const Plane<float>& scores, std::uint64_t frame, const FoveatedConfig& config,
                TileScheduler& scheduler);

  Reason reason(int x, int y) const { return reasons_(x, y); }
  bool traced(int x, int y) const { return reasons_(x, y) != Reason::None; }
  bool contains(int x, int y) const { return reasons_.contains(x, y); }
  const MaskCounts& counts() const { return counts_; }
  /// The traced cells, near ones after each other: the support, and all others.
  std::vector<image::Pixel> support_cells() const;
  std::vector<image::Pixel> other_cells(TileScheduler& scheduler) const;

 private:
  struct Cutoff {
    float forgotten = 0.0F;     ///< thresholds below it are traced
    Plane<std::uint8_t> quads;  ///< 1 where a quad's cells are
  };
  Cutoff cutoff(const Plane<float>& scores, std::uint64_t frame,
                const FoveatedConfig& config) const;

  const Support& support_;
  Plane<Reason> reasons_;
  Plane<std::uint8_t> forgotten_;
  Plane<std::uint16_t> open_;  ///< cells of a quad that are remembered and not traced
  MaskCounts counts_;
};

}  // namespace macula::kernels::ray
