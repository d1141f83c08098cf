#include "server/kernels/culling/smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/culling/same_surface.h"
#include "server/kernels/parcels.h"
#include "server/reconstruction/backward_warp.h"
#include "shared/foveation/eccentricity.h"

namespace macula::kernels::culling {
namespace {

/// What is remembered is of one surface: normals within 25 degrees, depths within 2 %.
constexpr float kSameNormal = 0.906F;
constexpr float kSameDepth = 0.02F;

class Sharing {
 public:
  Sharing(const View& view, const ViewBuffers& buffers, int reach)
      : buffers_(buffers), same_(view, buffers), reach_(reach) {}

  Rgb at(int x, int y) const {
    if (!std::isfinite(buffers_.depth_m(x, y))) return buffers_.light(x, y);
    Rgb sum{0.0F};
    float weights = 0.0F;
    for (int dy = -reach_; dy <= reach_; ++dy) {
      for (int dx = -reach_; dx <= reach_; ++dx) {
        if (!buffers_.light.contains(x + dx, y + dy) || !same_({x, y}, {x + dx, y + dy})) continue;
        const float weight = rim(dx) * rim(dy);
        sum += weight * buffers_.light(x + dx, y + dy);
        weights += weight;
      }
    }
    return sum / weights;
  }

 private:
  float rim(int d) const { return std::abs(d) == reach_ ? 0.5F : 1.0F; }

  const ViewBuffers& buffers_;
  SameSurface same_;
  int reach_;
};

/// Least and most light around a cell, channel by channel.
struct Range {
  Rgb low{std::numeric_limits<float>::infinity()}, high{0.0F};
};
Range range_around(const Plane<Rgb>& light, int x, int y, int window) {
  const int reach = window / 2;
  Range range;
  for (int ny = std::max(y - reach, 0); ny <= std::min(y + reach, light.height() - 1); ++ny) {
    for (int nx = std::max(x - reach, 0); nx <= std::min(x + reach, light.width() - 1); ++nx) {
      range.low = glm::min(range.low, light(nx, ny));
      range.high = glm::max(range.high, light(nx, ny));
    }
  }
  return range;
}

class Remembering {
 public:
  Remembering(const View& view, const ViewBuffers& buffers, const ViewMemory& then,
              const reconstruction::Movers& movers)
      : view_(view), buffers_(buffers), then_(then), movers_(movers) {
    add_way({});
    for (const Pose& then_from_now : movers.then_from_now) add_way(then_from_now);
  }

  struct Known {
    Rgb light;
    float frames;
  };
  /// What was remembered of what is seen there now.
  std::optional<Known> at(int x, int y) const {
    const float depth = buffers_.depth_m(x, y);
    if (!std::isfinite(depth)) return std::nullopt;
    const Way& way = ways_[movers_.then_from_now.empty() ? 0 : movers_.of(x, y)];
    const auto place = way.warp.then(view_.grid.tangent(x, y), depth);
    if (!place) return std::nullopt;
    const int tx = static_cast<int>(place->cell.x), ty = static_cast<int>(place->cell.y);
    if (!then_.depth_m.contains(tx, ty)) return std::nullopt;
    const bool same =
        std::abs(then_.depth_m(tx, ty) - place->depth_m) <= kSameDepth * depth &&
        glm::dot(then_.normal(tx, ty), way.turn * buffers_.normal(x, y)) > kSameNormal;
    return same ? std::optional(Known{then_.light(tx, ty), then_.frames(tx, ty)}) : std::nullopt;
  }

 private:
  struct Way {
    reconstruction::BackwardWarp warp;
    Mat3 turn;  ///< of normals, then from now
  };
  void add_way(const Pose& then_from_now) {
    ways_.push_back({{then_from_now * view_.world_from_view, then_.world_from_view, then_.grid},
                     Mat3(glm::mat3_cast(then_from_now.rotation))});
  }

  const View& view_;
  const ViewBuffers& buffers_;
  const ViewMemory& then_;
  const reconstruction::Movers& movers_;
  std::vector<Way> ways_;  ///< of what stays, then by mover
};

double eccentricity_at(const View& view, int x, int y) {
  return foveation::eccentricity(view.gaze.direction, view.grid.ray(x, y)).value();
}

/// At one of the corners: eccentricity has no maximum inside.
double largest_eccentricity(const View& view) {
  const int right = view.grid.width() - 1, bottom = view.grid.height() - 1;
  return std::max({eccentricity_at(view, 0, 0), eccentricity_at(view, right, 0),
                   eccentricity_at(view, 0, bottom), eccentricity_at(view, right, bottom)});
}

}  // namespace

Plane<Rgb> shared_light(const View& view, const ViewBuffers& buffers, int reach,
                        TileScheduler& scheduler) {
  const Sharing sharing(view, buffers, reach);
  Plane<Rgb> light(buffers.light.width(), buffers.light.height());
  const auto rows = static_cast<std::size_t>(light.height());
  scheduling::run_shared(
      scheduler, rows, Audience::EveryRank, scheduling::by_rows(rows),
      [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < light.width(); ++x) light(x, y) = sharing.at(x, y);
      },
      [&](std::size_t row, Parcel& parcel) { parcel.values(light.row(static_cast<int>(row))); });
  return light;
}

LightOverFrames remembered(const View& view, const ViewBuffers& buffers, const ViewMemory& then,
                           const reconstruction::Movers& movers, float newest,
                           TileScheduler& scheduler, const Plane<Rgb>& now) {
  const Remembering memory(view, buffers, then, movers);
  LightOverFrames mean{now, Plane<float>(now.width(), now.height(), 1.0F)};
  const double largest = std::max(largest_eccentricity(view), 1e-6);  // radians; a view has width
  const auto remember_row = [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < now.width(); ++x) {
      const auto known = memory.at(x, y);
      if (!known) continue;
      const int window = clamp_window(static_cast<float>(eccentricity_at(view, x, y) / largest));
      const Range range = range_around(now, x, y, window);
      const Rgb kept = glm::clamp(known->light, range.low, range.high);
      const float frames = std::min(known->frames + 1.0F, 1.0F / newest);
      mean.light(x, y) = glm::mix(kept, now(x, y), 1.0F / frames);
      mean.frames(x, y) = frames;
    }
  };
  const auto rows = static_cast<std::size_t>(now.height());
  scheduling::run_shared(scheduler, rows, Audience::EveryRank, scheduling::by_rows(rows),
                         remember_row, [&](std::size_t row, Parcel& parcel) {
                           parcel.values(mean.light.row(static_cast<int>(row)));
                           parcel.values(mean.frames.row(static_cast<int>(row)));
                         });
  return mean;
}

int clamp_window(float q) {
  return std::clamp(3 + 2 * static_cast<int>(std::floor((q - 0.10F) / 0.05F)), 3, 9);
}

}  // namespace macula::kernels::culling
