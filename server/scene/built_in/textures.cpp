#include "server/scene/built_in/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "shared/base/parallel.h"
#include "shared/math/hash.h"

namespace macula::scene::built_in {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

/// In [-1, 1), a pure function of the lattice point.
float lattice_value(std::uint64_t seed, int x, int y) {
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) |
                   static_cast<std::uint32_t>(x);
  return 2.0F * math::unit_float(math::hash_combine(seed, key)) - 1.0F;
}

/// Weights of the four lattice points around t in [0, 1): uniform cubic B-spline, which is smooth
/// enough (C2) that no lattice shows in shading.
std::array<float, 4> spline_weights(float t) {
  const float s = 1.0F - t, t2 = t * t, t3 = t2 * t;
  return {s * s * s / 6.0F, (3.0F * t3 - 6.0F * t2 + 4.0F) / 6.0F,
          (-3.0F * t3 + 3.0F * t2 + 3.0F * t + 1.0F) / 6.0F, t3 / 6.0F};
}

struct Tap {
  int cell = 0;
  std::array<float, 4> weights{};
};
std::vector<Tap> taps_across(int size_px, int cells) {
  std::vector<Tap> taps;
  for (int i = 0; i < size_px; ++i) {
    const float at =
        (static_cast<float>(i) + 0.5F) * static_cast<float>(cells) / static_cast<float>(size_px);
    const int cell = static_cast<int>(at);
    taps.push_back({cell, spline_weights(at - static_cast<float>(cell))});
  }
  return taps;
}

/// Calls row(y) for every row of a texture, on all cores.
template <class Row>
void for_each_row(int size_px, const Row& row) {
  base::for_each_index(static_cast<std::size_t>(size_px),
                       [&](std::size_t y) { row(static_cast<int>(y)); });
}

/// Values of a lattice that wraps, three columns more than it has, so that splines find their four.
Field lattice(int cells_x, int cells_y, std::uint64_t seed) {
  Field values(cells_x + 3, cells_y);
  for (int y = 0; y < cells_y; ++y) {
    for (int x = 0; x < cells_x + 3; ++x) values(x, y) = lattice_value(seed, x % cells_x, y);
  }
  return values;
}

/// One octave, added to `field`: splines first down the lattice columns, then along the row.
void add_octave(Field& field, int cells_x, int cells_y, float amplitude, std::uint64_t seed) {
  const std::vector<Tap> across = taps_across(field.width(), cells_x);
  const std::vector<Tap> down = taps_across(field.height(), cells_y);
  const Field values = lattice(cells_x, cells_y, seed);
  for_each_row(field.height(), [&](int y) {
    const Tap& tap = down[static_cast<std::size_t>(y)];
    std::vector<float> column(static_cast<std::size_t>(values.width()));
    for (int k = 0; k < 4; ++k) {
      const float weight = tap.weights[static_cast<std::size_t>(k)];
      const std::span<const float> line = values.row((tap.cell + k) % cells_y);
      for (std::size_t x = 0; x < column.size(); ++x) column[x] += weight * line[x];
    }
    for (float& value : column) value *= amplitude;
    const std::span<float> row = field.row(y);
    for (std::size_t x = 0; x < row.size(); ++x) {
      const float* v = column.data() + across[x].cell;
      const std::array<float, 4>& w = across[x].weights;
      row[x] += w[0] * v[0] + w[1] * v[1] + w[2] * v[2] + w[3] * v[3];
    }
  });
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(255.0F * std::clamp(value, 0.0F, 1.0F) + 0.5F);
}
image::Rgba8 to_pixel(const Vec3& color, float alpha = 1.0F) {
  return {to_byte(color.x), to_byte(color.y), to_byte(color.z), to_byte(alpha)};
}
Vec3 mix(const Palette& palette, float t) {
  return glm::mix(palette.dark, palette.light, std::clamp(t, 0.0F, 1.0F));
}
float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}
float fraction(float x) {
  return x - std::floor(x);
}

/// Calls color(x, y, u, v) for each pixel, rows on all cores; u, v in [0, 1) at its centre.
template <class Color>
Image paint(std::string name, int size_px, const Color& color) {
  Image result{std::move(name), image::Plane<image::Rgba8>(size_px, size_px)};
  for_each_row(size_px, [&](int y) {
    const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(size_px);
    for (int x = 0; x < size_px; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(size_px);
      result.pixels(x, y) = to_pixel(color(x, y, u, v));
    }
  });
  return result;
}

}  // namespace

