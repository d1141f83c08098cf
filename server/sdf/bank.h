// Where the registers of one run of a tape lie, and the runs themselves. Inside server/sdf.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/sdf/tape.h"

namespace macula::sdf {

/// Register r of distances begins at r * stride (plain) or 4 r * stride (surface: value and three
/// derivatives), of points at three times that; materials at r * stride. What goes in and what
/// comes out need not be copied: the points asked for, register 0, lie at `input`, and register
/// `result` at `output`.
struct Bank {
  const float* input;
  float* points;
  float* distances;
  float* output;
  std::size_t result;
  std::int32_t* materials;  ///< of a surface run only
  std::size_t stride;       ///< entries between planes, a multiple of 16
  std::size_t count;        ///< points to do, a multiple of 16
};

void run_plain(const Tape& tape, const Bank& bank);
void run_surface(const Tape& tape, const Bank& bank);

/// The root that formulas of lengths use (numbers-inl.h), for its test. Planes at a vector's
/// alignment, padded to a multiple of 16.
void roots_by_products(const float* squares, std::size_t count, float* roots);

}  // namespace macula::sdf
