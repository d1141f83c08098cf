#include "server/kernels/lightcuts/denoiser.h"

#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "server/scheduling/row_bands.h"

namespace macula::kernels::lightcuts {
namespace {

using reconstruction::LightPlanes;
using reconstruction::SurfacePlanes;
using reconstruction::WidePlane;

constexpr int kMostPasses = 5;
static_assert(2 << (kMostPasses - 1) == kDenoiseReach);
constexpr float kPerDegree = std::numbers::pi_v<float> / 180.0F;
/// Memory of fewer frames is smoothed by a pass more.
constexpr float kShortMemory = 4.0F;
/// Samples of a cell that are many.
constexpr float kEnoughSamples = 8.0F;
/// Of few samples one is often the brightest around; cut to the next, all of them darken.
constexpr reconstruction::SpikeRule kSpikes{kEnoughSamples, 8.0F};
constexpr reconstruction::MemoryConfig kMemory;

/// Within so many degrees of the gaze more than one pass over the mean of many samples takes more
/// from thin things and shadows' edges than it takes from noise.
constexpr float kSharp_deg = 25.0F;

/// The last pass spans 2^passes cells to either side. `samples`: of this frame.
float passes(float eccentricity, float frames, float samples) {
  if (eccentricity <= kSharp_deg * kPerDegree && samples >= kEnoughSamples) return 1.0F;
  const int count = 3 + (eccentricity > 10.0F * kPerDegree) + (frames < kShortMemory);
  return static_cast<float>(count);
}

class Denoiser {
 public:
  Denoiser(const DenoiseJob& job, TileScheduler& scheduler, Plane<Rgb>& light, LightMemory& memory)
      : job_(job),
        scheduler_(scheduler),
        bands_(scheduler, light.height()),
        seen_(bands_.around(kDenoiseReach)),
        light_(light),
        memory_(memory) {
    memory.world_from_view = job.view.world_from_view;
    memory.grid = job.view.grid;
    for (LightPlanes* planes : {&memory.mean, &now_, &next_}) hold_seen(planes->all());
    hold_seen(memory.surfaces.all());
    hold_seen(std::array{&reach_, &memory.fresh});
  }

  scheduling::Outcome run() {
    if (gather()) return kStopped;
    if (bands_.run(bands_.around(kBoundRows + kJudgedRows + kFirstRows), [&](int y) {
          cut_spikes_row(memory_.surfaces, memory_.fresh, kSpikes, now_, y, memory_.mean);
        }) == kStopped) {
      return kStopped;
    }
    if (join()) return kStopped;
    if (smooth()) return kStopped;
    return deliver() ? kStopped : scheduling::Outcome::Completed;
  }

 private:
  static constexpr auto kStopped = scheduling::Outcome::Stopped;
  /// Rows to either side that a step reads of the one before; the first of the smoothing passes,
  /// judging, bounding.
  static constexpr int kFirstRows = 2, kJudgedRows = 2, kBoundRows = 2;
  static constexpr int reach_of(int pass) { return 2 << pass; }

  template <class Planes>
  void hold_seen(const Planes& planes) {
    for (WidePlane* plane : planes)
      plane->resize(light_.width(), light_.height(), seen_.begin, seen_.end);
  }

  /// True: stopped. So are the others.
  bool gather() {
    const Vec3 eye(job_.view.world_from_view.position);
    return each_point(seen_, [&](const SurfaceTile& tile, std::size_t i, const image::Pixel& at) {
      const Vec3 position = tile.points.position[i];
      put(memory_.surfaces, at, position, tile.points.reflectors.shading[i],
          glm::length(position - eye));
      memory_.fresh.row(at.y)[at.x] = static_cast<float>(job_.samples(at.x, at.y));
      const Rgb& light = light_(at.x, at.y);
      now_.r.row(at.y)[at.x] = light.x, now_.g.row(at.y)[at.x] = light.y;
      now_.b.row(at.y)[at.x] = light.z;
    });
  }
  static void put(SurfacePlanes& to, const image::Pixel& at, const Vec3& position,
                  const Vec3& normal, float distance_m) {
    to.x.row(at.y)[at.x] = position.x, to.y.row(at.y)[at.x] = position.y;
    to.z.row(at.y)[at.x] = position.z, to.normal_x.row(at.y)[at.x] = normal.x;
    to.normal_y.row(at.y)[at.x] = normal.y, to.normal_z.row(at.y)[at.x] = normal.z;
    to.distance_m.row(at.y)[at.x] = distance_m;
  }
  template <class Body>
  bool each_point(const scheduling::Band& rows, const Body& body) {
    return for_each_point(job_.surfaces, rows, bands_, body) == kStopped;
  }

