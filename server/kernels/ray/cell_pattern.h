// CellPattern: where in a cell its primary samples lie, as fractions of its width and height.
#pragma once

#include "server/kernels/ray/config.h"
#include "server/sampling/sample.h"
#include "shared/math/vec.h"

namespace macula::kernels::ray {

class CellPattern {
 public:
  CellPattern(int samples, Placement placement);

  int samples() const { return samples_; }
  /// Of sample s in [0, samples): in [0, 1]^2. A square count puts one sample into every one of k x
  /// k equal parts, at its centre when fixed; other counts are a Sobol sequence, scrambled by `key`
  /// when jittered. Uniform in the cell over keys when jittered.
  Vec2 position(sampling::SampleKey key, int s) const;
  /// The sample that speaks for the cell in planes which cannot be averaged: the one nearest to the
  /// centre of a square pattern, else the first.
  int guide() const { return guide_; }
  /// Whether the guide lies exactly at the centre of the cell.
  bool guide_is_central() const;

 private:
  int samples_;
  Placement placement_;
  int side_;  ///< k, or 0 when the count is no square
  int guide_;
};

}  // namespace macula::kernels::ray
