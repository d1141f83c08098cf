#include "server/kernels/lightcuts/denoiser.h"

#include <numbers>
#include <utility>

namespace macula::kernels::lightcuts {
namespace {

using reconstruction::LightPlanes;
using reconstruction::SurfacePlanes;
using reconstruction::WidePlane;

constexpr int kMostPasses = 5;
constexpr float kPerDegree = std::numbers::pi_v<float> / 180.0F;
/// Memory of fewer frames is smoothed by a pass more.
constexpr float kShortMemory = 4.0F;
/// The mean of so many samples is no spike, however bright.
constexpr float kEnoughSamples = 8.0F;
constexpr reconstruction::MemoryConfig kMemory;

/// The last pass spans 2^passes cells to either side.
float passes(float eccentricity, float frames) {
  const int count = 3 + (eccentricity > 10.0F * kPerDegree) + (frames < kShortMemory);
  return static_cast<float>(count);
}

class Denoiser {
 public:
  Denoiser(const DenoiseJob& job, TileScheduler& scheduler, Plane<Rgb>& light, LightMemory& memory)
      : job_(job), scheduler_(scheduler), light_(light), memory_(memory) {
    const int width = light.width(), height = light.height();
    memory.world_from_view = job.view.world_from_view;
    memory.grid = job.view.grid;
    memory.surfaces.resize(width, height);
    for (LightPlanes* planes : {&memory.mean, &now_, &next_}) planes->resize(width, height);
    reach_.resize(width, height), memory.fresh.resize(width, height);
  }

  scheduling::Outcome run() {
    gather();
    if (rows([&](int y) {
          cut_spikes_row(memory_.surfaces, memory_.fresh, kEnoughSamples, now_, y, memory_.mean);
        })) {
      return kStopped;
    }
    if (join()) return kStopped;
    if (smooth()) return kStopped;
    deliver();
    return scheduling::Outcome::Completed;
  }

 private:
  static constexpr auto kStopped = scheduling::Outcome::Stopped;

  void gather() {
    const Vec3 eye(job_.view.world_from_view.position);
    for (const SurfaceTile& tile : job_.surfaces.tiles) {
      for (std::size_t i = 0; i < tile.points.count; ++i) {
        const image::Pixel at = tile.pixel(i);
        const Vec3 position = tile.points.position[i];
        put(memory_.surfaces, at, position, tile.points.reflectors.shading[i],
            glm::length(position - eye));
        memory_.fresh.row(at.y)[at.x] = static_cast<float>(job_.samples(at.x, at.y));
        const Rgb& light = light_(at.x, at.y);
        now_.r.row(at.y)[at.x] = light.x, now_.g.row(at.y)[at.x] = light.y;
        now_.b.row(at.y)[at.x] = light.z;
      }
    }
  }
  static void put(SurfacePlanes& to, const image::Pixel& at, const Vec3& position,
                  const Vec3& normal, float distance_m) {
    to.x.row(at.y)[at.x] = position.x, to.y.row(at.y)[at.x] = position.y;
    to.z.row(at.y)[at.x] = position.z, to.normal_x.row(at.y)[at.x] = normal.x;
    to.normal_y.row(at.y)[at.x] = normal.y, to.normal_z.row(at.y)[at.x] = normal.z;
    to.distance_m.row(at.y)[at.x] = distance_m;
  }

  /// True: stopped. So are the others.
  bool join() {
    reconstruction::MemoryJoin joined(job_.last, kMemory, memory_);
    return rows([&](int y) { joined.join_row(y); }) || rows([&](int y) { joined.bound_row(y); }) ||
           rows([&](int y) { joined.judge_row(y); });
  }
  bool smooth() {
    for (int y = 0; y < light_.height(); ++y) {
      for (int x = 0; x < light_.width(); ++x) {
        if (!(memory_.fresh.row(y)[x] > 0.0F)) continue;
        reach_.row(y)[x] = passes(job_.eccentricity(x, y), memory_.frames(x, y));
      }
    }
    const LightPlanes* from = &memory_.mean;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      const reconstruction::AtrousPass how{1 << pass};
      if (rows([&](int y) {
            smooth_row(memory_.surfaces, reach_, static_cast<float>(pass), how, *from, y, next_);
          })) {
        return true;
      }
      std::swap(now_, next_);
      from = &now_;
    }
    return false;
  }
  void deliver() {
    for (const SurfaceTile& tile : job_.surfaces.tiles) {
      for (std::size_t i = 0; i < tile.points.count; ++i) {
        const image::Pixel at = tile.pixel(i);
        light_(at.x, at.y) = {now_.r.row(at.y)[at.x], now_.g.row(at.y)[at.x],
                              now_.b.row(at.y)[at.x]};
      }
    }
  }

  template <class Body>
  bool rows(const Body& body) {
    return scheduler_.run(static_cast<std::size_t>(light_.height()),
                          [&](std::size_t row) { body(static_cast<int>(row)); }) == kStopped;
  }

  const DenoiseJob& job_;
  TileScheduler& scheduler_;
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
