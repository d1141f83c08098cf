// From places in the source grid to colours. Internal to this room; one thread.
#pragma once

#include "client/reprojection/fragments.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// Colours between cell centres; the grid's outermost cells go on beyond its edge; black where
/// nothing is drawn. At a cell's centre the result is that cell's colour to the bit, whatever the
/// filter.
class Resolver {
 public:
  Resolver(const SourceView& source, const foveation::Display& display, WarpOptions::Filter filter);
  /// The rows of the fragments' band; `out` has the whole picture's size.
  void resolve_band(const Fragments& fragments, image::Plane<Rgb8>& out) const;

  /// Where CatmullRom is due, in cell coordinates; empty where first > last.
  struct Range {
    float first = 0.0F, last = -1.0F;
  };

 private:
  const image::Plane<Rgb8>& source_;
  Range fine_u_, fine_v_;
};

}  // namespace macula::reprojection
