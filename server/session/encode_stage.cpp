#include "server/session/encode_stage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>

#include "shared/base/cpu_time.h"
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

/// Whether the link carries what only serves to tell how exact the depth is: a byte for 8x8 cells.
bool affords_residual(const FrameJob& job) {
  constexpr double kMostShare = 0.05;
  const std::size_t bound = job.start.quality.bytes.color_bytes;
  return bound == 0 ||
         static_cast<double>(job.cells) / 64.0 <= kMostShare * static_cast<double>(bound);
}

/// The second layer leans on no other frame, whatever the first one does.
net::SliceCodec hidden_codec(net::SliceCodec seen) {
  return seen == net::SliceCodec::Lossless ? seen : net::SliceCodec::Jpeg;
}

}  // namespace

EncodeStage::Plan EncodeStage::plan(const FrameJob& job) const {
  const net::Settings& wish = job.start.setup->settings;
  const Quality& quality = job.start.quality;
  const EncodeMemory& memory = *job.encode_memory;
  const int asked = wish.jpeg_quality != 0 ? wish.jpeg_quality : config_.jpeg_quality;
  Plan plan;
  plan.sees_saccade = std::any_of(
      job.start.gazes.begin(), job.start.gazes.end(),
      [](const FollowedGaze& gaze) { return gaze.phase == foveation::GazePhase::Saccade; });
  if (wish.color_codec == "lossless") {
    plan.codec = net::SliceCodec::Lossless;
  } else if (wish.color_codec == "h264" && quality.color == Quality::Color::AsAgreed) {
    plan.codec = net::SliceCodec::H264;
  }
  const bool is_bound = quality.bytes.color_bytes > 0 && memory.jpeg_quality > 0.0;
  plan.jpeg_quality = is_bound ? static_cast<int>(std::lround(memory.jpeg_quality)) : asked;
  using Wish = codec::H264Encoder::FrameWish;
  // What a saccade leaves unseen is spent where it lands.
  constexpr double kSaccadeQuantiser = 6.0;
  const bool landed = memory.was_saccade && !plan.sees_saccade;
  const bool starts = memory.last_frame == 0 || job.start.is_key_wanted;
  plan.h264.kind = starts ? codec::H264Encoder::Kind::Key : codec::H264Encoder::Kind::Delta;
  plan.h264.quantiser =
      std::clamp(h264_quantiser(asked) + (plan.sees_saccade ? kSaccadeQuantiser : 0.0), 0.0, 51.0);
  plan.h264.most_bytes = quality.bytes.color_bytes / std::max<std::size_t>(job.views.size(), 1);
  // x264's buffer fills with what frames leave, so a saccade must keep what its landing takes.
  plan.h264.burst = plan.sees_saccade || landed ? Wish::Burst::Yes : Wish::Burst::No;
  plan.h264.now = job.start.view_received.time_since_epoch();
  return plan;
}

void EncodeStage::encode_h264(const FrameJob& job, const Plan& plan, std::size_t index) {
  Eye& eye = eyes_[index];
  EncodeMemory::Eye& memory = job.encode_memory->eyes[index];
  const kernels::View& view = job.views[index];
  if (!memory.h264) {
    auto made = codec::H264Encoder::create(config_.h264);
    if (!made) {
      eye.color = base::forward(made);
      return;
    }
    memory.h264 = std::move(*made);
  }
  codec::H264Encoder::FrameWish wish = plan.h264;
  wish.most_bytes -= std::min(memory.hidden.last_bytes(), wish.most_bytes / 2);  // 0 bounds nothing
  if (memory.grid != view.grid) wish.burst = codec::H264Encoder::FrameWish::Burst::Yes;
  memory.grid = view.grid;
  const std::vector<float> offsets =
      codec::quantiser_offsets(view.grid, view.gaze, job.rate_model, config_.quantiser_range);
  wish.quantiser_offsets = offsets;
  auto coded = memory.h264->encode(eye.tone_mapped, wish);
  if (!coded) {
    eye.color = base::forward(coded);
    return;
  }
  eye.is_key = coded->kind == codec::H264Encoder::Kind::Key;
  eye.color = std::move(coded->bytes);
}

