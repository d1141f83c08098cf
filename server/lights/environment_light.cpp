#include "server/lights/environment_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "server/sampling/mappings.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

constexpr double kPi = std::numbers::pi;
/// Finer tables choose no better directions than this; they only cost memory.
constexpr int kMostColumns = 1024;

struct Texel {
  float column = 0.0F, row = 0.0F;  ///< texel k covers [k, k + 1)
};
Texel texel_at(const Vec3& direction, int width, int height) {
  const float around = std::atan2(direction.x, -direction.z) / static_cast<float>(2.0 * kPi) + 0.5F;
  const float down = std::acos(std::clamp(direction.y, -1.0F, 1.0F)) / static_cast<float>(kPi);
  return {around * static_cast<float>(width), down * static_cast<float>(height)};
}

int cell_of(float texel, int texels_a_cell, int cells) {
  return std::clamp(static_cast<int>(texel) / texels_a_cell, 0, cells - 1);
}

/// Which stretch of [0, 1) holds u, and where in it, in [0, 1).
struct Place {
  int index = 0;
  float within = 0.0F, share = 1.0F;
};
Place find(std::span<const float> ends, float u) {
  const auto found = std::upper_bound(ends.begin(), ends.end() - 1, u);
  Place place;
  place.index = static_cast<int>(found - ends.begin());
  const float before = place.index == 0 ? 0.0F : ends[static_cast<std::size_t>(place.index) - 1];
  place.share = *found - before;
  constexpr float kBelowOne = 1.0F - 0x1p-24F;
  if (place.share > 0.0F) place.within = std::clamp((u - before) / place.share, 0.0F, kBelowOne);
  return place;
}

/// Weights become cumulative shares that end at exactly 1; where all are zero, equal ones.
double accumulate(std::span<const double> weights, std::span<float> ends) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0.0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
    ends[i] = static_cast<float>(std::min(sum, 1.0));
  }
  ends.back() = 1.0F;
  return total;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const scene::Environment& environment)
    : radiance_(environment.radiance),
      cos_yaw_(static_cast<float>(std::cos(environment.yaw.value()))),
      sin_yaw_(static_cast<float>(std::sin(environment.yaw.value()))) {
  MACULA_CHECK(!radiance_.empty(), "an environment has at least one texel");
  for (Rgb& value : radiance_.pixels()) value *= environment.scale;
  if (!environment.is_constant()) make_table();
}

/// Turned back by the yaw.
Vec3 EnvironmentLight::in_picture(const Vec3& d) const {
  return {cos_yaw_ * d.x - sin_yaw_ * d.z, d.y, sin_yaw_ * d.x + cos_yaw_ * d.z};
}

/// Columns go round, rows end at the poles.
Rgb EnvironmentLight::texel(int x, int y) const {
  const int width = radiance_.width();
  return radiance_((x + width) % width, std::clamp(y, 0, radiance_.height() - 1));
}

Rgb EnvironmentLight::radiance(const Vec3& direction) const {
  if (is_constant()) return radiance_(0, 0);
  const Texel at = texel_at(in_picture(direction), radiance_.width(), radiance_.height());
  const float x = at.column - 0.5F, y = at.row - 0.5F;
  const float left = std::floor(x), top = std::floor(y), fx = x - left, fy = y - top;
  const int x0 = static_cast<int>(left), y0 = static_cast<int>(top);
  const Rgb upper = (1.0F - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0);
  const Rgb lower = (1.0F - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1);
  return (1.0F - fy) * upper + fy * lower;
}

float EnvironmentLight::cell_solid_angle(int column, int row) const {
  const int width = radiance_.width();
  const int texels = std::min((column + 1) * texels_, width) - column * texels_;
  const auto above = static_cast<std::size_t>(row);
  return static_cast<float>(2.0 * kPi * texels / width * (cosines_[above] - cosines_[above + 1]));
}

/// Luminance x solid angle. A bilinear picture's mean over a texel takes 1/8 of each neighbour
/// along an axis and 6/8 of the texel itself: positive wherever the picture is, next to a bright
/// texel too.
double EnvironmentLight::cell_weight(int column, int row) const {
  constexpr double kShares[] = {0.125, 0.75, 0.125};
  double sum = 0.0;
  for (int y = row * texels_; y < std::min((row + 1) * texels_, radiance_.height()); ++y) {
    const double height =
        std::cos(kPi * y / radiance_.height()) - std::cos(kPi * (y + 1) / radiance_.height());
    for (int x = column * texels_; x < std::min((column + 1) * texels_, radiance_.width()); ++x) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          sum += height * kShares[i + 1] * kShares[j + 1] * image::luminance(texel(x + i, y + j));
        }
      }
    }
  }
  return sum;
}

void EnvironmentLight::make_table() {
  const int longest = std::max(radiance_.width(), 2 * radiance_.height());
  texels_ = (longest + kMostColumns - 1) / kMostColumns;
  columns_ = (radiance_.width() + texels_ - 1) / texels_;
  rows_ = (radiance_.height() + texels_ - 1) / texels_;
  const auto columns = static_cast<std::size_t>(columns_), rows = static_cast<std::size_t>(rows_);
  for (int row = 0; row <= rows_; ++row) {
    const int texels = std::min(row * texels_, radiance_.height());
    cosines_.push_back(std::cos(kPi * texels / radiance_.height()));
  }
  cells_.resize(columns * rows);
  row_ends_.resize(rows);
  std::vector<double> row_weights(rows), weights(columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      weights[column] = cell_weight(static_cast<int>(column), static_cast<int>(row));
    }
    row_weights[row] = accumulate(weights, {cells_.data() + row * columns, columns});
  }
  accumulate(row_weights, row_ends_);
}

EnvironmentSample EnvironmentLight::sample(const Vec2& u) const {
  if (is_constant()) {
    return {sampling::uniform_sphere(u), static_cast<float>(1.0 / (4.0 * kPi))};
  }
  const Place row = find(row_ends_, u.y);
  const float* first = cells_.data() + static_cast<std::ptrdiff_t>(row.index) * columns_;
  const Place column = find({first, static_cast<std::size_t>(columns_)}, u.x);
  const double width = radiance_.width();
  const double begin = column.index * texels_, end = std::min(begin + texels_, width);
  const double around = (begin + column.within * (end - begin)) / width - 0.5;
  const auto above = static_cast<std::size_t>(row.index);
  const double top = cosines_[above], bottom = cosines_[above + 1];
  const double y = top + row.within * (bottom - top);
  const double radius = std::sqrt(std::max(0.0, 1.0 - y * y));
  const Vec3 d(radius * std::sin(2.0 * kPi * around), y, -radius * std::cos(2.0 * kPi * around));
  return {{cos_yaw_ * d.x + sin_yaw_ * d.z, d.y, cos_yaw_ * d.z - sin_yaw_ * d.x},
          row.share * column.share / cell_solid_angle(column.index, row.index)};
}

float EnvironmentLight::pdf(const Vec3& direction) const {
  if (is_constant()) return static_cast<float>(1.0 / (4.0 * kPi));
  const Texel at = texel_at(in_picture(direction), radiance_.width(), radiance_.height());
  const int column = cell_of(at.column, texels_, columns_), row = cell_of(at.row, texels_, rows_);
  const auto share = [](const float* ends, int i) {
    return ends[i] - (i == 0 ? 0.0F : ends[i - 1]);
  };
  return share(row_ends_.data(), row) *
         share(cells_.data() + static_cast<std::ptrdiff_t>(row) * columns_, column) /
         cell_solid_angle(column, row);
}

}  // namespace macula::lights
