#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "server/disocclusion/hidden_sights.h"
#include "server/sdf/evaluate.h"

namespace macula::disocclusion {
namespace {

/// As many as kernels::FieldRays takes.
constexpr int kMostSteps = 1024;
/// Where a surface is met: this share of the way come, a twentieth of half a pixel in usual
/// pictures; and clear of one, four times as far off.
constexpr float kTolerance = 0x1p-14F, kClear = 4.0F;

struct Lane {
  int ray = 0;
  Vec3 origin{0.0F}, direction{0.0F};
  float at = 0.0F;  ///< meters along the unit direction
  int steps = 0;
  bool clear = false;  ///< of the surface it began behind
};

enum class Stop { Nothing, Surface, Lost };

Stop advance(Lane& lane, float distance) {
  if (std::isnan(distance) || ++lane.steps == kMostSteps) return Stop::Lost;
  const float tolerance = kTolerance * lane.at;
  if (!lane.clear) lane.clear = distance > kClear * tolerance;
  if (lane.clear && distance <= tolerance) return Stop::Surface;
  // A distance bounds the way to the surface from inside as well as from outside.
  lane.at += std::max(std::abs(distance), tolerance);
  return Stop::Nothing;
}

/// Calls work(part) with batches of lanes whose places are in `points`.
template <class Work>
void for_each_batch(std::span<Lane> lanes, sdf::PointBatch& points, Work work) {
  for (std::size_t first = 0; first < lanes.size(); first += sdf::kBatch) {
    const auto part = lanes.subspan(first, std::min(sdf::kBatch, lanes.size() - first));
    for (std::size_t i = 0; i < part.size(); ++i) {
      points.set(i, part[i].origin + part[i].at * part[i].direction);
    }
    work(part);
  }
}

std::vector<Lane> lanes_of(const visibility::RayStream& rays) {
  std::vector<Lane> lanes;
  for (int i = 0; i < rays.count; ++i) {
    const Vec3 along = rays.direction(i);
    const float length = glm::length(along);
    lanes.push_back({i, rays.origin(i), along / length, rays.tnear[i] * length});
  }
  return lanes;
}

class March {
 public:
  March(const sdf::Program& program, const sdf::Tape& tape) : program_(program), tape_(tape) {}

  /// Lanes where they meet a surface; those that meet none are left out.
  std::vector<Lane> run(std::vector<Lane> lanes) {
    std::vector<Lane> met, live;
    for (; !lanes.empty(); lanes.swap(live)) {
      live.clear();
      for_each_batch(lanes, points_, [&](std::span<Lane> part) {
        sdf::evaluate(tape_, points_, part.size(), registers_, distances_);
        for (std::size_t i = 0; i < part.size(); ++i) {
          const Stop why = advance(part[i], distances_.at[i]);
          if (why == Stop::Surface) met.push_back(part[i]);
          if (why == Stop::Nothing && part[i].at < program_.far_m) live.push_back(part[i]);
        }
      });
    }
    return met;
  }

  /// found(lane, unit normal, material) for each.
  template <class Found>
  void look(std::vector<Lane>& met, Found found) {
    sdf::SurfaceBatch surfaces{};
    for_each_batch(met, points_, [&](std::span<Lane> part) {
      sdf::evaluate_surface(tape_, points_, part.size(), registers_, surfaces);
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Vec3 gradient{surfaces.x[i], surfaces.y[i], surfaces.z[i]};
        const float slope = glm::length(gradient);
        const bool usable = slope > 1e-6F && std::isfinite(slope);  // ridges may have none
        found(part[i], usable ? gradient / slope : -part[i].direction, surfaces.material[i]);
      }
    });
  }

 private:
  const sdf::Program& program_;
  const sdf::Tape& tape_;
  sdf::Registers registers_;
  sdf::PointBatch points_{};
  sdf::DistanceBatch distances_{};
};

}  // namespace

FieldWalk::FieldWalk(const sdf::Field& field, double time_s)
    : program_(sdf::compile(field, time_s, DVec3{0.0})), tape_(sdf::make_tape(program_)) {}

void FieldWalk::find(HiddenSights& sights) const {
  const visibility::RayStream& rays = sights.rays;
  for (int i = 0; i < rays.count; ++i) sights.hits.instance[i] = visibility::kNothing;
  March march(program_, tape_);
  std::vector<Lane> met = march.run(lanes_of(rays));
  march.look(met, [&](const Lane& lane, const Vec3& normal, std::int32_t material) {
    visibility::Hit hit;
    hit.t = lane.at / glm::length(rays.direction(lane.ray));
    hit.normal = normal;
    hit.instance = static_cast<std::uint32_t>(material);
    set_hit(sights.hits, lane.ray, hit);
  });
}

}  // namespace macula::disocclusion
