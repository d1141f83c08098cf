// LightList: every light of a scene, ready to be asked. Punctual lights follow glTF
// (KHR_lights_punctual) and answer with the light that arrives at a point; emissive triangles are
// one-sided area lights and answer with points on them, drawn with an exactly known density. World
// space, meters, linear Rec.709. Safe from any thread but while it moves; holds copies, not the
// scene. Visibility is the caller's.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/lights/emitter_table.h"
#include "server/sampling/batch.h"
#include "server/scene/animation.h"
#include "server/scene/plan.h"
#include "server/shading/material_table.h"
#include "server/shading/surface.h"
#include "shared/base/big_vector.h"
#include "shared/base/lazy.h"

namespace macula::lights {

/// Light arriving from a punctual light, were nothing in the way.
struct Arrival {
  Vec3 to_light{0.0F};      ///< unit, from the point towards the light
  float distance_m = 0.0F;  ///< +infinity for a directional light
  Rgb irradiance{0.0F};     ///< W/m^2 on a surface that faces the light
};
/// nullopt where nothing arrives: outside a spot's cone, or exactly at the light (d = 0, where the
/// inverse square law has no value; a sample there is dropped).
std::optional<Arrival> arriving(const scene::Light& light, const DVec3& point);

/// The same at many points; no irradiance where nothing arrives.
struct ArrivalBatch {
  sampling::Vec3Batch to_light, irradiance;
};
void arriving(const scene::Light& light, const sampling::Vec3Batch& points, std::size_t count,
              ArrivalBatch& out);

struct EmissiveTriangle {
  DVec3 position{0.0};            ///< first vertex
  Vec3 edge1{0.0F}, edge2{0.0F};  ///< to the second and third
  Vec3 normal{0.0F};              ///< unit, the side it shines to
  float area_m2 = 0.0F;           ///< > 0: degenerate triangles are left out
  Rgb mean_emission{0.0F};        ///< radiance, W/(sr m^2), averaged over the texture
  scene::Index instance = 0, triangle = 0, material = 0;
};

/// How often an emissive triangle is drawn: in proportion to its power, to its area, or all alike.
enum class Selection { ByPower, ByArea, Alike };

struct Options {
  Selection selection = Selection::ByPower;
  /// LeftOut: no emissive triangles. Forced: every triangle is one, though its radiance may be 0.
  scene::StepUse area_lights = scene::StepUse::Used;
  scene::StepUse punctual = scene::StepUse::Used;  ///< LeftOut: no punctual lights
};

struct AreaSample {
  DVec3 position{0.0};
  Vec2 barycentric{0.0F};   ///< as in shading::SurfaceTable::at
  float pdf_per_m2 = 0.0F;  ///< density over the area of all emissive triangles, > 0
  std::uint32_t light = 0;  ///< index into emissive()
};

/// Light arriving from one sampled point of all emissive triangles, were nothing in the way.
struct AreaArrivalBatch {
  /// Unit, and the irradiance on a surface that faces the light divided by the sample's density; 0
  /// where the light faces away.
  ArrivalBatch arrival;
  sampling::Vec3Batch position,
      normal;  ///< on the light: world, meters; unit, the side it shines to
  /// What rounding of a ray to there grows with: the larger of the distance and of the light's
  /// edges at its first vertex, meters.
  sampling::FloatBatch span;
  sampling::IndexBatch light;       ///< index into emissive()
  sampling::Vec2Batch barycentric;  ///< as in shading::SurfaceTable::at
};

class LightList {
 public:
  LightList(const scene::Scene& scene, const scene::ScenePose& pose,
            const shading::MaterialTable& materials, const Options& options = {});
  /// At time 0.
  LightList(const scene::Scene& scene, const shading::MaterialTable& materials,
            const Options& options = {});
  /// Takes these lights and what shines of these instances to where another pose of the same scene
  /// has them; the same list as one made afresh. What emissive triangles are drawn by is made when
  /// it is first asked for.
  void move(const scene::Scene& scene, const scene::MovingParts& moving,
            const scene::ScenePose& pose, const shading::MaterialTable& materials);

  std::span<const scene::Light> punctual() const { return punctual_; }
  std::span<const EmissiveTriangle> emissive() const { return emissive_; }
  /// Left out because their area is zero or not finite.
  std::size_t degenerate_count() const { return degenerate_; }

  /// A point on some emissive triangle for u in [0, 1)^2; stratified u give stratified points. Only
  /// for a list with emissive triangles.
  AreaSample sample_area(const Vec2& u) const;
  /// The same for the light that arrives at the first `count` points, one sample each; textured
  /// lights unfiltered.
  void arriving_area(const sampling::Vec2Batch& u, const sampling::Vec3Batch& points,
                     std::size_t count, const shading::SurfaceTable& surfaces,
                     const shading::MaterialTable& materials, AreaArrivalBatch& out) const;
  /// Density of sample_area at any point of triangle `light`, per m^2.
  float pdf_per_m2(std::uint32_t light) const;
  /// Radiance of triangle `light` at a barycentric point, unfiltered texture.
  Rgb emission(std::uint32_t light, const Vec2& barycentric, const shading::SurfaceTable& surfaces,
               const shading::MaterialTable& materials) const;

 private:
  bool shines(const scene::Scene& scene, scene::Index instance,
              const shading::MaterialTable& materials) const;
  void collect_emissive(const scene::Scene& scene, const scene::ScenePose& pose,
                        const shading::MaterialTable& materials);
  /// Writes from emissive_[first] on; returns where it has come to.
  std::size_t add_instance(const scene::Scene& scene, const scene::ScenePose& pose,
                           scene::Index instance, const Rgb& emission, std::size_t first);
  const EmitterTable& table() const;

  Options options_;
  std::vector<bool> textured_;  ///< by material: whether its emission comes from a texture
  base::BigVector<scene::Light> punctual_;
  base::BigVector<EmissiveTriangle> emissive_;
  std::size_t degenerate_ = 0;
  base::Lazy<EmitterTable> table_;
};

}  // namespace macula::lights
