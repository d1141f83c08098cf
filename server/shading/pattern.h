// Procedural patterns: where a surface shows the first and where the second of two colours, as a
// function of its place in the world, for surfaces that have no texture coordinates. Answers are
// means over the box a sample stands for, so that patterns fade instead of flickering. World
// space, meters. Pure functions.
#pragma once

#include "server/sampling/batch.h"
#include "server/scene/scene.h"
#include "shared/math/vec.h"

namespace macula::shading {

struct PatternPoint {
  Vec3 position{0.0F};     ///< world, meters
  Vec3 normal{0.0F};       ///< unit; its largest axis is left out by patterns of two axes
  Vec3 footprint_m{0.0F};  ///< along each axis: the box to average over; 0: the point itself
};

/// Share of the second colour at a point, in [0, 1]: the mean over the box of `footprint_m`
/// around it, exact for Checker and Stripes. Bricks treat courses beyond the point's own as
/// lying like it; Noise fades an octave to its mean as its period shrinks to one footprint.
///   Checker  squares of size_m
///   Bricks   running bond of bricks 2 size_m long and size_m high, joints in the second colour
///   Stripes  horizontal bands of size_m
///   Noise    smooth, with features of size_m
float second_share(const scene::Pattern& pattern, const PatternPoint& point);

/// The box around what a sample of a given width across the line of sight covers on a surface seen
/// at a slant: longer by 1 / cosine along it, up to 64 times. `normal`, `to_eye`: unit. Meters.
Vec3 covered_box(const Vec3& normal, const Vec3& to_eye, float width_m);

/// The first `count` of points side by side, as PatternPoint has them.
struct PatternPoints {
  const sampling::Vec3Batch &position, &normal, &footprint_m;
  std::size_t count = 0;
};
/// second_share of each, in vectors: within 1e-5, but for points a rounding from an edge.
void second_shares(const scene::Pattern& pattern, const PatternPoints& points,
                   sampling::FloatBatch& out);

}  // namespace macula::shading