  bool join() {
    reconstruction::MemoryJoin joined(job_.last, kMemory, memory_);
    const scheduling::Band first = bands_.around(kBoundRows + kJudgedRows + kFirstRows);
    if (bands_.is_shared() && job_.last != nullptr && fetch(joined, first)) return true;
    return bands_.run(first, [&](int y) { joined.join_row(y); }) == kStopped ||
           bands_.run(bands_.around(kJudgedRows + kFirstRows),
                      [&](int y) { joined.bound_row(y); }) == kStopped ||
           bands_.run(bands_.around(kFirstRows), [&](int y) { joined.judge_row(y); }) == kStopped;
  }
  /// What the last frame remembers where this rank's rows look it up.
  bool fetch(reconstruction::MemoryJoin& joined, const scheduling::Band& rows) {
    std::vector<scheduling::Rows> reads(static_cast<std::size_t>(rows.count()));
    bands_.run(rows, [&](int y) {
      const auto [begin, end] = joined.locate_row(y);
      reads[static_cast<std::size_t>(y - rows.begin)] = {begin, end};
    });
    scheduling::Rows all;
    for (const scheduling::Rows& each : reads) all = span_of(all, each);
    const auto planes = job_.last->all();
    for (WidePlane* plane : planes) plane->widen(all.begin, all.end);
    scheduling::RowBands then(scheduler_, job_.last->surfaces.height());
    return then.fetch(reads, [&](int y, Parcel& parcel) {
      for (WidePlane* plane : planes) carry_row(*plane, y, parcel);
    }) == kStopped;
  }
  static void carry_row(WidePlane& plane, int y, Parcel& parcel) {
    parcel.values(std::span(plane.row(y), static_cast<std::size_t>(plane.width())));
  }

  bool smooth() {
    bands_.run(bands_.own(), [&](int y) {
      for (int x = 0; x < light_.width(); ++x) {
        if (!(memory_.fresh.row(y)[x] > 0.0F)) continue;
        reach_.row(y)[x] =
            passes(job_.eccentricity(x, y), memory_.frames(x, y), memory_.fresh.row(y)[x]);
      }
    });
    const LightPlanes* from = &memory_.mean;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      const reconstruction::AtrousPass how{1 << pass};
      if (pass > 0 && lend(reach_of(pass))) return true;
      if (bands_.run(bands_.own(), [&](int y) {
            smooth_row(memory_.surfaces, reach_, static_cast<float>(pass), how, *from, y, next_);
          }) == kStopped) {
        return true;
      }
      std::swap(now_, next_);
      from = &now_;
    }
    return false;
  }
  bool lend(int reach) {
    return bands_.lend(reach, [&](int y, Parcel& parcel) {
      for (WidePlane* plane : now_.all()) carry_row(*plane, y, parcel);
    }) == kStopped;
  }
  bool deliver() {
    return each_point(bands_.own(), [&](const SurfaceTile&, std::size_t, const image::Pixel& at) {
      light_(at.x, at.y) = {now_.r.row(at.y)[at.x], now_.g.row(at.y)[at.x], now_.b.row(at.y)[at.x]};
    });
  }

  const DenoiseJob& job_;
  TileScheduler& scheduler_;
  scheduling::RowBands bands_;
  scheduling::Band seen_;  ///< that smoothing reads
  Plane<Rgb>& light_;
  LightMemory& memory_;
  LightPlanes now_, next_;
  WidePlane reach_;
};

}  // namespace

scheduling::Outcome denoise(const DenoiseJob& job, TileScheduler& scheduler, Plane<Rgb>& light,
                            LightMemory& memory) {
  return Denoiser(job, scheduler, light, memory).run();
}

}  // namespace macula::kernels::lightcuts
