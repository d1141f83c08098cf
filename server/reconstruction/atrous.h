// Smoothing along surfaces, a row at a time in vectors: an edge-stopping a-trous wavelet, and the
// spread of values around a cell. Deterministic: a cell depends on its neighbourhood alone.
// Sources: Dammertz et al. 2010 (filter), Schied et al. 2017 (stopping at differences beyond the
// noise, variance carried along).
#pragma once

#include "server/reconstruction/light_planes.h"

namespace macula::reconstruction {

/// A pass over `step` cells between taps.
struct AtrousPass {
  int step = 1;
  float stops = 3.0F;  ///< standard deviations that differences may have, e-fold
};
/// Cells of row y whose `reach` is above `pass`, an index, are smoothed; others copied. Planes of
/// one size; `to` is written in this row alone.
void smooth_row(const SurfacePlanes& surfaces, const WidePlane& reach, float pass,
                const AtrousPass& how, const LightPlanes& from, int y, LightPlanes& to);

/// What makes light a spike: the mean of few samples, many times as bright as all beside it.
struct SpikeRule {
  float enough = 1.0F;  ///< samples: the mean of so many is none
  float times = 1.0F;   ///< as bright as the brightest like surface beside it, >= 1
};
/// Light of row y, none brighter than the rule allows; its luminance is written.
void cut_spikes_row(const SurfacePlanes& surfaces, const WidePlane& samples, const SpikeRule& rule,
                    const LightPlanes& from, int y, LightPlanes& to);

/// Mean and standard deviation of `values` over the cells within two with a surface, and the number
/// of these cells; 0 where there is none.
struct Spread {
  WidePlane mean, deviation;
  void resize(int width, int height) {
    mean.resize(width, height), deviation.resize(width, height);
  }
};
void spread_row(const WidePlane& distance_m, const WidePlane& values, int y, Spread& spread);

}  // namespace macula::reconstruction
