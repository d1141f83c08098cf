#include "server/kernels/sphere/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace macula::kernels::sphere {

float surface_gap(const SurfaceBatch& points, std::size_t i) {
  // Hits lie within an eighth of half a cell; float coordinates within some ulps of the distance.
  constexpr float kUlps = 32.0F * std::numeric_limits<float>::epsilon();
  return std::max(0.5F * points.cell_m.at[i], kUlps * glm::length(points.position[i]));
}

/// Rays on their way, up to a batch of the evaluator's.
struct Occlusion::Lanes {
  struct Lane {
    std::size_t point = 0;
    Vec3 origin{0.0F}, direction{0.0F};
    float t = 0.0F, end = 0.0F;
    float least = 0.0F;  ///< least step; at half of it as distance something is met
    float clear = 1.0F;  ///< least ratio of distance to the light's width so far
  };
  std::array<Lane, sdf::kBatch> at;
  std::size_t count = 0;
};

void Occlusion::measure(std::size_t count) {
  sdf::evaluate(tape_, positions_, count, registers_, found_);
  work_.field_evaluations += count;
  work_.field_operations += count * operations_;
}

/// Leaves no lanes. A ray that runs out of steps creeps along a surface: it is hidden. At `s` to a
/// wall a step goes s times the distance to it, so 1024 steps carry a ray that starts a centimeter
/// off a kilometer far unless it lies within 0.65 degrees of the wall (times the field's bound).
void Occlusion::march(Lanes& lanes, float tan_radius, sampling::FloatBatch& reaching) {
  constexpr int kMostSteps = 1024;
  for (int step = 0; step < kMostSteps && lanes.count > 0; ++step) {
    for (std::size_t i = 0; i < lanes.count; ++i) {
      const Lanes::Lane& lane = lanes.at[i];
      positions_.set(i, lane.origin + lane.t * lane.direction);
    }
    measure(lanes.count);
    std::size_t live = 0;
    for (std::size_t i = 0; i < lanes.count; ++i) {
      Lanes::Lane lane = lanes.at[i];
      const float distance = found_.at[i];
      if (tan_radius > 0.0F && lane.t > 0.0F)
        lane.clear = std::min(lane.clear, distance / (tan_radius * lane.t));
      // A field of a large bound is small also where its surface is as far as the gap.
      if (lane.t == 0.0F) lane.least = std::clamp(distance, 0.0F, lane.least);
      lane.t += std::max(distance, lane.least);
      const bool hidden = !(distance > 0.5F * lane.least) || lane.clear <= 0.0F;
      if (hidden) lane.clear = 0.0F;
      if (hidden || lane.t >= lane.end) {
        reaching.at[lane.point] = lane.clear * lane.clear * (3.0F - 2.0F * lane.clear);
      } else {
        lanes.at[live++] = lane;
      }
    }
    lanes.count = live;
  }
  for (std::size_t i = 0; i < lanes.count; ++i) reaching.at[lanes.at[i].point] = 0.0F;
  lanes.count = 0;
}

void Occlusion::light(const SurfaceBatch& points, const sampling::Vec3Batch& to_light,
                      const sampling::FloatBatch& distance_m, float tan_radius,
                      const sampling::FloatBatch& wanted, sampling::FloatBatch& reaching) {
  Lanes lanes;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (wanted.at[i] != 0.0F) {
      ++work_.shadow_rays;
      const float gap = surface_gap(points, i);
      const Vec3 normal = points.normal[i];
      const Vec3 out = glm::dot(normal, points.to_eye[i]) < 0.0F ? -normal : normal;
      lanes.at[lanes.count++] = {i,    points.position[i] + gap * out,           to_light[i],
                                 0.0F, std::min(distance_m.at[i], far_m_) - gap, gap,
                                 1.0F};
    }
    if (lanes.count == sdf::kBatch) march(lanes, tan_radius, reaching);
  }
  march(lanes, tan_radius, reaching);
}

void Occlusion::near_sky(const SurfaceBatch& points, float reach_m,
                         sampling::FloatBatch& reaching) {
  constexpr int kTaps = 4;
  std::fill_n(reaching.at, points.count, 0.0F);
  float total = 0.0F;
  for (int tap = 1; tap <= kTaps; ++tap) {
    const float height = reach_m * static_cast<float>(tap * tap) / (kTaps * kTaps);
    const float weight = 1.0F / static_cast<float>(tap);
    total += weight;
    for (std::size_t first = 0; first < points.count; first += sdf::kBatch) {
      const std::size_t count = std::min(sdf::kBatch, points.count - first);
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 normal = points.normal[first + i];
        const float side = glm::dot(normal, points.to_eye[first + i]) < 0.0F ? -height : height;
        positions_.set(i, points.position[first + i] + side * normal);
      }
      measure(count);
      for (std::size_t i = 0; i < count; ++i)
        reaching.at[first + i] += weight * std::clamp(found_.at[i] / height, 0.0F, 1.0F);
    }
  }
  for (std::size_t i = 0; i < points.count; ++i) reaching.at[i] /= total;
}

}  // namespace macula::kernels::sphere
