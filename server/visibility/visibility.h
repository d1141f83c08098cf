// TriangleScene: closest-hit and occlusion queries against the triangles of one scene. World space,
// meters, float. Immutable once made; queries are safe from any number of threads at once.
// Scenes of moderate size are flattened into one level. In larger ones, meshes with several
// instances are stored once and instanced; a hit names the scene's own instance either way. The
// only room that knows Embree. Scenes that move: moving_triangles.h.
// Alpha: a point of a Mask material is there where alpha >= alpha_cutoff, one of a Blend material
// by the ray's BlendRule. Alpha is read between texels of the finest level, as colours are.
#pragma once

#include <memory>
#include <optional>

#include "server/scene/animation.h"
#include "server/scene/plan.h"
#include "server/visibility/ray_offset.h"
#include "server/visibility/ray_stream.h"
#include "shared/base/result.h"

namespace macula::visibility {

/// What the rays of one call have in common; the wrong answer costs half the rate, never a hit.
enum class Coherence { Coherent, Incoherent };

/// Robust: rays cannot slip between triangles that share an edge (costs 10-15 %).
enum class EdgeTest { Robust, Fast };
enum class BuildQuality { Low, Medium, High };
/// Rays traced together; Device: 16 where the processor has them natively, else 8.
enum class PacketWidth { Device, One, Eight, Sixteen };

struct Options {
  EdgeTest edges = EdgeTest::Robust;
  BuildQuality quality = BuildQuality::Medium;
  PacketWidth packets = PacketWidth::Device;
  /// A scene of at most this many triangles, copies counted, has no instances inside: rays run
  /// about a quarter faster, for about 100 bytes a triangle. In larger ones, copies of small meshes
  /// come to at most as many.
  std::size_t flat_triangles = 2'000'000;
  /// LeftOut: no Embree device; every ray misses. Forced: also for a scene without triangles.
  scene::StepUse bvh = scene::StepUse::Used;
  /// LeftOut: every surface is there. Forced: opaque surfaces, too, are asked whether they are.
  scene::StepUse alpha_test = scene::StepUse::Used;
  /// Forced: what stands still is refitted once, too (MovingTriangles only).
  scene::StepUse refit = scene::StepUse::Used;
};

struct Ray {
  Vec3 origin{0.0F};     ///< world, meters
  Vec3 direction{0.0F};  ///< any length; t counts in it
  float tnear = 0.0F;
  float tfar = std::numeric_limits<float>::infinity();
  BlendRule blend = blend_from(0.5F);
};

struct SceneState;  // what Embree holds; internal

class TriangleScene {
 public:
  /// Builds on all cores. A scene without triangles is legal: every ray misses. Errors: the device
  /// cannot be made, memory runs out, an instance's transform is not invertible.
  static Result<std::shared_ptr<const TriangleScene>> create(const scene::Scene& scene,
                                                             const scene::ScenePose& pose,
                                                             const Options& options = {});
  /// At time 0.
  static Result<std::shared_ptr<const TriangleScene>> create(const scene::Scene& scene,
                                                             const Options& options = {});
  ~TriangleScene();
  TriangleScene(const TriangleScene&) = delete;
  TriangleScene& operator=(const TriangleScene&) = delete;

  /// The closest hit of rays[0 .. count). Rays with a non-finite origin or direction meet nothing.
  void intersect(const RayStream& rays, HitStream& hits, Coherence coherence) const;
  void occluded(const RayStream& rays, OcclusionStream& result, Coherence coherence) const;

  /// One ray; four times as costly as its share of a coherent stream.
  std::optional<Hit> intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  /// Whether Embree was asked for anything: not for scenes without triangles.
  bool has_device() const;
  /// Triangles that lie in memory, every copy counted.
  std::size_t triangles_kept() const;
  /// Whether any surface asks rays for their BlendRule.
  bool blends() const;
  /// Rays per packet in use: 1, 8 or 16; 0 without a device. Tiles that keep 4x4 or 4x2 neighbours
  /// together fit it.
  int packet_width() const;

 private:
  friend class MovingTriangles;
  explicit TriangleScene(std::unique_ptr<SceneState> state);
  std::unique_ptr<SceneState> state_;
};

}  // namespace macula::visibility