Field noise(int size_px, const Noise& options, std::uint64_t seed) {
  Field field(size_px, size_px);
  // A B-spline of independent values in [-1, 1) has a standard deviation of about 0.28; 1.8 brings
  // the first octave's peaks near 1, and the geometric sum is normalised away.
  float sum = 0.0F, amplitude = 1.0F;
  for (int octave = 0; octave < options.octaves; ++octave, amplitude *= options.gain)
    sum += amplitude;
  amplitude = 1.8F / sum;
  for (int octave = 0; octave < options.octaves; ++octave, amplitude *= options.gain) {
    const int cells = options.cells << octave;
    const int cells_x = std::min(size_px, cells * static_cast<int>(options.stretch.x));
    const int cells_y = std::min(size_px, cells * static_cast<int>(options.stretch.y));
    add_octave(field, cells_x, cells_y, amplitude,
               math::hash_combine(seed, static_cast<std::uint64_t>(octave)));
  }
  return field;
}

Image colored(std::string name, const Field& field, const Palette& palette) {
  return paint(std::move(name), field.width(),
               [&](int x, int y, float, float) { return mix(palette, field(x, y)); });
}

Image marble(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const Field warp = noise(size_px, {.cells = 2, .octaves = 6, .gain = 0.55F}, seed);
  const Field cloud = noise(size_px, {.cells = 4, .octaves = 3}, seed + 1);
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    // Veins: zero crossings of a warped diagonal wave, thin because of the square root.
    const float wave = std::abs(std::sin(kTurn * (u + v + 1.3F * warp(x, y))));
    const float vein = 1.0F - std::sqrt(wave);
    return mix(palette, 0.85F + 0.25F * cloud(x, y) - 0.9F * vein * vein);
  });
}

Image plaster(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const Field stain = noise(size_px, {.cells = 3, .octaves = 7, .gain = 0.6F}, seed);
  return paint(std::move(name), size_px,
               [&](int x, int y, float, float) { return mix(palette, 0.6F + 0.7F * stain(x, y)); });
}

Image masonry(std::string name, int size_px, const Masonry& options, std::uint64_t seed) {
  const Field grain = noise(size_px, {.cells = 8, .octaves = 6, .gain = 0.6F}, seed);
  const Field wobble = noise(size_px, {.cells = 16, .octaves = 3}, seed + 1);
  const auto columns = static_cast<float>(options.columns),
             courses = static_cast<float>(options.courses);
  const float aspect = courses / columns;
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    const float course = v * courses + 0.04F * wobble(x, y);
    const int course_index = static_cast<int>(std::floor(course)) & (options.courses - 1);
    const float along = u * columns + (course_index % 2 == 0 ? 0.0F : 0.5F);
    const int stone_index = static_cast<int>(std::floor(along)) % options.columns;
    const float from_joint = std::min(0.5F - std::abs(fraction(course) - 0.5F),
                                      aspect * (0.5F - std::abs(fraction(along) - 0.5F)));
    const float tint = lattice_value(seed + 2, stone_index, course_index);
    const Vec3 stone = mix(options.stone, 0.5F + 0.3F * tint + 0.45F * grain(x, y));
    const Vec3 mortar = options.mortar * (1.0F + 0.2F * grain(x, y));
    const float in_stone = smoothstep(0.5F * options.joint, 1.3F * options.joint, from_joint);
    return glm::mix(mortar, stone, in_stone);
  });
}

Image tiles(std::string name, int size_px, const Tiling& options, std::uint64_t seed) {
  const Field cloud = noise(size_px, {.cells = 4, .octaves = 6, .gain = 0.6F}, seed);
  const auto count = static_cast<float>(options.tiles);
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    const int i = static_cast<int>(u * count), j = static_cast<int>(v * count);
    const float from_joint = std::min(0.5F - std::abs(fraction(u * count) - 0.5F),
                                      0.5F - std::abs(fraction(v * count) - 0.5F));
    const Palette& palette = (i + j) % 2 == 0 ? options.first : options.second;
    const float tint = 0.25F * lattice_value(seed + 1, i, j);
    const Vec3 tile = mix(palette, 0.5F + tint + 0.55F * cloud(x, y));
    return tile * (0.45F + 0.55F * smoothstep(0.4F * options.grout, options.grout, from_joint));
  });
}

