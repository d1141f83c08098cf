// BlueNoise: a threshold for every pixel, spread so that the pixels below any level lie evenly: no
// clumps, no gaps, no lattice. A 64 x 64 square that repeats without a seam, made by the
// void-and-cluster method (Ulichney 1993) in integers, so that it has the same bits everywhere.
// From frame to frame all thresholds move by the golden ratio, modulo 1: a pixel comes below level
// p in a share p of all frames, and never waits long (at most 34 frames for p = 0.05, where
// independent draws make one pixel in a hundred wait 90). Immutable; safe from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace macula::sampling {

class BlueNoise {
 public:
  static constexpr int kSide = 64;
  static constexpr std::uint32_t kCount = kSide * kSide;

  /// The one square there is; the first call makes it (about 0.1 s).
  static const BlueNoise& get();

  /// Place of a pixel in the order of the square: every number below kCount once.
  std::uint32_t rank(int x, int y) const { return ranks_[index(x, y)]; }
  /// Ranks of the kSide pixels of a row, which repeat.
  std::span<const std::uint16_t, kSide> row(int y) const {
    return std::span<const std::uint16_t, kSide>(&ranks_[index(0, y)], kSide);
  }
  /// How far thresholds have moved until a frame, in units of 2^-32.
  static std::uint32_t moved(std::uint64_t frame) {
    constexpr std::uint32_t kGolden = 0x9E3779B9U;  // (sqrt(5) - 1) / 2
    return static_cast<std::uint32_t>(frame) * kGolden;
  }
  /// In [0, 1), for any pixel and frame: `threshold < p` selects a share p of the pixels.
  float threshold(int x, int y, std::uint64_t frame) const {
    const std::uint32_t level = (2U * rank(x, y) + 1U) * (0x80000000U / kCount) + moved(frame);
    return static_cast<float>(level >> 8U) * 0x1p-24F;
  }

 private:
  BlueNoise();
  static std::uint32_t index(int x, int y) {
    const auto wrap = [](int v) { return static_cast<std::uint32_t>(v) % kSide; };
    return wrap(y) * kSide + wrap(x);
  }

  std::array<std::uint16_t, kCount> ranks_;
};

}  // namespace macula::sampling
