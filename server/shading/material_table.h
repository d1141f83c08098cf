// MaterialTable: the scene's materials with their textures decoded and filtered, answering what a
// surface is made of at a point. Immutable; safe from any thread. Holds copies, not the scene.
#pragma once

#include <optional>
#include <vector>

#include "server/scene/plan.h"
#include "server/scene/scene.h"
#include "server/shading/bsdf.h"
#include "server/shading/bsdf_batch.h"
#include "server/shading/pattern.h"
#include "server/shading/surface.h"
#include "server/shading/texture.h"

namespace macula::shading {

/// Lambert: every material becomes a diffuse one of its base colour, whatever else it says. Phong:
/// lobes are Phong's, as in the lighting of the foveated ray tracing paper (section 4).
enum class MaterialModel { AsInScene, Lambert, Phong };

struct MaterialOptions {
  /// LeftOut: factors alone. Forced: where a material has no texture it reads a white one.
  scene::StepUse textures = scene::StepUse::Used;
  /// LeftOut: every material is Lambert with its share of the base colour. Forced: where nothing is
  /// reflected, a lobe too faint to see is evaluated.
  scene::StepUse specular_lobe = scene::StepUse::Used;
};

/// Reflectance of a forced lobe: above 0, below what any sum can hold beside 1.
inline constexpr float kFaintestLobe = 1e-12F;

/// What one sample stands for where it meets a surface; all 0: the point itself.
struct SampleFootprint {
  float uv = 0.0F;       ///< side of its square of texture space
  float width_m = 0.0F;  ///< across the line of sight
  Vec3 to_eye{0.0F};     ///< unit, world; read where width_m > 0
};

class MaterialTable {
 public:
  /// Decodes every image once for each colour space that a material reads it in.
  explicit MaterialTable(const scene::Scene& scene, const MaterialOptions& options = {});

  /// `footprint_uv`: side of the square of texture space one sample stands for; 0 = no filtering.
  Bsdf bsdf(scene::Index material, const Vec2& uv, float footprint_uv, MaterialModel model) const;
  /// Brings the base colour's texels near, without waiting for them.
  void fetch(scene::Index material, const Vec2& uv, float footprint_uv) const;
  /// Base colour times texture: what the albedo plane shows.
  Rgb base_color(scene::Index material, const Vec2& uv, float footprint_uv) const;
  /// The same for a surface without texture coordinates: its pattern is a function of its place,
  /// and its BSDF one of the colour that came of it.
  Rgb base_color(scene::Index material, const PatternPoint& at) const;
  Bsdf bsdf(scene::Index material, const Rgb& base_color, MaterialModel model) const;
  /// Either, as the surface's material has it: by texture, or by pattern.
  Rgb base_color(const Surface& surface, const SampleFootprint& footprint = {}) const;
  Bsdf bsdf(const Surface& surface, const SampleFootprint& footprint, MaterialModel model) const;
  /// The same of the first `count` points of one material, in vectors, within 1e-5.
  void bsdf(scene::Index material, const SurfaceBatch& surfaces, const FootprintBatch& footprints,
            std::size_t count, MaterialModel model, BsdfBatch& out) const;
  /// Radiance leaving the front face, W/(sr m^2).
  Rgb emission(scene::Index material, const Vec2& uv, float footprint_uv) const;
  /// GGX width of the material's lobe, [kLeastAlpha, 1], its roughness texture taken at its mean;
  /// 0: it has none.
  float lobe_width(scene::Index material, MaterialModel model) const;
  /// What a point drawn on a lamp shines with: emission times what alpha leaves of the surface
  /// there, since rays that look for the lamp meet no more than that.
  Rgb lamp_emission(scene::Index material, const Vec2& uv) const;
  /// The same averaged over the whole emission texture, alpha's texture taken as 1.
  const Rgb& mean_emission(scene::Index material) const;
  bool emits(scene::Index material) const;
  bool textured(scene::Index material) const;
  std::size_t size() const { return materials_.size(); }
  std::size_t texture_count() const { return textures_.size(); }

 private:
  class TextureList;
  struct Lookup {
    std::size_t texture;
    scene::TextureRef reference;
  };
  struct Entry {
    scene::Material material;
    std::optional<Lookup> base_color, metallic_roughness, emission, specular, specular_color;
    Rgb mean_emission{0.0F};
  };
  /// What textures or a pattern made of a material's factors at a point.
  struct Factors {
    Rgb base{0.0F};
    float metallic = 0.0F, roughness = 1.0F, specular = 1.0F;
    Rgb specular_color{1.0F};
  };
  Bsdf make_bsdf(const Factors& at, MaterialModel model) const;
  /// Share of the surface that is there, in [0, 1].
  float coverage(const Entry& entry, const Vec2& uv) const;
  Vec4 read(const std::optional<Lookup>& lookup, const Vec2& uv, float footprint_uv) const;
  /// Null without a texture, else `room`.
  const TexelBatch* read(const std::optional<Lookup>& lookup, const SurfaceBatch& surfaces,
                         const sampling::FloatBatch& footprint_uv, std::size_t count,
                         unsigned channels, TexelBatch& room) const;
  void base_colors(scene::Index material, const SurfaceBatch& surfaces,
                   const FootprintBatch& footprints, std::size_t count,
                   sampling::Vec3Batch& out) const;

  MaterialOptions options_;
  std::vector<Texture> textures_;
  std::vector<Entry> materials_;
};

}  // namespace macula::shading