Image checkerboard(std::string name, int size_px, int checks, const Palette& palette) {
  const auto count = static_cast<float>(checks);
  return paint(std::move(name), size_px, [&](int, int, float u, float v) {
    const bool odd = (static_cast<int>(u * count) + static_cast<int>(v * count)) % 2 != 0;
    return odd ? palette.light : palette.dark;
  });
}

Image wood(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const Field bend = noise(size_px, {.cells = 2, .octaves = 4, .stretch = {3, 1}}, seed);
  const Field fibre =
      noise(size_px, {.cells = 8, .octaves = 4, .gain = 0.7F, .stretch = {8, 1}}, seed + 1);
  return paint(std::move(name), size_px, [&](int x, int y, float u, float) {
    const float ring = fraction(8.0F * u + 2.5F * bend(x, y));
    const float early_late = ring < 0.8F ? ring / 0.8F : (1.0F - ring) / 0.2F;
    return mix(palette, 0.85F - 0.5F * early_late + 0.35F * fibre(x, y));
  });
}

Image fabric(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const Field wear = noise(size_px, {.cells = 4, .octaves = 5}, seed);
  constexpr float kRepeats = 4.0F, kThreads = 128.0F;
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    const float a = kTurn * kRepeats * u, b = kTurn * kRepeats * v;
    const float motif = std::cos(a) + std::cos(b) + 0.8F * std::cos(2.0F * a) * std::cos(b) +
                        0.5F * std::sin(3.0F * b) * std::sin(2.0F * a);
    const float figure = smoothstep(0.1F, 0.35F, motif);
    const float weave = 0.5F * (std::sin(kTurn * kThreads * u) + std::sin(kTurn * kThreads * v));
    return mix(palette, 0.2F + 0.6F * figure + 0.07F * weave + 0.2F * wear(x, y));
  });
}

Image carpet(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const Field wear = noise(size_px, {.cells = 8, .octaves = 6, .gain = 0.65F}, seed);
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    const float edge = std::min(std::min(u, 1.0F - u), std::min(v, 1.0F - v));
    const float a = kTurn * 6.0F * (u - 0.5F), b = kTurn * 6.0F * (v - 0.5F);
    const float medallion =
        std::cos(a) * std::cos(b) + 0.5F * std::cos(2.0F * a + b) * std::cos(a - 2.0F * b);
    float value = smoothstep(-0.1F, 0.1F, medallion) * 0.55F;
    if (edge < 0.12F) value = std::sin(kTurn * edge * 42.0F) > 0.0F ? 0.9F : 0.25F;
    if (edge > 0.05F && edge < 0.09F)
      value = 0.1F + 0.5F * smoothstep(-0.1F, 0.1F, std::cos(4.0F * a) + std::cos(4.0F * b));
    const Vec3 color = mix(palette, value + 0.25F * wear(x, y));
    return color;
  });
}

Image stained_glass(std::string name, int size_px, int cells, std::uint64_t seed) {
  const Field bubbles = noise(size_px, {.cells = 16, .octaves = 5, .gain = 0.6F}, seed);
  const auto count = static_cast<float>(cells);
  constexpr std::array kGlass{Vec3{0.10F, 0.22F, 0.85F}, Vec3{0.85F, 0.10F, 0.12F},
                              Vec3{0.95F, 0.72F, 0.18F}, Vec3{0.12F, 0.60F, 0.30F},
                              Vec3{0.25F, 0.55F, 0.95F}, Vec3{0.90F, 0.88F, 0.80F}};
  return paint(std::move(name), size_px, [&](int x, int y, float u, float v) {
    // Nearest and second nearest of jittered points: where both are as near runs a lead.
    const int cell_x = static_cast<int>(u * count), cell_y = static_cast<int>(v * count);
    float nearest = 9.0F, second = 9.0F, pick = 0.0F;
    for (int j = cell_y - 1; j <= cell_y + 1; ++j) {
      for (int i = cell_x - 1; i <= cell_x + 1; ++i) {
        const Vec2 point{static_cast<float>(i) + 0.5F + 0.45F * lattice_value(seed + 1, i, j),
                         static_cast<float>(j) + 0.5F + 0.45F * lattice_value(seed + 2, i, j)};
        const float distance = length(point - count * Vec2{u, v});
        if (distance >= second) continue;
        second = std::max(distance, nearest);
        if (distance < nearest) nearest = distance, pick = lattice_value(seed + 3, i, j);
      }
    }
    const auto index = static_cast<std::size_t>((0.5F + 0.5F * pick) * kGlass.size());
    const float lead = smoothstep(0.04F, 0.10F, second - nearest);
    return kGlass[std::min(index, kGlass.size() - 1)] * (0.75F + 0.4F * bubbles(x, y)) * lead;
  });
}

