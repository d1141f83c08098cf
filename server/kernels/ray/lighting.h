// Lighting of a batch of points: punctual lights, emissive triangles, ambient occlusion,
// environment. Every term is one stream of shadow rays over the whole batch, made and shaded in
// vectors: ray i is point i's, idle where no light can arrive. A point's radiance is summed in a
// fixed order and depends on that point alone, never on its place or its neighbours in the batch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/ray/config.h"
#include "server/kernels/scene_frame.h"
#include "server/sampling/batch.h"
#include "server/sampling/sample.h"
#include "server/shading/reflector_batch.h"

namespace macula::kernels::ray {

struct SurfaceGroup;

/// Points to be lit, seen from where their reflectors' frames say. Zero at first: vectors reach
/// past the last point.
struct LitPoints {
  std::size_t count = 0;
  std::uint32_t sample = 0;        ///< which primary sample of their cells they are
  sampling::Vec3Batch position;    ///< world, meters
  sampling::Vec3Batch ray_origin;  ///< the same off the surface, towards the eye's side
  shading::ReflectorBatch reflectors;
  /// The same one by one, for terms that draw directions from them; empty unless keeps_whole.
  std::vector<shading::Reflector> whole;
  bool keeps_whole = false;
  sampling::SampleKey keys[sampling::kBatch];  ///< identity of their cells' random numbers
  /// Most nodes of each point's cut, >= 1; empty: Config::area_light_samples.
  std::vector<std::uint16_t> cut_nodes;
  /// Each point's class of virtual lights; empty: by chance.
  std::vector<std::uint16_t> light_class;

  void clear() { count = 0, whole.clear(), cut_nodes.clear(), light_class.clear(); }
  /// The point is surface.position; the reflector is the surface's.
  void push(const shading::Surface& surface, const shading::Reflector& reflector,
            sampling::SampleKey key);
  /// All points of a group, without their keys, which are to be set from the old count on.
  void append(const SurfaceGroup& group);
};
static_assert(sampling::kBatch == visibility::kStreamCapacity);

struct LightingWork {
  std::uint64_t shadow_rays = 0;
  double trace_ms = 0.0;  ///< time inside visibility queries
};

class Lighting {
 public:
  /// Refers to both; they must outlive it.
  Lighting(const SceneFrame& scene, const Config& config) : scene_(scene), config_(config) {}

  /// Adds the light that every point reflects to its eye to radiance[i]; radiance.size() ==
  /// points.count. `sampled`, empty or of the same size, receives the part of it that chance
  /// estimates: area and ambient light.
  void add(const LitPoints& points, std::span<Rgb> radiance, LightingWork& work,
           std::span<Rgb> sampled = {}) const;

 private:
  const SceneFrame& scene_;
  const Config& config_;
};

}  // namespace macula::kernels::ray
