#include <algorithm>
#include <cmath>

#include "shared/base/text.h"
#include "shared/net/wire.h"
#include "shared/net/wire_parts.h"

namespace macula::net {
namespace {

using base::bad_input;
using base::concat;

Result<void> check_pose(const Pose& pose, const std::string& where) {
  if (is_valid(pose)) return {};
  return bad_input("not a pose", where, "finite, within 1e7 m, a unit quaternion");
}

Result<void> check_fov(const Fov& fov, const std::string& where) {
  // Grids end at tangents of 1e3; a field of view that needs more cannot be rendered.
  constexpr double kMostTangent = 1e3;
  if (is_valid(fov)) {
    const DVec2 least = fov.tangent_min(), most = fov.tangent_max();
    const double farthest =
        std::max({std::abs(least.x), std::abs(least.y), std::abs(most.x), std::abs(most.y)});
    if (farthest < kMostTangent) return {};
  }
  return bad_input("not a field of view", where,
                   "half-angles inside +-89.9 degrees, left < right, down < up");
}

Result<void> check_gaze(const Gaze& gaze, const std::string& where) {
  constexpr float kUnitTolerance = 1e-3F;
  const bool is_unit = math::is_finite(gaze.direction) &&
                       std::abs(glm::length(gaze.direction) - 1.0F) < kUnitTolerance;
  if (is_unit && gaze.confidence >= 0.0F && gaze.confidence <= 1.0F) return {};
  return bad_input("not a gaze", where, "a unit vector, confidence in [0, 1]");
}

Result<void> check_grid(const FrameView& view, const std::string& where, const Limits& limits) {
  if (view.grid_frame != 0) return {};  // checked again once it is known
  const PixelGrid& grid = view.grid;
  if (!is_valid(grid)) {
    return bad_input("not a grid", where, "finite edges, strictly increasing, within +-1e3");
  }
  if (grid.width() > limits.max_side_px || grid.height() > limits.max_side_px) {
    return bad_input(concat(grid.width(), " x ", grid.height(), " cells"), where,
                     concat("at most ", limits.max_side_px, " a side"));
  }
  const std::size_t blocks = static_cast<std::size_t>((grid.width() + 7) / 8) *
                             static_cast<std::size_t>((grid.height() + 7) / 8);
  if (!view.depth_residual.empty() && view.depth_residual.size() != blocks) {
    return bad_input(concat(view.depth_residual.size(), " depth residuals"), where,
                     concat("none, or one per 8x8 block: ", blocks));
  }
  return {};
}

Result<void> check_view(const FrameView& view, const std::string& where, const Limits& limits) {
  constexpr float kMostExposure_ev = 64.0F;
  for (const auto& checked :
       {check_pose(view.stage_from_view, where + ".stage_from_view"),
        check_fov(view.display_fov, where + ".display_fov"), check_gaze(view.gaze, where + ".gaze"),
        check_grid(view, where + ".grid", limits)}) {
    if (!checked) return checked;
  }
  if (!(std::abs(view.tone.exposure_ev) <= kMostExposure_ev)) {
    return bad_input(concat(view.tone.exposure_ev), where + ".tone.exposure_ev", "within +-64");
  }
  for (const float scale :
       {view.depth_inverse_scale_per_m, view.hidden_depth_inverse_scale_per_m}) {
    if (!std::isfinite(scale) || scale < 0.0F) {
      return bad_input(concat(scale), where + ".depth_inverse_scale_per_m", "finite, not negative");
    }
  }
  return {};
}

/// The plane a codec is for.
PlaneKind plane_of(SliceCodec codec) {
  switch (codec) {
    case SliceCodec::InverseDepth:
      return PlaneKind::Depth;
    case SliceCodec::BandMask:
      return PlaneKind::Mask;
    default:
      return PlaneKind::Color;
  }
}

/// What a slice's rectangle must lie in: the grid, or for an atlas whole tiles of it.
image::Rect bounds_of(const SliceEntry& slice, const PixelGrid& grid) {
  const bool is_atlas = slice.layer > 0 && slice.plane == PlaneKind::Color;
  constexpr int kTile = 16;
  const auto side = [&](int cells) {
    return is_atlas ? (cells + kTile - 1) / kTile * kTile : cells;
  };
  return {0, 0, side(grid.width()), side(grid.height())};
}

Result<void> check_slice(const SliceEntry& slice, const std::string& where,
                         const FrameBegin& begin) {
  constexpr std::uint32_t kLastLayer = 2;
  if (slice.eye >= begin.views.size() || slice.layer > kLastLayer) {
    return bad_input(concat("eye ", slice.eye, ", layer ", slice.layer), where,
                     concat("one of ", begin.views.size(), " views, layers 0..2"));
  }
  if (plane_of(slice.codec) != slice.plane) return bad_input("a codec of another plane", where);
  const bool is_known = begin.views[slice.eye].grid_frame == 0;
  const PixelGrid& grid = begin.views[slice.eye].grid;
  const image::Rect& rect = slice.rect;
  const image::Rect bounds = is_known ? bounds_of(slice, grid) : image::Rect{};
  if (is_known && (rect.x < 0 || rect.y < 0 || rect.width < 1 || rect.height < 1 ||
                   rect.width > bounds.width - rect.x || rect.height > bounds.height - rect.y)) {
    return bad_input(concat(rect.width, "x", rect.height, "+", rect.x, "+", rect.y),
                     where + ".rect",
                     concat("inside the grid of ", grid.width(), "x", grid.height(), " cells"));
  }
  if (slice.size_bytes == 0) return bad_input("empty", where + ".size_bytes", "at least 1");
  return {};
}

Result<void> check_directory(const FrameBegin& begin, const Limits& limits) {
  if (begin.slices.size() > limits.max_slices) {
    return bad_input(concat(begin.slices.size(), " slices"), "frame_begin.slices",
                     concat("at most ", limits.max_slices));
  }
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < begin.slices.size(); ++i) {
    const std::string where = concat("frame_begin.slices[", i, "]");
    if (auto checked = check_slice(begin.slices[i], where, begin); !checked) return checked;
    bytes += begin.slices[i].size_bytes;
  }
  if (bytes > limits.max_frame_bytes) {
    return bad_input(concat(bytes, " bytes"), "frame_begin.slices",
                     concat("at most ", limits.max_frame_bytes, " a frame"));
  }
  return {};
}

Result<void> check_views(const FrameBegin& begin, const Limits& limits) {
  if (begin.views.empty() || begin.views.size() > static_cast<std::size_t>(limits.max_views)) {
    return bad_input(concat(begin.views.size(), " views"), "frame_begin.views",
                     concat("1..", limits.max_views));
  }
  std::size_t cells = 0;
  for (std::size_t i = 0; i < begin.views.size(); ++i) {
    const std::string where = concat("frame_begin.views[", i, "]");
    if (auto checked = check_view(begin.views[i], where, limits); !checked) return checked;
    const PixelGrid& grid = begin.views[i].grid;
    if (begin.views[i].grid_frame != 0) continue;
    cells += static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.height());
  }
  if (cells > limits.max_cells) {
    return bad_input(concat(cells, " cells"), "frame_begin.views",
                     concat("at most ", limits.max_cells, " a frame"));
  }
  return {};
}