void EncodeStage::encode_color(const FrameJob& job, const Plan& plan, std::size_t index) {
  Eye& eye = eyes_[index];
  eye.is_key = true;
  if (plan.codec == net::SliceCodec::H264) {
    encode_h264(job, plan, index);
    return;
  }
  codec::ColorOptions options;
  options.codec = plan.codec == net::SliceCodec::Lossless ? codec::ColorCodec::Lossless
                                                          : codec::ColorCodec::Jpeg;
  options.jpeg_quality = plan.jpeg_quality;
  eye.color = codec::encode_color(eye.tone_mapped, eye.tone_mapped.rect(), options);
}

Result<void> EncodeStage::encode_hidden(const FrameJob& job, const Plan& plan, std::size_t index) {
  Eye& eye = eyes_[index];
  HiddenShare& share = job.encode_memory->eyes[index].hidden;
  eye.hidden.reset();
  if (!eye.color || !eye.depth) return {};
  share.note_seen(eye.color->size() + eye.depth->bytes.size());
  if (index >= job.hidden.size() || job.hidden[index].cells == 0) return {};
  codec::ColorOptions options;
  options.codec = hidden_codec(plan.codec) == net::SliceCodec::Lossless
                      ? codec::ColorCodec::Lossless
                      : codec::ColorCodec::Jpeg;
  options.jpeg_quality = codec::hidden_jpeg_quality(plan.jpeg_quality);
  auto coded = share.encode(job.hidden[index], job.views[index].tone, options);
  if (!coded) return base::forward(coded);
  eye.hidden = std::move(*coded);
  return {};
}

void EncodeStage::encode_eye(const FrameJob& job, const Plan& plan, std::size_t index) {
  const Nanoseconds before = base::thread_cpu_time();
  const kernels::ViewBuffers& rendered = job.buffers.views[index];
  Eye& eye = eyes_[index];
  image::encode(job.views[index].tone, rendered.radiance, eye.tone_mapped);
  encode_color(job, plan, index);
  codec::DepthOptions depth;
  depth.divisor = job.start.quality.bytes.depth_divisor;
  if (!affords_residual(job)) depth.residual = codec::DepthOptions::Residual::No;
  eye.depth = codec::encode_depth(rendered.depth_m, depth);
  if (const auto done = encode_hidden(job, plan, index); !done) eye.color = base::forward(done);
  eye.cpu = base::thread_cpu_time() - before;
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
  const bool has_hidden = std::any_of(eyes_.begin(), eyes_.end(),
                                      [](const Eye& eye) { return eye.hidden.has_value(); });
  begin.view_cell_m = has_hidden ? job.start.view_cell_m : 0.0;
  const Quality& quality = job.start.quality;
  begin.quality = {quality.scale, quality.bytes.depth_divisor, quality.bytes.color_bytes,
                   quality.color == Quality::Color::Stateless, quality.quality};
  begin.kernel = config_.offer.kernel;
  begin.config = config_.description;
  begin.seed = config_.seed;
  begin.scene_time = job.scene_time.since_start;
  begin.settings_generation = job.start.setup->settings.generation;
  return begin;
}

void EncodeStage::append_eye(const FrameJob& job, const Plan& plan, std::size_t index,
                             net::EncodedFrame& frame) {
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

  const image::Rect rect = eye.tone_mapped.rect();
  frame.begin.slices.push_back(
      slice(index, net::PlaneKind::Color, plan.codec, rect, eye.color->size()));
  frame.payloads.push_back(as_payload(std::move(*eye.color)));
  frame.begin.slices.push_back(slice(index, net::PlaneKind::Depth, net::SliceCodec::InverseDepth,
                                     rect, eye.depth->bytes.size()));
  frame.payloads.push_back(as_payload(std::move(eye.depth->bytes)));
  append_hidden(plan, index, frame);
}

