#include "server/session/encode_stage.h"

#include <memory>
#include <thread>
#include <utility>

#include "shared/image/tone.h"

namespace macula::session {
namespace {

net::Payload as_payload(std::vector<std::byte> bytes) {
  return std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

net::SliceEntry slice(std::size_t eye, net::PlaneKind plane, net::SliceCodec codec,
                      const image::Rect& rect, std::size_t bytes) {
  net::SliceEntry entry;
  entry.eye = static_cast<std::uint32_t>(eye);
  entry.plane = plane;
  entry.codec = codec;
  entry.rect = rect;
  entry.size_bytes = static_cast<std::uint32_t>(bytes);
  return entry;
}

net::FrameEnd frame_end(const FrameJob& job) {
  net::FrameEnd end;
  end.epoch = job.start.key.epoch;
  end.frame = job.start.key.frame;
  end.view_received = job.start.view_received;
  end.render_begin = job.render_begin;
  end.render_end = end.encode_begin = job.render_end;
  end.encode_end = job.encode_end;
  end.rays = job.report.primary_rays + job.report.shadow_rays;
  end.cells = job.cells;
  return end;
}

}  // namespace

codec::ColorOptions EncodeStage::color_options(const net::Settings& wish) const {
  codec::ColorOptions options;
  options.codec =
      wish.color_codec == "lossless" ? codec::ColorCodec::Lossless : codec::ColorCodec::Jpeg;
  options.jpeg_quality = wish.jpeg_quality != 0 ? wish.jpeg_quality : config_.jpeg_quality;
  return options;
}

void EncodeStage::encode_eye(const FrameJob& job, std::size_t index) {
  const kernels::ViewBuffers& rendered = job.buffers.views[index];
  Eye& eye = eyes_[index];
  image::encode(job.views[index].tone, rendered.radiance, eye.tone_mapped);
  eye.color = codec::encode_color(eye.tone_mapped, eye.tone_mapped.rect(),
                                  color_options(job.start.setup->settings));
  eye.depth = codec::encode_depth(rendered.depth_m);
}

net::FrameBegin EncodeStage::frame_begin(const FrameJob& job) const {
  const net::ViewState& view = job.start.view;
  net::FrameBegin begin;
  begin.epoch = job.start.key.epoch;
  begin.frame = job.start.key.frame;
  begin.view_sequence = view.sequence;
  begin.view_sampled = view.sampled;
  begin.view_predicted_display = view.predicted_display;
  begin.gaze_sampled = view.gaze_sampled;
  begin.horizon = job.start.horizon;
  begin.guard_band = job.guard_band;
  begin.kernel = config_.offer.kernel;
  begin.config = config_.description;
  begin.seed = config_.seed;
  begin.scene_time = job.scene_time.since_start;
  begin.settings_generation = job.start.setup->settings.generation;
  return begin;
}

void EncodeStage::append_eye(const FrameJob& job, std::size_t index, net::EncodedFrame& frame) {
  Eye& eye = eyes_[index];
  const net::EyeState& state = job.start.view.eyes[index];
  net::FrameView view;
  view.stage_from_view = job.start.view.stage_from_head * state.head_from_eye;
  view.display_fov = state.fov;
  view.gaze = job.views[index].gaze;
  view.grid = job.views[index].grid;
  view.tone = job.views[index].tone;
  view.depth_inverse_scale_per_m = eye.depth->inverse_scale_per_m;
  view.depth_residual = std::move(eye.depth->residual);
  frame.begin.views.push_back(std::move(view));

  const bool lossless =
      color_options(job.start.setup->settings).codec == codec::ColorCodec::Lossless;
  const image::Rect rect = eye.tone_mapped.rect();
  frame.begin.slices.push_back(slice(index, net::PlaneKind::Color,
                                     lossless ? net::SliceCodec::Lossless : net::SliceCodec::Jpeg,
                                     rect, eye.color->size()));
  frame.payloads.push_back(as_payload(std::move(*eye.color)));
  frame.begin.slices.push_back(slice(index, net::PlaneKind::Depth, net::SliceCodec::InverseDepth,
                                     rect, eye.depth->bytes.size()));
  frame.payloads.push_back(as_payload(std::move(eye.depth->bytes)));
}

Result<net::EncodedFrame> EncodeStage::encode(FrameJob& job) {
  eyes_.resize(job.views.size());
  threads_.run(job.views.size(), [&](std::size_t index) { encode_eye(job, index); });
  for (const Eye& eye : eyes_) {
    if (!eye.color) return base::forward(eye.color);
    if (!eye.depth) return base::forward(eye.depth);
  }
  net::EncodedFrame frame;
  frame.begin = frame_begin(job);
  for (std::size_t index = 0; index < eyes_.size(); ++index) append_eye(job, index, frame);
  std::this_thread::sleep_for(config_.delays.encode);
  job.encode_end = ServerTime{clock_.now()};
  frame.end = frame_end(job);
  return frame;
}

}  // namespace macula::session
