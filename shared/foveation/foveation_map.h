// FoveationMap: the rate wanted in every cell of every view of one frame, handed out by row so that
// no full-size map need exist. Rates are samples per nominal display pixel; where a cell is larger
// than a nominal pixel, `samples_wanted_row` says how many samples the cell itself still deserves.
#pragma once

#include <span>
#include <vector>

#include "shared/foveation/gaze.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/foveation/rate.h"

namespace macula::foveation {

class FoveationMap {
 public:
  struct ViewInput {
    PixelGrid grid;
    Gaze gaze;
    DVec2 nominal_pixel_tangent{1e-3};  ///< Display::pixel_tangent()
  };
  FoveationMap(std::vector<ViewInput> views, const RateModel& model);

  std::size_t view_count() const { return views_.size(); }
  const ViewInput& view(std::size_t index) const { return views_.at(index); }
  const RateModel& model() const { return model_; }
  /// rate(e) at the centres of row y; out has the grid's width.
  void rate_row(std::size_t view, int y, std::span<float> out) const;
  /// Rate x cell area in nominal pixels: samples this cell needs, > 0.
  void samples_wanted_row(std::size_t view, int y, std::span<float> out) const;
  /// Eccentricity of cell centres in radians.
  void eccentricity_row(std::size_t view, int y, std::span<float> out) const;

 private:
  std::vector<ViewInput> views_;
  RateModel model_;
};

}  // namespace macula::foveation

namespace macula {
using foveation::FoveationMap;
}
