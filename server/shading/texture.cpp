#include "server/shading/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/image/tone.h"

namespace macula::shading {
namespace {

using scene::ColorSpace;
using scene::Wrap;

using DecodeTable = std::array<float, 256>;

const DecodeTable& decode_table(ColorSpace space) {
  static const auto make = [](auto decode) {
    DecodeTable table{};
    for (std::size_t code = 0; code < table.size(); ++code) {
      table[code] = decode(static_cast<float>(code) / 255.0F);
    }
    return table;
  };
  static const DecodeTable srgb = make([](float code) { return image::linear_from_srgb(code); });
  static const DecodeTable linear = make([](float code) { return code; });
  return space == ColorSpace::Srgb ? srgb : linear;
}

std::uint8_t quantise(float unit) {
  return static_cast<std::uint8_t>(std::clamp(unit, 0.0F, 1.0F) * 255.0F + 0.5F);
}

image::Rgba8 encode(const Vec4& linear, ColorSpace space) {
  const auto channel = [space](float value) {
    return quantise(space == ColorSpace::Srgb ? image::srgb_from_linear(value) : value);
  };
  return {channel(linear.x), channel(linear.y), channel(linear.z), quantise(linear.w)};
}

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

std::vector<Vec4> box_reduce(const std::vector<Vec4>& from, int width, int height, int to_width,
                             int to_height) {
  std::vector<Vec4> to(static_cast<std::size_t>(to_width) * static_cast<std::size_t>(to_height));
  for (int y = 0; y < to_height; ++y) {
    const Span rows = covered_span(y, height, to_height);
    for (int x = 0; x < to_width; ++x) {
      const Span columns = covered_span(x, width, to_width);
      Vec4 sum{0.0F};
      float weight = 0.0F;
      for (int j = 0; j < rows.count; ++j) {
        for (int i = 0; i < columns.count; ++i) {
          const float part = share(rows, j) * share(columns, i);
          sum +=
              part * from[static_cast<std::size_t>((rows.first + j) * width + columns.first + i)];
          weight += part;
        }
      }
      to[static_cast<std::size_t>(y * to_width + x)] = sum / weight;
    }
  }
  return to;
}

std::vector<Vec4> decode_all(const image::Plane<image::Rgba8>& pixels, const float* decode) {
  std::vector<Vec4> linear;
  linear.reserve(pixels.size());
  for (const image::Rgba8& p : pixels.pixels()) {
    linear.emplace_back(decode[p.r], decode[p.g], decode[p.b], static_cast<float>(p.a) / 255.0F);
  }
  return linear;
}

Vec4 mean_of(const std::vector<Vec4>& linear) {
  DVec4 sum{0.0};
  for (const Vec4& value : linear) sum += DVec4(value);
  return Vec4(sum / static_cast<double>(linear.size()));
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
    : decode_(decode_table(space).data()) {
  const bool blank = pixels.empty();
  int width = blank ? 1 : pixels.width(), height = blank ? 1 : pixels.height();
  std::vector<Vec4> linear = blank ? std::vector<Vec4>{Vec4{1.0F}} : decode_all(pixels, decode_);
  side_texels_ = std::sqrt(static_cast<float>(width) * static_cast<float>(height));
  mean_ = mean_of(linear);
  append_level(linear, width, height, space);
  while (width > 1 || height > 1) {
    const int next_width = std::max(1, width / 2), next_height = std::max(1, height / 2);
    linear = box_reduce(linear, width, height, next_width, next_height);
    width = next_width, height = next_height;
    append_level(linear, width, height, space);
  }
}

void Texture::append_level(const std::vector<Vec4>& linear, int width, int height,
                           ColorSpace space) {
  levels_.push_back({width, height, texels_.size()});
  for (const Vec4& value : linear) texels_.push_back(encode(value, space));
}

Vec4 Texture::texel(const Level& level, int x, int y) const {
  const auto offset = static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
                      static_cast<std::size_t>(x);
  const image::Rgba8 p = texels_[level.first + offset];
  return {decode_[p.r], decode_[p.g], decode_[p.b], static_cast<float>(p.a) * (1.0F / 255.0F)};
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
  const float texels = footprint_uv * side_texels_;
  if (!(texels > 1.0F)) return bilinear(levels_.front(), wrapped, wrap_u, wrap_v);
  const float last = static_cast<float>(levels_.size() - 1);
  const float level = std::min(std::log2(texels), last);
  const auto finer = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(finer);
  const Vec4 near = bilinear(levels_[finer], wrapped, wrap_u, wrap_v);
  if (finer + 1 == levels_.size()) return near;
  return (1.0F - blend) * near + blend * bilinear(levels_[finer + 1], wrapped, wrap_u, wrap_v);
}

Vec2 transform_uv(const scene::TextureRef& reference, Vec2 uv) {
  const Vec2 scaled = reference.uv_scale * uv;
  if (reference.uv_rotation_rad == 0.0F) return reference.uv_offset + scaled;
  const float c = std::cos(reference.uv_rotation_rad), s = std::sin(reference.uv_rotation_rad);
  return reference.uv_offset + Vec2{c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x};
}

}  // namespace macula::shading
