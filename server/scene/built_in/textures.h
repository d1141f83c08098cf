// Procedural pictures that tile: noise with a stated period and the materials of a building made of
// it. Pure functions of (seed, size); colours are display-encoded (sRGB), 8 bits.
#pragma once

#include <cstdint>
#include <string>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

using Field = image::Plane<float>;

struct Noise {
  int cells = 4;      ///< lattice cells across the picture in the first octave
  int octaves = 5;    ///< each with twice the cells of the one before
  float gain = 0.5F;  ///< amplitude ratio of successive octaves; 0.5 gives a 1/f amplitude spectrum
  Vec2 stretch{1.0F};  ///< multiplies the cells along x and y; whole numbers
};
/// Sum of cubic B-spline value noise, periodic, about zero mean, within about [-1, 1].
Field noise(int size_px, const Noise& options, std::uint64_t seed);

/// Colours in sRGB, [0, 1] a channel.
struct Palette {
  Vec3 dark, light;
};
/// A picture from a scalar in [0, 1]: from dark to light.
Image colored(std::string name, const Field& field, const Palette& palette);

Image marble(std::string name, int size_px, const Palette& palette, std::uint64_t seed);
Image plaster(std::string name, int size_px, const Palette& palette, std::uint64_t seed);
/// Courses of bricks (or ashlar) in running bond with mortar between them.
struct Masonry {
  int columns = 4, courses = 8;  ///< both even
  float joint = 0.04F;           ///< joint width as a share of a course's height
  Palette stone;
  Vec3 mortar{0.6F};
};
Image masonry(std::string name, int size_px, const Masonry& options, std::uint64_t seed);
/// Square tiles, alternately of two colours, with grout.
struct Tiling {
  int tiles = 4;  ///< along each side; even
  float grout = 0.02F;
  Palette first, second;
};
Image tiles(std::string name, int size_px, const Tiling& options, std::uint64_t seed);
/// Two colours and nothing between them; `checks` along each side, even.
Image checkerboard(std::string name, int size_px, int checks, const Palette& palette);
Image wood(std::string name, int size_px, const Palette& palette, std::uint64_t seed);
/// Woven threads with a damask-like repeat.
Image fabric(std::string name, int size_px, const Palette& palette, std::uint64_t seed);
/// A carpet: field, medallions and border stripes; does not tile.
Image carpet(std::string name, int size_px, const Palette& palette, std::uint64_t seed);
/// Pieces of coloured glass between dark leads, about `cells` pieces across.
Image stained_glass(std::string name, int size_px, int cells, std::uint64_t seed);
/// Leaves on twigs with alpha 0 between them; the stem rises from the bottom centre.
Image foliage(std::string name, int size_px, const Palette& palette, std::uint64_t seed);

}  // namespace macula::scene::built_in