namespace {

/// A leaf as a lens: two arcs between base and tip. Signed: > 0 inside, 1 on the midrib.
float leaf_profile(const Vec2& point, const Vec2& base, const Vec2& tip, float width) {
  const Vec2 axis = tip - base;
  const float along = dot(point - base, axis) / dot(axis, axis);
  if (along <= 0.0F || along >= 1.0F) return -1.0F;
  const float across =
      std::abs(axis.x * (point.y - base.y) - axis.y * (point.x - base.x)) / length(axis);
  const float half_width = width * std::sin(0.5F * kTurn * std::pow(along, 0.8F));
  return 1.0F - across / half_width;
}

struct Leaf {
  Vec2 base, tip;
  float width = 0.0F, tint = 0.0F;
};

std::vector<Leaf> leaves_on_a_sprig(std::uint64_t seed) {
  std::vector<Leaf> leaves;
  constexpr int kPairs = 9;
  for (int pair = 0; pair < kPairs; ++pair) {
    for (const int side : {-1, 1}) {
      const float jitter = lattice_value(seed, pair, side);
      const float height = (static_cast<float>(pair) + 0.5F + 0.3F * jitter) / kPairs;
      const float reach = 0.42F * std::sin(0.5F * kTurn * (0.12F + 0.8F * height));
      const Vec2 base{0.5F, 0.04F + 0.8F * height};
      const Vec2 tip = base + Vec2{static_cast<float>(side) * reach, 0.10F + 0.06F * jitter};
      leaves.push_back({base, tip, 0.045F + 0.012F * jitter, lattice_value(seed + 1, pair, side)});
    }
  }
  leaves.push_back({{0.5F, 0.82F}, {0.5F, 0.99F}, 0.045F, 0.0F});
  return leaves;
}

}  // namespace

Image foliage(std::string name, int size_px, const Palette& palette, std::uint64_t seed) {
  const std::vector<Leaf> leaves = leaves_on_a_sprig(seed);
  // Leaf colour everywhere, so that filtering never drags a background colour over the edges.
  Image result{std::move(name),
               image::Plane<image::Rgba8>(size_px, size_px, to_pixel(mix(palette, 0.5F), 0.0F))};
  const auto size = static_cast<float>(size_px);
  for (const Leaf& leaf : leaves) {
    const Vec2 low = size * (glm::min(leaf.base, leaf.tip) - leaf.width);
    const Vec2 high = size * (glm::max(leaf.base, leaf.tip) + leaf.width);
    for (int y = std::max(0, static_cast<int>(low.y));
         y < std::min(size_px, static_cast<int>(high.y) + 1); ++y) {
      for (int x = std::max(0, static_cast<int>(low.x));
           x < std::min(size_px, static_cast<int>(high.x) + 1); ++x) {
        const Vec2 at{(static_cast<float>(x) + 0.5F) / size, (static_cast<float>(y) + 0.5F) / size};
        const float inside = leaf_profile(at, leaf.base, leaf.tip, leaf.width);
        if (inside <= 0.0F) continue;
        const float rib = smoothstep(0.85F, 0.95F, inside);
        result.pixels(x, size_px - 1 - y) =
            to_pixel(mix(palette, 0.45F + 0.3F * leaf.tint + 0.35F * rib));
      }
    }
  }
  for (int y = 0; y < size_px; ++y) {
    for (int x = size_px * 493 / 1000; x < size_px * 507 / 1000; ++x) {
      if (y < size_px / 8) continue;
      result.pixels(x, y) = to_pixel(mix(palette, 0.2F));
    }
  }
  return result;
}

}  // namespace macula::scene::built_in
