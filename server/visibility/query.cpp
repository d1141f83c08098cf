// Streams of rays through Embree, one packet at a time.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/visibility/state.h"

namespace macula::visibility {
namespace {

/// Embree's structures for packets of kWidth rays; width 1 has scalars where the others have
/// arrays.
template <int kWidth>
struct Packet;
template <>
struct Packet<1> {
  using Ray = RTCRay;
  using RayHit = RTCRayHit;
};
template <>
struct Packet<8> {
  using Ray = RTCRay8;
  using RayHit = RTCRayHit8;
};
template <>
struct Packet<16> {
  using Ray = RTCRay16;
  using RayHit = RTCRayHit16;
};

template <class T>
T* lanes(T& scalar) {
  return &scalar;
}
template <class T, std::size_t kWidth>
T* lanes(T (&array)[kWidth]) {
  return array;
}

/// Copies the first `n` values of a packet's width; whole packets at constant length, as vectors.
template <int kWidth, class T>
void copy_lanes(const T* in, int n, T* out) {
  if (n == kWidth) {
    std::copy_n(in, kWidth, out);
  } else {
    std::copy_n(in, n, out);
  }
}

/// The lanes of a tail keep what they had: Embree looks at idle lanes, too.
template <int kWidth, class Lanes>
void load(Lanes& out, const float* in, int n) {
  copy_lanes<kWidth>(in, n, lanes(out));
}

/// x - x is 0 exactly for finite x, NaN otherwise.
bool is_finite_ray(const RayStream& rays, int i) {
  const float sum = (rays.ox[i] - rays.ox[i]) + (rays.oy[i] - rays.oy[i]) +
                    (rays.oz[i] - rays.oz[i]) + (rays.dx[i] - rays.dx[i]) +
                    (rays.dy[i] - rays.dy[i]) + (rays.dz[i] - rays.dz[i]);
  return sum == 0.0F;
}

/// Embree's valid mask of one packet: -1 for a ray to trace, 0 for an idle lane.
template <int kWidth>
struct alignas(64) Valid {
  int lane[kWidth] = {};
  int any = 0;
};

/// What Embree reads of a ray and never changes.
template <int kWidth, class EmbreeRay>
void set_constants(EmbreeRay& ray) {
  for (int i = 0; i < kWidth; ++i) {
    lanes(ray.time)[i] = 0.0F;
    lanes(ray.mask)[i] = ~0U;
    lanes(ray.flags)[i] = 0;
  }
}

template <int kWidth>
Valid<kWidth> load_rays(const RayStream& rays, const SceneState& state, int first,
                        typename Packet<kWidth>::Ray& out) {
  static_assert(kStreamCapacity % kWidth == 0);
  const int n = std::min(kWidth, rays.count - first);
  load<kWidth>(out.org_x, rays.ox + first, n);
  load<kWidth>(out.org_y, rays.oy + first, n);
  load<kWidth>(out.org_z, rays.oz + first, n);
  load<kWidth>(out.dir_x, rays.dx + first, n);
  load<kWidth>(out.dir_y, rays.dy + first, n);
  load<kWidth>(out.dir_z, rays.dz + first, n);
  load<kWidth>(out.tnear, rays.tnear + first, n);
  load<kWidth>(out.tfar, rays.tfar + first, n);
  if (state.blends) copy_lanes<kWidth>(rays.blend + first, n, lanes(out.id));
  Valid<kWidth> valid;
  for (int i = 0; i < kWidth; ++i) {
    const int ray = first + i;
    const bool runs = (rays.tnear[ray] <= rays.tfar[ray]) & is_finite_ray(rays, ray);
    valid.lane[i] = runs & (i < n) ? -1 : 0;
    valid.any |= valid.lane[i];
  }
  return valid;
}

/// Embree may leave the hit of an idle lane alone, so "nothing" is written before the call.
template <class EmbreeHit>
void clear_ids(EmbreeHit& hit, int n) {
  for (int i = 0; i < n; ++i) {
    lanes(hit.geomID)[i] = RTC_INVALID_GEOMETRY_ID;
    lanes(hit.instID[0])[i] = RTC_INVALID_GEOMETRY_ID;
  }
}

template <class RayHit>
void store_hit(RayHit& in, int lane, const SceneState& state, HitStream& out, int i) {
  const std::uint32_t geometry = lanes(in.hit.geomID)[lane];
  out.instance[i] = kNothing;
  if (geometry == RTC_INVALID_GEOMETRY_ID) return;
  const std::uint32_t outer = lanes(in.hit.instID[0])[lane];
  out.instance[i] = instance_of(outer, geometry, state.still_id);
  out.triangle[i] = lanes(in.hit.primID)[lane];
  out.t[i] = lanes(in.ray.tfar)[lane];
  out.u[i] = lanes(in.hit.u)[lane];
  out.v[i] = lanes(in.hit.v)[lane];
  const Vec3 by_winding{lanes(in.hit.Ng_x)[lane], lanes(in.hit.Ng_y)[lane],
                        lanes(in.hit.Ng_z)[lane]};
  const Vec3 normal = glm::normalize(state.world_normal_from_embree[out.instance[i]] * by_winding);
  out.nx[i] = normal.x, out.ny[i] = normal.y, out.nz[i] = normal.z;
}

template <int kWidth>
void intersect_stream(const RayStream& rays, const SceneState& state, Coherence coherence,
                      HitStream& hits) {
  embree::IntersectCall call(coherence);
  typename Packet<kWidth>::RayHit packet{};
  set_constants<kWidth>(packet.ray);
  for (int first = 0; first < rays.count; first += kWidth) {
    const int n = std::min(kWidth, rays.count - first);
    const Valid<kWidth> valid = load_rays<kWidth>(rays, state, first, packet.ray);
    clear_ids(packet.hit, n);
    if (valid.any != 0) call.trace(valid.lane, state.top.get(), packet);
    for (int i = 0; i < n; ++i) store_hit(packet, i, state, hits, first + i);
  }
}

template <int kWidth>
void occlude_stream(const RayStream& rays, const SceneState& state, Coherence coherence,
                    OcclusionStream& result) {
  embree::OccludedCall call(coherence);
  typename Packet<kWidth>::Ray packet{};
  set_constants<kWidth>(packet);
  for (int first = 0; first < rays.count; first += kWidth) {
    const Valid<kWidth> valid = load_rays<kWidth>(rays, state, first, packet);
    if (valid.any != 0) call.trace(valid.lane, state.top.get(), packet);
    std::uint8_t occluded[kWidth];
    for (int i = 0; i < kWidth; ++i) {
      // Embree marks an occluded ray by tfar = -infinity.
      const bool marked = lanes(packet.tfar)[i] == -std::numeric_limits<float>::infinity();
      occluded[i] = marked & (valid.lane[i] != 0) ? 1 : 0;
    }
    copy_lanes<kWidth>(occluded, std::min(kWidth, rays.count - first), result.occluded + first);
  }
}

RTCRay single_ray(const RayStream& rays, int i) {
  RTCRay ray{};
  ray.org_x = rays.ox[i], ray.org_y = rays.oy[i], ray.org_z = rays.oz[i];
  ray.dir_x = rays.dx[i], ray.dir_y = rays.dy[i], ray.dir_z = rays.dz[i];
  ray.tnear = rays.tnear[i], ray.tfar = rays.tfar[i];
  ray.mask = ~0U;
  ray.id = rays.blend[i];
  return ray;
}

/// Rays without common directions: as single rays, but all at once. Idle ones stay behind.
void occlude_scattered(const RayStream& rays, const SceneState& state, OcclusionStream& result) {
  alignas(64) RTCRay running[kStreamCapacity];
  int place[kStreamCapacity];  // of a running ray in the stream
  unsigned count = 0;
  for (int i = 0; i < rays.count; ++i) {
    result.occluded[i] = 0;
    if (rays.tnear[i] <= rays.tfar[i] && is_finite_ray(rays, i)) {
      place[count] = i;
      running[count++] = single_ray(rays, i);
    }
  }
  embree::OccludedCall(Coherence::Incoherent).trace(state.top.get(), running, count);
  for (unsigned k = 0; k < count; ++k) {
    if (running[k].tfar == -std::numeric_limits<float>::infinity()) {
      result.occluded[place[k]] = 1;
    }
  }
}

}  // namespace

void TriangleScene::intersect(const RayStream& rays, HitStream& hits, Coherence coherence) const {
  switch (state_->packet_width) {
    case 16:
      return intersect_stream<16>(rays, *state_, coherence, hits);
    case 8:
      return intersect_stream<8>(rays, *state_, coherence, hits);
    case 1:
      return intersect_stream<1>(rays, *state_, coherence, hits);
    default:
      std::fill_n(hits.instance, rays.count, kNothing);
  }
}

void TriangleScene::occluded(const RayStream& rays, OcclusionStream& result,
                             Coherence coherence) const {
  if (coherence == Coherence::Incoherent && state_->scatters) {
    return occlude_scattered(rays, *state_, result);
  }
  const bool narrowed = coherence == Coherence::Coherent && state_->has_instances;
  switch (std::min(state_->packet_width, narrowed ? embree::kWidestAmongInstances : 16)) {
    case 16:
      return occlude_stream<16>(rays, *state_, coherence, result);
    case 8:
      return occlude_stream<8>(rays, *state_, coherence, result);
    case 1:
      return occlude_stream<1>(rays, *state_, coherence, result);
    default:
      std::fill_n(result.occluded, rays.count, std::uint8_t{0});
  }
}

std::optional<Hit> TriangleScene::intersect(const Ray& ray) const {
  if (state_->packet_width == 0) return std::nullopt;
  RayStream rays;
  HitStream hits;
  rays.push(ray.origin, ray.direction, ray.tnear, ray.tfar, ray.blend);
  intersect_stream<1>(rays, *state_, Coherence::Incoherent, hits);
  if (!hits.hit(0)) return std::nullopt;
  return Hit{hits.t[0], hits.u[0], hits.v[0], hits.normal(0), hits.instance[0], hits.triangle[0], 0.0F};
}

bool TriangleScene::occluded(const Ray& ray) const {
  if (state_->packet_width == 0) return false;
  RayStream rays;
  OcclusionStream result;
  rays.push(ray.origin, ray.direction, ray.tnear, ray.tfar, ray.blend);
  occlude_stream<1>(rays, *state_, Coherence::Incoherent, result);
  return result.occluded[0] != 0;
}

}  // namespace macula::visibility
