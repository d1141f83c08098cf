#include "client/app/warp_stage.h"

#include <algorithm>

#include "client/app/age_badge.h"
#include "client/app/settle.h"
#include "client/frames/for_each_eye.h"
#include "shared/base/log.h"

namespace macula::client_app {

void WarpStage::make_room(const EyeRig& rig) {
  warpers_.resize(rig.eyes.size());
  hidden_.resize(rig.eyes.size());
  eyes_.inverse_depths_per_m.resize(rig.eyes.size());
  for (std::size_t eye = eyes_.colors.size(); eye < rig.eyes.size(); ++eye) {
    const foveation::Display& display = rig.eyes[eye].display;
    eyes_.colors.emplace_back(display.width_px, display.height_px);
  }
}

std::vector<reprojection::WarpReport> WarpStage::warp(const frames::DecodedFrame& frame,
                                                      const Pose& stage_from_head,
                                                      const EyeRig& rig, double settled) {
  make_room(rig);
  const std::size_t eyes = std::min(rig.eyes.size(), frame.eyes.size());
  std::vector<reprojection::WarpReport> reports(eyes);
  if (on_ == On::Gl) make_passes(eyes);
  const auto warp_one = [&](std::size_t eye) {
    const net::FrameView& view = frame.begin.views[eye];
    const reprojection::SourceView source{view.stage_from_view, view.grid, frame.eyes[eye].color,
                                          frame.eyes[eye].inverse_depth_per_m,
                                          hidden_of(frame, eye)};
    const auto& [head_from_eye, display] = rig.eyes[eye];
    const Pose at = settled_pose(stage_from_head * head_from_eye, view.stage_from_view, settled);
    reports[eye] = on_ == On::Gl ? warp_on_gl(frame, source, at, display, eye)
                                 : warp_eye(source, at, display, eye);
    draw_vignette(eyes_.colors[eye], settled);
  };
  if (on_ == On::Gl || at_once_ == Eyes::OneByOne) {  // a context is this thread's
    for (std::size_t eye = 0; eye < eyes; ++eye) warp_one(eye);
  } else {
    frames::for_each_eye(eyes, warp_one);
  }
  return reports;
}

reprojection::WarpReport WarpStage::warp_eye(const reprojection::SourceView& source, const Pose& at,
                                             const foveation::Display& display, std::size_t eye) {
  const auto report = warpers_[eye].warp(source, at, display, options_, eyes_.colors[eye]);
  if (depth_ == Depth::Keep) warpers_[eye].copy_inverse_depth(eyes_.inverse_depths_per_m[eye]);
  return report;
}

void WarpStage::make_passes(std::size_t eyes) {
  while (passes_.size() < eyes) {
    auto made = display::WarpPass::create();
    if (!made) {
      base::log_warning("frames are warped on the CPU: " + made.error().message());
      on_ = On::Cpu;
      return;
    }
    passes_.push_back({std::move(*made), {}});
  }
}

reprojection::WarpReport WarpStage::warp_on_gl(const frames::DecodedFrame& frame,
                                               const reprojection::SourceView& source,
                                               const Pose& at, const foveation::Display& display,
                                               std::size_t eye) {
  Pass& pass = passes_[eye];
  if (pass.holds != frame.id()) {
    pass.pass->upload(source);
    pass.holds = frame.id();
  }
  return pass.pass->warp(at, display, options_, eyes_.colors[eye]);
}

const reprojection::HiddenPicture* WarpStage::hidden_of(const frames::DecodedFrame& frame,
                                                        std::size_t eye) {
  Hidden& hidden = hidden_[eye];
  if (hidden.of != frame.id()) {
    hidden.of = frame.id();
    hidden.picture.reset();
    const frames::DecodedEye& decoded = frame.eyes[eye];
    if (const auto& layer = decoded.hidden) {
      hidden.picture =
          reprojection::make_hidden_picture(decoded.color, decoded.inverse_depth_per_m, layer->mask,
                                            layer->color, layer->inverse_depth_per_m);
    }
  }
  return hidden.picture ? &*hidden.picture : nullptr;
}

std::optional<reprojection::ErrorBound::Summary> WarpStage::bound(
    const frames::DecodedFrame& frame, const Pose& stage_from_head, const EyeRig& rig,
    const reprojection::PoseDoubt& doubt) const {
  std::optional<reprojection::ErrorBound::Summary> worst;
  for (std::size_t eye = 0; eye < std::min(rig.eyes.size(), frame.eyes.size()); ++eye) {
    const net::FrameView& view = frame.begin.views[eye];
    if (view.depth_residual.empty()) return std::nullopt;
    const reprojection::SourceView source{view.stage_from_view, view.grid, frame.eyes[eye].color,
                                          frame.eyes[eye].inverse_depth_per_m};
    const reprojection::DepthResidual residual{
        view.depth_residual, codec::residual_step_per_m(view.depth_inverse_scale_per_m)};
    const auto& [head_from_eye, display] = rig.eyes[eye];
    const auto summary = reprojection::ErrorBound(source, residual, stage_from_head * head_from_eye,
                                                  display, options_, doubt)
                             .summarise();
    if (!worst || summary.p95_px > worst->p95_px) worst = summary;
  }
  return worst;
}

void WarpStage::mark_age(Nanoseconds age) {
  for (image::Plane<Rgb8>& picture : eyes_.colors) draw_age_badge(picture, age);
}

}  // namespace macula::client_app
