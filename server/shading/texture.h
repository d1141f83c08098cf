// Texture: a mip pyramid of one image, read with a footprint. Stored as 8 bits a channel in the
// image's own encoding (4 bytes a texel, a third more for the pyramid) and decoded by table, so
// that every filter, in the pyramid and between texels, works on linear values. Immutable; safe to
// read from any thread. Trilinear filtering after Williams (1983), "Pyramidal Parametrics".
#pragma once

#include <cstdint>
#include <vector>

#include "server/sampling/batch.h"
#include "server/scene/scene.h"

namespace macula::shading {

/// Colours and alpha side by side.
struct TexelBatch {
  sampling::FloatBatch channel[4];
};
/// Channels by number, as bits.
inline constexpr unsigned kColorChannels = 0b0111, kAlphaChannel = 0b1000;

class Texture {
 public:
  /// An empty image reads as white. Level sizes halve, rounding down, until 1 x 1; an odd size is
  /// averaged by exact area, so that every level keeps the mean of the one below.
  Texture(const image::Plane<image::Rgba8>& pixels, scene::ColorSpace space);

  /// Linear colour and alpha at `uv` ((0, 0) is the top-left corner of the first texel, wrapped),
  /// averaged over about a square of side `footprint_uv`; 0 reads the finest level bilinearly.
  /// A non-finite uv reads (0, 0).
  Vec4 sample(Vec2 uv, float footprint_uv, scene::Wrap wrap_u, scene::Wrap wrap_v) const;
  /// The same at many places, in vectors, within 1e-5; of the wanted channels only.
  void sample(const sampling::Vec2Batch& uv, const sampling::FloatBatch& footprint_uv,
              scene::Wrap wrap_u, scene::Wrap wrap_v, std::size_t count, unsigned channels,
              TexelBatch& out) const;
  /// Brings the texels that sample() reads near, without waiting for them.
  void fetch(Vec2 uv, float footprint_uv, scene::Wrap wrap_u, scene::Wrap wrap_v) const;
  /// Linear mean of the whole image.
  const Vec4& mean() const { return mean_; }
  int level_count() const { return static_cast<int>(levels_.size()); }

 private:
  /// As loops that gather read it: three numbers a level.
  struct Level {
    std::int32_t width = 0, height = 0;
    std::int32_t first = 0;  ///< index of its top-left texel
  };
  void append_level(const std::vector<Vec4>& linear, int width, int height,
                    scene::ColorSpace space);
  Vec4 texel(const Level& level, int x, int y) const;
  Vec4 bilinear(const Level& level, Vec2 uv, scene::Wrap wrap_u, scene::Wrap wrap_v) const;
  void fetch_around(const Level& level, Vec2 uv) const;
  float level_of(float footprint_uv) const;

  std::vector<Level> levels_;
  std::vector<image::Rgba8> texels_;  ///< every level, finest first
  const float* decode_ = nullptr;     ///< 256 linear values of a stored colour channel
  float side_texels_ = 1.0F;          ///< square root of the finest level's area
  Vec4 mean_{1.0F};
};

/// The texture coordinates a reference reads at: KHR_texture_transform, uv' = offset + R scale uv
/// with R = (cos, sin; -sin, cos), counter-clockwise as seen, v pointing down.
Vec2 transform_uv(const scene::TextureRef& reference, Vec2 uv);

}  // namespace macula::shading