bool times_are_plausible(const FrameBegin& begin) {
  using wire::is_plausible;
  return is_plausible(begin.view_sampled) && is_plausible(begin.view_predicted_display) &&
         is_plausible(begin.gaze_sampled) && is_plausible(begin.horizon) &&
         is_plausible(begin.previous_send_begin) && is_plausible(begin.previous_send_end);
}

}  // namespace

Result<void> check_view_state(const ViewState& view) {
  if (view.eyes.empty() || view.eyes.size() > 2) {
    return bad_input(concat(view.eyes.size(), " eyes"), "view_state.eyes", "1..2");
  }
  for (const ClientTime time : {view.sampled, view.predicted_display, view.gaze_sampled}) {
    if (!wire::is_plausible(time)) return bad_input("time beyond 73 years", "view_state");
  }
  if (auto pose = check_pose(view.stage_from_head, "view_state.stage_from_head"); !pose)
    return pose;
  for (std::size_t i = 0; i < view.eyes.size(); ++i) {
    const EyeState& eye = view.eyes[i];
    const std::string where = concat("view_state.eyes[", i, "]");
    for (const auto& checked :
         {check_pose(eye.head_from_eye, where + ".head_from_eye"),
          check_fov(eye.fov, where + ".fov"), check_gaze(eye.gaze, where + ".gaze")}) {
      if (!checked) return checked;
    }
  }
  return {};
}

Result<void> check_frame_begin(const FrameBegin& begin, const Limits& limits) {
  constexpr double kMostGuardBand_rad = 1.57;
  if (begin.frame == 0) return bad_input("frame 0", "frame_begin.frame", "counts from 1");
  if (!times_are_plausible(begin)) return bad_input("time beyond 73 years", "frame_begin");
  const double guard = begin.guard_band.value();
  if (!(guard >= 0.0 && guard < kMostGuardBand_rad)) {
    return bad_input(concat(guard), "frame_begin.guard_band_rad", "0..1.57");
  }
  constexpr double kMostViewCell_m = 10.0;
  if (!(begin.view_cell_m >= 0.0 && begin.view_cell_m <= kMostViewCell_m)) {
    return bad_input(concat(begin.view_cell_m), "frame_begin.view_cell_m", "0..10");
  }
  if (auto checked = check_views(begin, limits); !checked) return checked;
  for (const InstanceMotion& motion : begin.motions) {
    auto pose = check_pose(motion.stage_from_before, "frame_begin.motions");
    if (!pose) return pose;
  }
  return check_directory(begin, limits);
}

}  // namespace macula::net
