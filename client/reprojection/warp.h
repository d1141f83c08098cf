// The warp: the newest frame, rendered at one pose on its own grid, seen from the display pose now.
// Forward mesh: the grid's cell centres are the vertices; quads are cut at silhouettes by the
// actual camera offset; what stays open is filled from the farther side and flagged. Pure maths on
// the CPU, on the caller's thread (one eye a thread is safe): knows no GL and no OpenXR. Frames and
// tangents: shared/math/frames.h. Method: Mark, McMillan, Bishop, "Post-Rendering 3D Warping"
// (1997).
#pragma once

#include <cstdint>
#include <memory>

#include "client/reprojection/hidden_picture.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/pose.h"

namespace macula::reprojection {

/// One eye of a decoded frame; both planes have the grid's size. Colour is display-encoded; depth
/// is inverse, 0 = nothing there (a point at infinity, which only turns); NaN, infinite and
/// negative values are taken as 0, surfaces nearer than 1 mm as 1 mm away.
struct SourceView {
  Pose stage_from_view;
  const PixelGrid& grid;
  const image::Plane<Rgb8>& color;
  const image::Plane<float>& inverse_depth_per_m;
  /// What the frame's near surfaces hide, of the same grid; null: not known.
  const HiddenPicture* hidden = nullptr;
};

struct WarpOptions {
  /// RotationOnly ignores the camera's offset, Stale its turn as well: what to compare Mesh with.
  enum class Method { Mesh, RotationOnly, Stale };
  Method method = Method::Mesh;
  /// Cells that lie on one plane to within this many display pixels of parallax are drawn as one
  /// block of up to 31 x 31; 0 draws every cell.
  float detail_px = kFullDetail_px;
  static constexpr float kFullDetail_px = 0.01F, kGridDetail_px = 0.5F;
  /// Between two cells whose parallax differs by more than `cut_px` display pixels and that do not
  /// lie on one plane: Stretch draws the mesh on, as rubber; Cut leaves the whole cell between them
  /// open; Splat gives each side the half that is nearer to it.
  enum class Silhouettes { Stretch, Cut, Splat };
  Silhouettes silhouettes = Silhouettes::Splat;
  float cut_px = 0.75F;
  /// Both: what the frame hides is drawn before it, where it is known.
  enum class Layers { First, Both };
  Layers layers = Layers::Both;
  enum class Holes { FillFartherSide, LeaveBlack };
  Holes holes = Holes::FillFartherSide;
  /// Between cell centres. CatmullRom keeps detail that Bilinear blurs: 4 dB on waves of 7.5 cells.
  /// Fovea takes CatmullRom where cells are at most kFine_px wide and high on the display, and
  /// Bilinear elsewhere, where a picture is blurred anyway.
  enum class Filter { Bilinear, CatmullRom, Fovea };
  Filter filter = Filter::Fovea;
  static constexpr float kFine_px = 2.5F;
  /// EverySecond: the mesh is drawn for every second pixel of every second row, and silhouettes are
  /// true to two pixels. Between those, places are interpolated where cells are at most two pixels
  /// wide and high, and colours elsewhere. Of displays with even sizes; others take EveryPixel.
  enum class Raster { EveryPixel, EverySecond };
  Raster raster = Raster::EveryPixel;

  /// The grid mode of slow machines.
  static constexpr WarpOptions grid_mode() {
    WarpOptions options;
    options.detail_px = kGridDetail_px;
    options.cut_px = kGridCut_px;
    options.filter = Filter::Bilinear;
    options.raster = Raster::EverySecond;
    return options;
  }
  static constexpr float kGridCut_px = 1.5F;
};

/// Pixels of the display by where their colour comes from.
struct WarpReport {
  std::uint64_t covered_px = 0, filled_px = 0, outside_px = 0;
  double filled_share() const {
    const auto all = covered_px + filled_px + outside_px;
    return all == 0 ? 0.0 : static_cast<double>(filled_px) / static_cast<double>(all);
  }
};

/// Covered: seen in the frame. Filled: hidden in the frame, uncovered by the camera's offset;
/// guessed from the farther side, or black under LeaveBlack. Outside: beyond the frame's edge;
/// black.
enum class Coverage : std::uint8_t { Outside, Covered, Filled };

/// `out` (and `coverage` unless null) get the display's size. Colours are interpolated between cell
/// centres in display-encoded values; a display pixel that falls on a cell's centre gets that
/// cell's colour to the bit (but for colours between those of EverySecond). Geometry nearer than 1
/// cm to the display eye is left out. The same bits on every instruction set.
WarpReport warp(const SourceView& source, const Pose& stage_from_display,
                const foveation::Display& display, const WarpOptions& options,
                image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage = nullptr);

/// The same from frame to frame, one thread each: keeps its memory.
class Warper {
 public:
  Warper();
  ~Warper();
  Warper(Warper&&) noexcept;
  Warper& operator=(Warper&&) noexcept;

  WarpReport warp(const SourceView& source, const Pose& stage_from_display,
                  const foveation::Display& display, const WarpOptions& options,
                  image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage = nullptr);
  /// What the last warp drew, by display pixel, 1/m from the display's eye; 0 (infinity) where
  /// nothing was drawn, filled holes included.
  void copy_inverse_depth(image::Plane<float>& out) const;

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace macula::reprojection
