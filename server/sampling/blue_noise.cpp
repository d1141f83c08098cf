#include "server/sampling/blue_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/math/hash.h"

namespace macula::sampling {
namespace {

constexpr int kSide = BlueNoise::kSide;
constexpr int kPixels = static_cast<int>(BlueNoise::kCount);

/// Which pixels are set, and how crowded each is: the sum over all set pixels of a Gaussian of
/// their distance on the torus. In integers, a pixel set and cleared again leaves no trace.
class Pattern {
 public:
  Pattern() : set_(kPixels, false), crowding_(kPixels, 0) {
    constexpr double kSigma = 1.9;  // pixels
    for (int i = 0; i < kPixels; ++i) {
      const int dx = std::min(i % kSide, kSide - i % kSide);
      const int dy = std::min(i / kSide, kSide - i / kSide);
      const double weight = std::exp(-(dx * dx + dy * dy) / (2.0 * kSigma * kSigma));
      weights_.push_back(static_cast<std::int64_t>(std::lround(weight * 0x1p40)));
    }
  }

  bool is_set(int i) const { return set_[i]; }
  void flip(int i) {
    set_[i] = !set_[i];
    const std::int64_t sign = set_[i] ? 1 : -1;
    for (int y = 0; y < kSide; ++y) {
      const std::int64_t* weights = &weights_[(y - i / kSide + kSide) % kSide * kSide];
      std::int64_t* row = &crowding_[y * kSide];
      for (int x = 0; x < kSide; ++x) row[x] += sign * weights[(x - i % kSide + kSide) % kSide];
    }
  }
  /// The set pixel with the most others around it.
  int tightest_cluster() const { return extreme(true, 1); }
  /// The clear pixel with the fewest set ones around it. Sums over the torus are constant, so this
  /// is also the tightest cluster of clear pixels.
  int largest_void() const { return extreme(false, -1); }

 private:
  int extreme(bool among_set, std::int64_t sign) const {
    int best = -1;
    for (int i = 0; i < kPixels; ++i) {
      if (set_[i] != among_set) continue;
      if (best < 0 || sign * crowding_[i] > sign * crowding_[best]) best = i;
    }
    return best;
  }

  std::vector<bool> set_;
  std::vector<std::int64_t> crowding_, weights_;
};

/// A tenth of the pixels, first by chance, then moved from clusters into voids until none moves.
Pattern start_pattern() {
  Pattern pattern;
  for (int i = 0; i < kPixels; ++i) {
    if (math::unit_float(math::hash_mix(static_cast<std::uint64_t>(i))) < 0.1F) pattern.flip(i);
  }
  for (;;) {
    const int cluster = pattern.tightest_cluster();
    pattern.flip(cluster);
    const int gap = pattern.largest_void();
    pattern.flip(gap);
    if (gap == cluster) return pattern;
  }
}

}  // namespace

BlueNoise::BlueNoise() : ranks_() {
  const Pattern start = start_pattern();
  int set = 0;
  for (int i = 0; i < kPixels; ++i) set += start.is_set(i) ? 1 : 0;
  Pattern pattern = start;
  for (int rank = set - 1; rank >= 0; --rank) {
    const int cluster = pattern.tightest_cluster();
    ranks_[cluster] = static_cast<std::uint16_t>(rank);
    pattern.flip(cluster);
  }
  pattern = start;
  for (int rank = set; rank < kPixels; ++rank) {
    const int gap = pattern.largest_void();
    ranks_[gap] = static_cast<std::uint16_t>(rank);
    pattern.flip(gap);
  }
}

const BlueNoise& BlueNoise::get() {
  static const BlueNoise noise;
  return noise;
}

}  // namespace macula::sampling
