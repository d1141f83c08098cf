#include "server/kernels/field_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "server/sdf/evaluate.h"

namespace macula::kernels {
namespace {

using visibility::RayStream;

/// At a distance s to a wall a step goes s; along one it gains its sine's share of that. From a
/// millimeter off, 1024 steps carry a ray a kilometer far unless it lies within 0.8 degrees of it.
constexpr int kMostSteps = 1024;

enum class Stop : std::uint8_t { Nothing, Surface, Solid, NotANumber, OutOfSteps };

struct Lane {
  int ray = 0;  ///< of the stream
  Vec3 origin{0.0F}, direction{0.0F};
  float at = 0.0F, end = 0.0F;  ///< meters along the unit direction
  float floor = 0.0F;           ///< least distance that still counts as free
  int steps = 0;
};

/// How exactly a surface is known after `at` meters: an angle of the way, or what rounding leaves
/// of the coordinates that a long expression adds up.
float tolerance(const Lane& lane) {
  constexpr float kAngle = 0x1p-14F;
  return std::max(kAngle * lane.at, lane.floor);
}

float rounding_at(const Vec3& origin) {
  constexpr float kUlps = 32.0F * std::numeric_limits<float>::epsilon();
  return kUlps * std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Lanes on their way, up to a batch of the evaluator's.
class March {
 public:
  March(const sdf::Program& program, const sdf::Tape& tape, const RayStream& rays)
      : far_m_(program.far_m), tape_(tape), rays_(rays) {}

  bool full() const { return count_ == sdf::kBatch; }
  /// False: the ray is idle or not finite.
  bool add(int ray) {
    const Vec3 origin = rays_.origin(ray), along = rays_.direction(ray);
    const float length = glm::length(along);
    const bool runs = rays_.tnear[ray] <= rays_.tfar[ray] && is_finite(origin) &&
                      std::isfinite(length) && length > 0.0F;
    if (!runs) return false;
    const float begin = rays_.tnear[ray] * length;
    lanes_[count_++] = {ray,
                        origin,
                        along / length,
                        begin,
                        std::min(rays_.tfar[ray] * length, far_m_),
                        rounding_at(origin),
                        0};
    return true;
  }
  /// stopped(lane, why) for every lane; leaves none.
  template <class Stopped>
  void run(Stopped stopped) {
    while (count_ > 0) {
      for (std::size_t i = 0; i < count_; ++i)
        points_.set(i, lanes_[i].origin + lanes_[i].at * lanes_[i].direction);
      sdf::evaluate(tape_, points_, count_, registers_, distances_);
      std::size_t live = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        Lane lane = lanes_[i];
        const Stop why = advance(lane, distances_.at[i]);
        if (why == Stop::Nothing && lane.at < lane.end) {
          lanes_[live++] = lane;
        } else {
          stopped(lane, why);
        }
      }
      count_ = live;
    }
  }

 private:
  static Stop advance(Lane& lane, float distance) {
    if (std::isnan(distance)) return Stop::NotANumber;
    if (lane.steps == 0) {
      if (!(distance > 0.0F)) return Stop::Solid;
      // Off a surface by no more than its gap, the beginning is free all the same.
      lane.floor = std::min(lane.floor, 0.5F * distance);
    }
    if (distance <= tolerance(lane)) return Stop::Surface;
    if (++lane.steps == kMostSteps) return Stop::OutOfSteps;
    lane.at += distance;
    return Stop::Nothing;
  }

  float far_m_;
  const sdf::Tape& tape_;
  const RayStream& rays_;
  std::array<Lane, sdf::kBatch> lanes_;
  std::size_t count_ = 0;
  sdf::Registers registers_;
  sdf::PointBatch points_{};
  sdf::DistanceBatch distances_{};
};

/// Every ray of the stream in turn, a batch at a time.
template <class Idle, class Stopped>
void march_all(March& march, int count, Idle idle, Stopped stopped) {
  for (int ray = 0; ray < count; ++ray) {
    if (!march.add(ray)) idle(ray);
    if (march.full()) march.run(stopped);
  }
  march.run(stopped);
}

/// Gathers lanes that met something and asks the field what.
class Surfaces {
 public:
  Surfaces(const sdf::Tape& tape, const RayStream& rays, visibility::HitStream& hits)
      : tape_(tape), rays_(rays), hits_(hits) {}

