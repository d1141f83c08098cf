#include "server/shading/texture.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "server/shading/texel_codes.h"
#include "shared/base/check.h"

namespace macula::shading {
namespace {

using scene::ColorSpace;
using scene::Wrap;

/// Averages [first, last) of a row or column of texels; partly covered ends count by their share.
struct Span {
  int first;
  float first_share;
  int count;
  float last_share;
};

Span covered_span(int index, int from_size, int to_size) {
  const double scale = static_cast<double>(from_size) / to_size;
  const double begin = index * scale, end = (index + 1) * scale;
  const int first = static_cast<int>(begin);
  const int last = std::min(static_cast<int>(std::ceil(end - 1e-9)), from_size);  // texels
  Span span{first, static_cast<float>(first + 1 - begin), last - first, 0.0F};
  span.last_share = static_cast<float>(end - (last - 1));
  return span;
}

float share(const Span& span, int i) {
  if (span.count == 1) return 1.0F;
  return i == 0 ? span.first_share : (i == span.count - 1 ? span.last_share : 1.0F);
}

struct Size {
  int width, height;
  std::size_t area() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool is_even() const { return width % 2 == 0 && height % 2 == 0; }
  Size halved() const { return {std::max(1, width / 2), std::max(1, height / 2)}; }
};

/// Texels of a level by row-major index.
using Linear = std::vector<Vec4>;

Vec4 decode(const image::Rgba8& p, const float* decoded) {
  return {decoded[p.r], decoded[p.g], decoded[p.b], static_cast<float>(p.a) * (1.0F / 255.0F)};
}

template <class Texel>
Vec4 box_average(const Span& rows, const Span& columns, int width, const Texel& texel) {
  Vec4 sum{0.0F};
  float weight = 0.0F;
  for (int j = 0; j < rows.count; ++j) {
    for (int i = 0; i < columns.count; ++i) {
      const float part = share(rows, j) * share(columns, i);
      sum += part * texel(static_cast<std::size_t>((rows.first + j) * width + columns.first + i));
      weight += part;
    }
  }
  return sum / weight;
}

/// The next level; texel(index) is one of this level. Even sizes, the common case, take the mean of
/// four texels.
template <class Texel>
Linear reduce(Size from, const Texel& texel) {
  const Size to = from.halved();
  Linear result(to.area());
  std::size_t out = 0;
  for (int y = 0; y < to.height; ++y) {
    const Span rows = covered_span(y, from.height, to.height);
    for (int x = 0; x < to.width; ++x) {
      const auto corner = static_cast<std::size_t>(2 * y) * static_cast<std::size_t>(from.width) +
                          static_cast<std::size_t>(2 * x);
      const std::size_t below = corner + static_cast<std::size_t>(from.width);
      result[out++] =
          from.is_even()
              ? 0.25F * ((texel(corner) + texel(corner + 1)) + (texel(below) + texel(below + 1)))
              : box_average(rows, covered_span(x, from.width, to.width), from.width, texel);
    }
  }
  return result;
}

Vec4 mean_of(std::span<const image::Rgba8> texels, const float* decoded) {
  DVec4 sum{0.0};
  for (const image::Rgba8& texel : texels) sum += DVec4(decode(texel, decoded));
  return Vec4(sum / static_cast<double>(texels.size()));
}

/// Into [0, 1], exactly periodic for every representable coordinate.
float wrap_coordinate(float t, Wrap wrap) {
  if (!std::isfinite(t)) return 0.0F;
  switch (wrap) {
    case Wrap::Repeat:
      return t - std::floor(t);
    case Wrap::Clamp:
      return std::clamp(t, 0.0F, 1.0F);
    case Wrap::Mirror: {
      const float period = t - 2.0F * std::floor(0.5F * t);
      return period > 1.0F ? 2.0F - period : period;
    }
  }
  return 0.0F;
}

/// A neighbour one texel outside: the other end when repeating, else the border texel (which is
/// also its own mirror image).
int wrap_texel(int i, int size, Wrap wrap) {
  if (wrap == Wrap::Repeat) return i < 0 ? i + size : (i >= size ? i - size : i);
  return std::clamp(i, 0, size - 1);
}

}  // namespace

Texture::Texture(const image::Plane<image::Rgba8>& pixels, ColorSpace space)
    : decode_(TexelCodes::of(space).decoded()) {
  const bool blank = pixels.empty();
  Size size{blank ? 1 : pixels.width(), blank ? 1 : pixels.height()};
  const std::size_t room = size.area() + size.area() / 3 + 16;
  MACULA_CHECK(room < std::size_t{1} << 31U, "texels are numbered in 31 bits");
  texels_.reserve(room);
  if (blank) texels_.push_back({255, 255, 255, 255});
  texels_.insert(texels_.end(), pixels.pixels().begin(), pixels.pixels().end());
  levels_.push_back({size.width, size.height, 0});
  side_texels_ = std::sqrt(static_cast<float>(size.area()));
  mean_ = mean_of(texels_, decode_);
  Linear linear;
  while (size.area() > 1) {
    linear = levels_.size() == 1
                 ? reduce(size, [this](std::size_t i) { return decode(texels_[i], decode_); })
                 : reduce(size, [&linear](std::size_t i) { return linear[i]; });
    size = size.halved();
    append_level(linear, size.width, size.height, space);
  }
}

void Texture::append_level(const std::vector<Vec4>& linear, int width, int height,
                           ColorSpace space) {
  const TexelCodes& color = TexelCodes::of(space);
  const TexelCodes& plain = TexelCodes::of(ColorSpace::Linear);
  levels_.push_back({width, height, static_cast<std::int32_t>(texels_.size())});
  for (const Vec4& v : linear) {
    texels_.push_back({color.encode(v.x), color.encode(v.y), color.encode(v.z), plain.encode(v.w)});
  }
}

Vec4 Texture::texel(const Level& level, int x, int y) const {
  return decode(texels_[static_cast<std::size_t>(level.first + y * level.width + x)], decode_);
}

Vec4 Texture::bilinear(const Level& level, Vec2 uv, Wrap wrap_u, Wrap wrap_v) const {
  const float x = uv.x * static_cast<float>(level.width) - 0.5F;
  const float y = uv.y * static_cast<float>(level.height) - 0.5F;
  const float left = std::floor(x), top = std::floor(y);
  const float fx = x - left, fy = y - top;
  const int x0 = wrap_texel(static_cast<int>(left), level.width, wrap_u);
  const int x1 = wrap_texel(static_cast<int>(left) + 1, level.width, wrap_u);
  const int y0 = wrap_texel(static_cast<int>(top), level.height, wrap_v);
  const int y1 = wrap_texel(static_cast<int>(top) + 1, level.height, wrap_v);
  const Vec4 upper = (1.0F - fx) * texel(level, x0, y0) + fx * texel(level, x1, y0);
  const Vec4 lower = (1.0F - fx) * texel(level, x0, y1) + fx * texel(level, x1, y1);
  return (1.0F - fy) * upper + fy * lower;
}

Vec4 Texture::sample(Vec2 uv, float footprint_uv, Wrap wrap_u, Wrap wrap_v) const {
  const Vec2 wrapped{wrap_coordinate(uv.x, wrap_u), wrap_coordinate(uv.y, wrap_v)};
  const float level = level_of(footprint_uv);
  if (!(level > 0.0F)) return bilinear(levels_.front(), wrapped, wrap_u, wrap_v);
  const auto finer = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(finer);
  const Vec4 near = bilinear(levels_[finer], wrapped, wrap_u, wrap_v);
  if (finer + 1 == levels_.size()) return near;
  return (1.0F - blend) * near + blend * bilinear(levels_[finer + 1], wrapped, wrap_u, wrap_v);
}

/// 0 for footprints of a texel or less.
float Texture::level_of(float footprint_uv) const {
  const float texels = footprint_uv * side_texels_;
  if (!(texels > 1.0F)) return 0.0F;
  return std::min(std::log2(texels), static_cast<float>(levels_.size() - 1));
}

void Texture::fetch(Vec2 uv, float footprint_uv, Wrap wrap_u, Wrap wrap_v) const {
  const Vec2 wrapped{wrap_coordinate(uv.x, wrap_u), wrap_coordinate(uv.y, wrap_v)};
  const auto finer = static_cast<std::size_t>(level_of(footprint_uv));
  fetch_around(levels_[finer], wrapped);
  if (finer > 0 && finer + 1 < levels_.size()) fetch_around(levels_[finer + 1], wrapped);
}

/// The texel at a place and the one below: the line of either has most of its neighbours.
void Texture::fetch_around(const Level& level, Vec2 uv) const {
  const int x = static_cast<int>(uv.x * static_cast<float>(level.width) - 0.5F);
  const int y = static_cast<int>(uv.y * static_cast<float>(level.height) - 0.5F);
  const int row = std::clamp(y, 0, level.height - 1), column = std::clamp(x, 0, level.width - 1);
  const image::Rgba8* at =
      &texels_[static_cast<std::size_t>(level.first + row * level.width + column)];
  __builtin_prefetch(at);
  if (y + 1 < level.height) __builtin_prefetch(at + level.width);
}

Vec2 transform_uv(const scene::TextureRef& reference, Vec2 uv) {
  const Vec2 scaled = reference.uv_scale * uv;
  if (reference.uv_rotation_rad == 0.0F) return reference.uv_offset + scaled;
  const float c = std::cos(reference.uv_rotation_rad), s = std::sin(reference.uv_rotation_rad);
  return reference.uv_offset + Vec2{c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x};
}

}  // namespace macula::shading
