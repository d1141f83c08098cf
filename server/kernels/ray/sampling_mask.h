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
#include "server/kernels/ray/mask_row.h"
#include "server/kernels/ray/support.h"

namespace macula::kernels::ray {

/// Why a cell is traced: for the eye's sake every frame, by chance, as a support sample where
/// neither holds, or because what is remembered of it failed.
enum class Reason : std::uint8_t { None, Chance, Fovea, Support, Resampled };

/// min(1, p) of every cell, from a table over sin(e / 2): a rate never rises with eccentricity, so
/// taking the table's nearer end never undersamples. Immutable.
class Probability {
 public:
  /// Rates below 1 are multiplied by `density`, in (0, 1].
  Probability(const FoveationMap::ViewInput& view, const foveation::RateModel& model,
              float density = 1.0F);
  float at(int x, int y) const;
  void row(int y, std::span<float> out) const;

 private:
  ProbabilityRow arguments(int y, int first, int count) const;

  const FoveationMap::ViewInput& view_;
  Vec3 gaze_;
  float per_area_;  ///< nominal pixels in a unit of the tangent plane
  std::vector<float> rates_;
  std::vector<float> tangent_x_, cell_width_;  ///< by column
};

struct MaskCounts {
  std::size_t chance = 0;  ///< fovea and chance, support or not
  std::size_t resampled = 0;
  std::size_t forgotten = 0;  ///< cells nothing is remembered of, before resampling
};

/// The density that brings the share of traced cells nearer to a budget, after a frame that traced
/// the share `traced` > 0 of them at `density`. Traced shares grow with density, from what is
/// always traced on: squaring the ratio makes up for that part without overshooting for ever.
float next_density(float density, float traced, float budget);

class SamplingMask {
 public:
  SamplingMask(const Support& support, int width, int height);

  /// Sets the support cells and those that chance chooses.
  void choose(const Probability& probability, std::uint64_t frame, std::uint64_t seed,
              const FoveatedConfig& config, TileScheduler& scheduler);
  /// Adds the `forgotten`, row by row, which are neither chosen nor remembered, and the quads with
  /// the highest scores > 0, all within the budget.  `scores` is of Support::broken's size and
  /// already weighed by acuity.
  void resample(std::vector<image::Pixel> forgotten, const Cache& remembered,
                const Plane<float>& scores, std::uint64_t frame, const FoveatedConfig& config,
                TileScheduler& scheduler);

  /// How many cells resample() may add.
  std::size_t most_resampled(const FoveatedConfig& config) const;

  Reason reason(int x, int y) const { return reasons_(x, y); }
  bool traced(int x, int y) const { return reasons_(x, y) != Reason::None; }
  bool contains(int x, int y) const { return reasons_.contains(x, y); }
  const Plane<Reason>& reasons() const { return reasons_; }
  const MaskCounts& counts() const { return counts_; }
  /// The cells of choose() and those of resample(), near ones after each other.
  const std::vector<image::Pixel>& chosen() const { return chosen_; }
  const std::vector<image::Pixel>& resampled() const { return resampled_; }
  /// Cells that are neither traced nor remembered, row by row.
  const std::vector<image::Pixel>& unknown() const { return unknown_; }

 private:
  std::size_t choose_row(const Probability& probability, int y, std::uint64_t frame,
                         std::uint64_t seed, MaskKind kind);
  template <class Wanted>
  void list(const Wanted& wanted, std::vector<image::Pixel>& cells, TileScheduler& scheduler) const;
  void resample_forgotten(double most, std::uint64_t frame);
  void resample_quads(const Plane<float>& scores, double most, const Cache& remembered,
                      std::uint64_t frame);
  std::vector<image::Pixel> open_cells(int quad_x, int quad_y, const Cache& remembered) const;

  const Support& support_;
  std::vector<int> quad_columns_, quad_rows_;  ///< first cells of the quads, and the end
  Plane<Reason> reasons_;
  std::vector<image::Pixel> chosen_, resampled_, unknown_;
  MaskCounts counts_;
};

}  // namespace macula::kernels::ray