  void add(const Lane& lane, Stop why) {
    points_.set(count_, lane.origin + lane.at * lane.direction);
    found_[count_++] = {lane, why};
    if (count_ == sdf::kBatch) finish();
  }
  void finish() {
    if (count_ == 0) return;
    sdf::evaluate_surface(tape_, points_, count_, registers_, surfaces_);
    for (std::size_t i = 0; i < count_; ++i) write(i);
    count_ = 0;
  }

 private:
  struct Found {
    Lane lane;
    Stop why = Stop::Surface;
  };
  void write(std::size_t i) {
    const Lane& lane = found_[i].lane;
    const Vec3 gradient{surfaces_.x[i], surfaces_.y[i], surfaces_.z[i]};
    const float length = glm::length(gradient);
    // A ridge or the middle of a shell may have no gradient: such a point faces the ray.
    const bool usable = found_[i].why == Stop::Surface && length > 1e-6F && std::isfinite(length);
    const Vec3 normal = usable ? gradient / length : -lane.direction;
    const int ray = lane.ray;
    hits_.instance[ray] = static_cast<std::uint32_t>(surfaces_.material[i]);
    hits_.triangle[ray] = 0;
    hits_.u[ray] = hits_.v[ray] = 0.0F;
    hits_.t[ray] = lane.at / glm::length(rays_.direction(ray));
    hits_.nx[ray] = normal.x, hits_.ny[ray] = normal.y, hits_.nz[ray] = normal.z;
    hits_.gap[ray] = gap(lane, usable ? length : 1.0F);
  }
  /// Twice what is not known of the place, and more where the field grows slowly (its bound is
  /// large): the ray that leaves must find itself outside.
  static float gap(const Lane& lane, float slope) {
    constexpr float kLeastSlope = 1.0F / 64.0F;
    const float unknown =
        std::max(tolerance(lane), rounding_at(lane.origin + lane.at * lane.direction));
    return 2.0F * unknown / std::clamp(slope, kLeastSlope, 1.0F);
  }

  const sdf::Tape& tape_;
  const RayStream& rays_;
  visibility::HitStream& hits_;
  std::array<Found, sdf::kBatch> found_;
  std::size_t count_ = 0;
  sdf::Registers registers_;
  sdf::PointBatch points_{};
  sdf::SurfaceBatch surfaces_{};
};

}  // namespace

/// Relative to the world's origin: rays of lighting come in world coordinates.
FieldRays::FieldRays(const sdf::Field& field, double time_s)
    : program_(sdf::compile(field, time_s, DVec3{0.0})), tape_(sdf::make_tape(program_)) {}

void FieldRays::intersect(const RayStream& rays, visibility::HitStream& hits) const {
  March march(program_, tape_, rays);
  Surfaces surfaces(tape_, rays, hits);
  const auto nothing = [&](int ray) { hits.instance[ray] = visibility::kNothing; };
  march_all(march, rays.count, nothing, [&](const Lane& lane, Stop why) {
    if (why == Stop::Surface || why == Stop::Solid) return surfaces.add(lane, why);
    nothing(lane.ray);
  });
  surfaces.finish();
}

void FieldRays::occluded(const RayStream& rays, visibility::OcclusionStream& result) const {
  March march(program_, tape_, rays);
  march_all(
      march, rays.count, [&](int ray) { result.occluded[ray] = 0; },
      [&](const Lane& lane, Stop why) { result.occluded[lane.ray] = why != Stop::Nothing; });
}

std::optional<visibility::Hit> FieldRays::intersect(const visibility::Ray& ray) const {
  RayStream rays;
  visibility::HitStream hits;
  rays.push(ray.origin, ray.direction, ray.tnear, ray.tfar);
  intersect(rays, hits);
  return hits.hit(0) ? std::optional(hits.at(0)) : std::nullopt;
}

bool FieldRays::occluded(const visibility::Ray& ray) const {
  RayStream rays;
  visibility::OcclusionStream result;
  rays.push(ray.origin, ray.direction, ray.tnear, ray.tfar);
  occluded(rays, result);
  return result.occluded[0] != 0;
}

}  // namespace macula::kernels
