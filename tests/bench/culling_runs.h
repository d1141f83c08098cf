// The frames that `macula-bench culling` times: of sessions of the kernel, and of every virtual
// light at some pixels.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/culling/culling_kernel.h"
#include "tests/bench/culling_setting.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {

/// One frame, what it cost, and where the time went.
struct Rendered {
  image::Plane<Rgb> radiance;
  Lap lap;
  kernels::culling::StageTimes stages;
  std::uint64_t shadow_rays = 0;
  std::size_t made = 0, kept = 0;

  /// Times and counts; what was made and kept are the other's.
  void add(const Rendered& other);
  void divide(int by);
  /// What is done for every cell costs so many times as much, what is done once a frame does not.
  void count_cells_times(double factor);
};

/// Frames of one session. Refers to the setting and the scheduler.
class CullingSession {
 public:
  CullingSession(const CullingSetting& setting, CullingSetting::Eye eye,
                 const kernels::culling::Config& config, std::uint64_t seed,
                 scheduling::TileScheduler& scheduler)
      : setting_(setting),
        eye_(std::move(eye)),
        kernel_(config),
        seed_(seed),
        scheduler_(scheduler) {}

  Result<Rendered> frame(int index);

 private:
  const CullingSetting& setting_;
  const CullingSetting::Eye eye_;
  kernels::culling::CullingKernel kernel_;
  const std::uint64_t seed_;
  scheduling::TileScheduler& scheduler_;
  kernels::History history_;
  kernels::FrameBuffers buffers_;
};

/// Every virtual light at the listed pixels, a shadow ray each, in frame `index`; other pixels stay
/// black. Time is that of the listed ones.
Result<Rendered> all_lights_at(std::span<const image::Pixel> pixels, int index,
                               const CullingSetting& setting,
                               const kernels::culling::Config& config,
                               scheduling::TileScheduler& scheduler);

/// CPU time of the whole picture's surfaces alone, ms.
Result<double> surfaces_cpu_ms(int index, const CullingSetting& setting,
                               const kernels::ray::Config& config,
                               scheduling::TileScheduler& scheduler);

}  // namespace macula::bench
