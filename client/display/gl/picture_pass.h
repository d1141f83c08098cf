// The GL 3.3 pass that puts display-encoded pictures into rectangles of the framebuffer, texel
// values unchanged where sizes agree, with an optional ring at the gaze. Every call needs the
// context it was created in to be current.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/display/gl/picture_space.h"
#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::display {

/// Circles of equal eccentricity, which are none on the flat picture: its frustum as tangents from
/// the upper left (frames.h), the gaze in the view frame, and the angles.
struct EccentricityRings {
  Vec2 tangent_min, tangent_max;
  Vec3 gaze;  ///< unit
  std::array<Radians, 3> at;
};

/// Drawn over one picture.
struct PictureMarks {
  std::optional<PicturePoint> gaze;  ///< a ring of 14 px
  std::optional<EccentricityRings> rings;
};

class PicturePass {
 public:
  static Result<std::unique_ptr<PicturePass>> create();
  ~PicturePass();
  PicturePass(const PicturePass&) = delete;
  PicturePass& operator=(const PicturePass&) = delete;

  /// Copies the pictures to the GPU. They stay until the next upload.
  void upload(std::span<const image::Plane<Rgb8>* const> pictures);
  /// Clears the framebuffer to black and draws picture i into places[i], later ones over earlier.
  /// `marks` may be shorter than `places`.
  void draw(PictureSize framebuffer, std::span<const image::Rect> places,
            std::span<const PictureMarks> marks);
  /// What was drawn, top row first.
  static image::Plane<Rgb8> read_back(PictureSize framebuffer);

 private:
  struct Texture {
    unsigned name = 0;
    PictureSize size;
  };
  struct Uniforms {
    int picture = -1, size_px = -1, ring_px = -1, ring_on = -1;
    int tangents = -1, gaze = -1, eccentricities = -1, eccentricities_on = -1;
  };
  PicturePass(unsigned program, unsigned vertices);
  void upload(const image::Plane<Rgb8>& picture, Texture& texture);
  void set_marks(const PictureMarks& marks, float width_px, float height_px);

  unsigned program_ = 0;
  unsigned vertices_ = 0;  ///< an empty vertex array: core profiles draw nothing without one
  Uniforms uniforms_;
  std::vector<Texture> textures_;
};

}  // namespace macula::display