void EncodeStage::append_hidden(const Plan& plan, std::size_t index, net::EncodedFrame& frame) {
  Eye& eye = eyes_[index];
  if (!eye.hidden) return;
  codec::EncodedHiddenLayer& coded = eye.hidden->coded;
  frame.begin.views[index].hidden_depth_inverse_scale_per_m = coded.depth.inverse_scale_per_m;
  const image::Rect whole = eye.tone_mapped.rect();
  const auto append = [&](net::PlaneKind plane, net::SliceCodec codec, const image::Rect& rect,
                          std::vector<std::byte> bytes) {
    net::SliceEntry entry = slice(index, plane, codec, rect, bytes.size());
    entry.layer = 1;
    frame.begin.slices.push_back(entry);
    frame.payloads.push_back(as_payload(std::move(bytes)));
  };
  append(net::PlaneKind::Mask, net::SliceCodec::BandMask, whole, std::move(coded.mask));
  append(net::PlaneKind::Color, hidden_codec(plan.codec), eye.hidden->atlas,
         std::move(coded.color));
  append(net::PlaneKind::Depth, net::SliceCodec::InverseDepth, whole, std::move(coded.depth.bytes));
}

void EncodeStage::remember(FrameJob& job, const Plan& plan, net::FrameBegin& begin) {
  EncodeMemory& memory = *job.encode_memory;
  job.encode_cpu = Nanoseconds{0};
  job.encoded = {};
  for (std::size_t i = 0; i < eyes_.size(); ++i) {
    job.encode_cpu += eyes_[i].cpu;
    job.encoded.color_bytes += eyes_[i].color->size();
    job.encoded.depth_bytes += eyes_[i].depth->bytes.size();
    if (!eyes_[i].hidden) continue;
    job.encoded.hidden_bytes += eyes_[i].hidden->coded.bytes();
  }
  job.encoded.cells = job.cells;
  job.encoded.depth_divisor = job.start.quality.bytes.depth_divisor;
  begin.is_key = std::all_of(eyes_.begin(), eyes_.end(), [](const Eye& eye) { return eye.is_key; });
  begin.reference_frame = begin.is_key ? 0 : memory.last_frame;
  memory.last_frame = plan.codec == net::SliceCodec::H264 ? begin.frame : 0;
  memory.was_saccade = plan.sees_saccade;
  const auto bound = static_cast<double>(job.start.quality.bytes.color_bytes);
  const auto most = static_cast<double>(config_.jpeg_quality);
  memory.jpeg_quality =
      bound > 0.0
          ? std::min(
                next_jpeg_quality(
                    plan.jpeg_quality,
                    static_cast<double>(job.encoded.color_bytes + job.encoded.hidden_bytes), bound),
                most)
          : 0.0;
}

Result<net::EncodedFrame> EncodeStage::encode(FrameJob& job) {
  eyes_.resize(job.views.size());
  job.encode_memory->eyes.resize(job.views.size());
  const Plan common = plan(job);
  threads_.run(job.views.size(), [&](std::size_t index) { encode_eye(job, common, index); });
  for (const Eye& eye : eyes_) {
    if (eye.color && eye.depth) continue;
    job.encode_memory->last_frame = 0;  // some eye has gone on without the others
    return eye.color ? tl::unexpected(eye.depth.error()) : tl::unexpected(eye.color.error());
  }
  net::EncodedFrame frame;
  frame.begin = frame_begin(job);
  remember(job, common, frame.begin);
  for (std::size_t index = 0; index < eyes_.size(); ++index) append_eye(job, common, index, frame);
  std::this_thread::sleep_for(config_.delays.encode);
  job.encode_end = ServerTime{clock_.now()};
  job.encoded.work = job.encode_end - job.start.view_received;
  frame.end = frame_end(job);
  for (std::size_t index = 0; index < eyes_.size(); ++index) {
    if (eyes_[index].hidden) frame.end.hidden_cells += eyes_[index].hidden->cells;
  }
  return frame;
}

}  // namespace macula::session
