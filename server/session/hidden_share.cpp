#include "server/session/hidden_share.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shared/codec/tiles.h"

namespace macula::session {
namespace {

using disocclusion::Band;

constexpr double kLeastQuality = 30.0;
constexpr double kLeastKept = 1.0 / 64.0;  ///< so that it comes back within some frames

int tiles_along(int cells) {
  return (cells + codec::Tiles::kSide - 1) / codec::Tiles::kSide;
}

/// Calls work(x, y) for the cells of a tile.
template <class Work>
void for_each_cell(const Band& band, int tile, Work work) {
  constexpr int kSide = codec::Tiles::kSide;
  const int left = tile % tiles_along(band.width()) * kSide;
  const int top = tile / tiles_along(band.width()) * kSide;
  for (int y = top; y < std::min(top + kSide, band.height()); ++y) {
    for (int x = left; x < std::min(left + kSide, band.width()); ++x) work(x, y);
  }
}

/// Empties tiles of the band, those with the fewest cells first, until `kept` of those that have
/// any are left; returns the cells left.
std::size_t thin(Band& band, double kept) {
  struct Tile {
    std::size_t cells;
    int index;
  };
  std::vector<Tile> tiles;
  for (int i = 0; i < tiles_along(band.width()) * tiles_along(band.height()); ++i) {
    std::size_t cells = 0;
    for_each_cell(band, i, [&](int x, int y) { cells += band(x, y) != 0 ? 1 : 0; });
    if (cells > 0) tiles.push_back({cells, i});
  }
  std::ranges::stable_sort(tiles, std::greater{}, &Tile::cells);
  const auto left = static_cast<std::size_t>(std::ceil(kept * static_cast<double>(tiles.size())));
  std::size_t cells = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (i < left) {
      cells += tiles[i].cells;
    } else {
      for_each_cell(band, tiles[i].index, [&](int x, int y) { band(x, y) = 0; });
    }
  }
  return cells;
}

}  // namespace

double next_jpeg_quality(double quality, double bytes, double wanted) {
  constexpr double kStepsPerDouble = 20.0, kMostUp = 5.0, kMostDown = 25.0, kLeast = 10.0;
  const double off = kStepsPerDouble * std::log2(wanted / std::max(bytes, 1.0));
  return std::max(quality + std::clamp(off, -kMostDown, kMostUp), kLeast);
}

void HiddenShare::note_seen(std::size_t bytes) {
  constexpr double kSmoothing = 0.2;
  seen_bytes_ += kSmoothing * (static_cast<double>(bytes) - seen_bytes_);
  last_bytes_ = 0;
}

/// `room`: the bytes allowed over those made.
void HiddenShare::give_way(double room, double least_quality) {
  constexpr double kSafety = 0.9;      // half the tiles have more than half the bytes
  constexpr double kLeastStep = 10.0;  // JPEG's own tables do not shrink
  if (quality_ > least_quality) {
    const double next = next_jpeg_quality(quality_, 1.0, room);
    quality_ = std::max(std::min(next, quality_ - kLeastStep), least_quality);
  } else {
    kept_ *= kSafety * room;
  }
}

void HiddenShare::recover(double room, double most_quality) {
  constexpr double kRise = 1.1;  // a frame
  if (kept_ < 1.0) {
    kept_ = std::min({1.0, kRise * kept_, room * kept_});
  } else {
    quality_ = std::min(next_jpeg_quality(quality_, 1.0, room), most_quality);
  }
}

Result<std::optional<HiddenShare::Coded>> HiddenShare::encode(
    const disocclusion::HiddenLayer& layer, const image::Tone& tone,
    const codec::ColorOptions& options) {
  constexpr int kMostTries = 4;
  const bool is_bound = options.codec == codec::ColorCodec::Jpeg;
  const double asked = options.jpeg_quality, least = std::min(asked, kLeastQuality);
  const double most = kMost / (1.0 - kMost) * seen_bytes_;
  quality_ = quality_ == 0.0 ? asked : std::clamp(quality_, least, asked);
  image::encode(tone, layer.radiance, tone_mapped_);
  Band band = layer.band;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const std::size_t cells = kept_ < 1.0 && is_bound ? thin(band, kept_) : layer.cells;
    codec::ColorOptions now = options;
    now.jpeg_quality = static_cast<int>(std::lround(quality_));
    auto coded = codec::encode_hidden_layer(band, tone_mapped_, layer.depth_m, now);
    if (!coded) return base::forward(coded);
    const double room = most / static_cast<double>(coded->bytes());
    if (!is_bound || room >= 1.0) {
      if (is_bound) recover(room, asked);
      last_bytes_ = coded->bytes();
      return Coded{std::move(*coded), codec::atlas_rect(band), cells};
    }
    give_way(room, least);
    band = layer.band;
  }
  kept_ = std::max(kept_, kLeastKept);
  return std::nullopt;
}

}  // namespace macula::session
