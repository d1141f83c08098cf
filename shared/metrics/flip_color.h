// The colour spaces of FLIP, one pixel at a time and inline, so that row loops over them vectorise.
// Linear Rec.709 <-> XYZ relative to the D65 white (each of X, Y, Z is 1 for white), and CIELAB
// with Hunt-adjusted chroma. sRGB matrix: the exact rational one that IEC 61966-2-1's primaries
// give.
#pragma once

#include <bit>
#include <cstdint>

#include "shared/image/color.h"

namespace macula::metrics {

/// XYZ divided by the white point.
struct RelativeXyz {
  float x = 0.0F, y = 0.0F, z = 0.0F;
};

/// L* in [0, 100]; a and b are a*, b* scaled by L / 100 (Hunt: chroma fades with luminance).
struct HuntLab {
  float l = 0.0F, a = 0.0F, b = 0.0F;
};

namespace srgb {

// Rows of the matrix; a row's sum is the white point's coordinate.
inline constexpr double kX[3] = {10135552.0 / 24577794.0, 8788810.0 / 24577794.0,
                                 4435075.0 / 24577794.0};
inline constexpr double kY[3] = {2613072.0 / 12288897.0, 8788810.0 / 12288897.0,
                                 887015.0 / 12288897.0};
inline constexpr double kZ[3] = {1425312.0 / 73733382.0, 8788810.0 / 73733382.0,
                                 70074185.0 / 73733382.0};

struct Matrix {
  float m[3][3];
};

/// Rows divided by their sums: linear RGB -> RelativeXyz.
constexpr Matrix xyz_from_rgb() {
  Matrix result{};
  const double* rows[3] = {kX, kY, kZ};
  for (int i = 0; i < 3; ++i) {
    const double white = rows[i][0] + rows[i][1] + rows[i][2];
    for (int j = 0; j < 3; ++j) result.m[i][j] = static_cast<float>(rows[i][j] / white);
  }
  return result;
}

/// The inverse by cofactors, in double, columns scaled by the white point.
constexpr Matrix rgb_from_xyz() {
  const double* r[3] = {kX, kY, kZ};
  double cofactor[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      cofactor[i][j] = r[a][c] * r[b][d] - r[a][d] * r[b][c];
    }
  }
  const double determinant =
      r[0][0] * cofactor[0][0] + r[0][1] * cofactor[0][1] + r[0][2] * cofactor[0][2];
  Matrix result{};
  for (int i = 0; i < 3; ++i) {
    const double white = r[i][0] + r[i][1] + r[i][2];
    for (int j = 0; j < 3; ++j) {
      result.m[j][i] = static_cast<float>(cofactor[i][j] * white / determinant);
    }
  }
  return result;
}

inline constexpr Matrix kXyzFromRgb = xyz_from_rgb();
inline constexpr Matrix kRgbFromXyz = rgb_from_xyz();

}  // namespace srgb

inline RelativeXyz xyz_from_linear(const Rgb& c) {
  const auto& m = srgb::kXyzFromRgb.m;
  return {m[0][0] * c.x + m[0][1] * c.y + m[0][2] * c.z,
          m[1][0] * c.x + m[1][1] * c.y + m[1][2] * c.z,
          m[2][0] * c.x + m[2][1] * c.y + m[2][2] * c.z};
}

inline Rgb linear_from_xyz(const RelativeXyz& v) {
  const auto& m = srgb::kRgbFromXyz.m;
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
          m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

/// For positive normal x, within 2 ulp. A third of the exponent as the first guess (3 % off), then
/// two Halley steps, each of which cubes the relative error. Unlike std::cbrt it vectorises.
inline float cube_root(float x) {
  float y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) / 3U + 0x2a5137a0U);
  for (int step = 0; step < 2; ++step) {
    const float cube = y * y * y;
    y *= (cube + 2.0F * x) / (2.0F * cube + x);
  }
  return y;
}

/// CIE 15: cube root above (6/29)^3, its tangent line below.
inline float lab_curve(float t) {
  constexpr float kDelta = 6.0F / 29.0F;
  constexpr float kCut = kDelta * kDelta * kDelta;
  const float root = cube_root(t > kCut ? t : kCut);
  return t > kCut ? root : t / (3.0F * kDelta * kDelta) + 4.0F / 29.0F;
}

inline HuntLab hunt_lab_from_xyz(const RelativeXyz& v) {
  const float x = lab_curve(v.x), y = lab_curve(v.y), z = lab_curve(v.z);
  const float l = 116.0F * y - 16.0F;
  return {l, 0.01F * l * 500.0F * (x - y), 0.01F * l * 200.0F * (y - z)};
}

}  // namespace macula::metrics
