#include "shared/codec/h264_canvas.h"

#include <algorithm>

namespace macula::codec {
namespace {

constexpr int kStep_px = 32;  // two macroblocks: chroma's rows are whole ones too
constexpr Nanoseconds kRest = std::chrono::seconds{2};

int rounded_up(int px) {
  return (px + kStep_px - 1) / kStep_px * kStep_px;
}

}  // namespace

bool CanvasSize::grow(Side& side, int needed) {
  side.most_lately = std::max(side.most_lately, needed);
  if (needed <= side.size) return false;
  // A little more than needed, so that a gaze on its way asks once and not at every step.
  side.size = rounded_up(side.size == 0 ? needed : needed + needed / 16);
  return true;
}

bool CanvasSize::shrink(Side& side) {
  const int wanted = rounded_up(side.most_lately);
  const bool smaller = 4 * wanted <= 3 * side.size;
  if (smaller) side.size = wanted;
  side.most_lately = 0;
  return smaller;
}

bool CanvasSize::fit(int width_px, int height_px, Nanoseconds now) {
  const bool wider = grow(across_, width_px), higher = grow(down_, height_px);
  if (wider || higher) {
    since_ = now;
    return true;
  }
  if (now - since_ < kRest) return false;
  since_ = now;
  const bool narrower = shrink(across_), lower = shrink(down_);
  return narrower || lower;
}

}  // namespace macula::codec
