#include <macula/v1/frame.pb.h>

#include <algorithm>

#include "shared/base/text.h"
#include "shared/net/wire.h"
#include "shared/net/wire_parts.h"

namespace macula::net::wire {
namespace {

void write_view(const FrameView& view, v1::FrameView& out) {
  write(view.stage_from_view, *out.mutable_stage_from_view());
  write(view.display_fov, *out.mutable_display_fov());
  write(view.gaze, *out.mutable_gaze());
  if (view.grid_frame == 0) write(view.grid, *out.mutable_grid());
  out.set_grid_frame(view.grid_frame);
  write(view.tone, *out.mutable_tone());
  out.set_depth_inverse_scale_per_m(view.depth_inverse_scale_per_m);
  out.set_depth_residual(view.depth_residual.data(), view.depth_residual.size());
  out.set_hidden_depth_inverse_scale_per_m(view.hidden_depth_inverse_scale_per_m);
}

Result<FrameView> read_view(const v1::FrameView& in) {
  const auto tone = read(in.tone());
  if (!tone) return forward(tone);
  FrameView view;
  view.stage_from_view = read(in.stage_from_view());
  view.display_fov = read(in.display_fov());
  view.gaze = read(in.gaze());
  view.grid_frame = in.grid_frame();
  if (view.grid_frame == 0) view.grid = read(in.grid());
  view.tone = *tone;
  view.depth_inverse_scale_per_m = in.depth_inverse_scale_per_m();
  view.hidden_depth_inverse_scale_per_m = in.hidden_depth_inverse_scale_per_m();
  view.depth_residual.assign(in.depth_residual().begin(), in.depth_residual().end());
  return view;
}

void write_slice(const SliceEntry& slice, v1::SliceEntry& out) {
  out.set_eye(slice.eye);
  out.set_layer(slice.layer);
  out.set_plane(static_cast<v1::SliceEntry::Plane>(slice.plane));
  out.set_codec(static_cast<v1::SliceEntry::Codec>(slice.codec));
  write(slice.rect, *out.mutable_rect());
  out.set_size_bytes(slice.size_bytes);
}

Result<SliceEntry> read_slice(const v1::SliceEntry& in) {
  if (!v1::SliceEntry::Plane_IsValid(in.plane()) || !v1::SliceEntry::Codec_IsValid(in.codec())) {
    return base::bad_input(base::concat("plane ", static_cast<int>(in.plane()), ", codec ",
                                        static_cast<int>(in.codec())),
                           "slices", "planes and codecs of this version");
  }
  const auto rect = read(in.rect());
  if (!rect) return forward(rect);
  return SliceEntry{in.eye(),
                    in.layer(),
                    static_cast<PlaneKind>(in.plane()),
                    static_cast<SliceCodec>(in.codec()),
                    *rect,
                    in.size_bytes()};
}

/// Counts before anything is copied out of the message.
Result<void> check_counts(const v1::FrameBegin& in, const Limits& limits) {
  constexpr int kMostMotions = 4096;
  if (in.views_size() < 1 || in.views_size() > limits.max_views) {
    return base::bad_input(base::concat(in.views_size(), " views"), "frame_begin.views",
                           base::concat("1..", limits.max_views));
  }
  if (static_cast<std::size_t>(in.slices_size()) > limits.max_slices) {
    return base::bad_input(base::concat(in.slices_size(), " slices"), "frame_begin.slices",
                           base::concat("at most ", limits.max_slices));
  }
  if (in.motions_size() > kMostMotions) {
    return base::bad_input(base::concat(in.motions_size(), " motions"), "frame_begin.motions",
                           base::concat("at most ", kMostMotions));
  }
  return {};
}

void write_quality(const FrameQuality& quality, v1::Quality& out) {
  out.set_scale(quality.scale);
  out.set_depth_divisor(static_cast<std::uint32_t>(quality.depth_divisor));
  out.set_color_budget_bytes(quality.color_budget_bytes);
  out.set_stateless_color(quality.stateless_color);
  out.set_kernel(quality.kernel);
}

/// For people to read; servers before it said nothing: full quality.
FrameQuality read_quality(const v1::FrameBegin& in) {
  FrameQuality quality;
  if (!in.has_quality()) return quality;
  quality.scale = in.quality().scale();
  quality.depth_divisor = static_cast<int>(std::min(in.quality().depth_divisor(), 255U));
  quality.color_budget_bytes = in.quality().color_budget_bytes();
  quality.stateless_color = in.quality().stateless_color();
  quality.kernel = in.quality().kernel();
  return quality;
}

void write_times(const FrameBegin& begin, v1::FrameBegin& out) {
  out.set_view_sampled_client_ns(ns_of(begin.view_sampled));
  out.set_view_predicted_display_client_ns(ns_of(begin.view_predicted_display));
  out.set_gaze_sampled_client_ns(ns_of(begin.gaze_sampled));
  out.set_horizon_ns(begin.horizon.count());
  out.set_previous_frame(begin.previous_frame);
  out.set_previous_send_begin_server_ns(ns_of(begin.previous_send_begin));
  out.set_previous_send_end_server_ns(ns_of(begin.previous_send_end));
}

void read_times(const v1::FrameBegin& in, FrameBegin& begin) {
  begin.view_sampled = client_time(in.view_sampled_client_ns());
  begin.view_predicted_display = client_time(in.view_predicted_display_client_ns());
  begin.gaze_sampled = client_time(in.gaze_sampled_client_ns());
  begin.horizon = Nanoseconds{in.horizon_ns()};
  begin.previous_frame = in.previous_frame();
  begin.previous_send_begin = server_time(in.previous_send_begin_server_ns());
  begin.previous_send_end = server_time(in.previous_send_end_server_ns());
}

void read_scalars(const v1::FrameBegin& in, FrameBegin& begin) {
  begin.epoch = in.epoch();
  begin.frame = in.frame();
  begin.view_sequence = in.view_sequence();
  begin.guard_band = Radians{in.guard_band_rad()};
  begin.view_cell_m = in.view_cell_m();
  begin.quality = read_quality(in);
  begin.kernel = in.kernel();
  begin.config = in.config();
  begin.seed = in.seed();
  begin.scene_time = Nanoseconds{in.scene_time_ns()};
  begin.is_key = in.is_key();
  begin.reference_frame = in.reference_frame();
  begin.settings_generation = in.settings_generation();
}

}  // namespace

void write(const FrameBegin& begin, v1::FrameBegin& out) {
  out.set_epoch(begin.epoch);
  out.set_frame(begin.frame);
  out.set_view_sequence(begin.view_sequence);
  write_times(begin, out);
  out.set_guard_band_rad(begin.guard_band.value());
  out.set_view_cell_m(begin.view_cell_m);
  write_quality(begin.quality, *out.mutable_quality());
  for (const FrameView& view : begin.views) write_view(view, *out.add_views());
  out.set_kernel(begin.kernel);
  out.set_config(begin.config);
  out.set_seed(begin.seed);
  out.set_scene_time_ns(begin.scene_time.count());
  for (const SliceEntry& slice : begin.slices) write_slice(slice, *out.add_slices());
  out.set_is_key(begin.is_key);
  out.set_reference_frame(begin.reference_frame);
  for (const InstanceMotion& motion : begin.motions) {
    v1::InstanceMotion& written = *out.add_motions();
    written.set_instance(motion.instance);
    write(motion.stage_from_before, *written.mutable_stage_from_before());
  }
  out.set_settings_generation(begin.settings_generation);
}

Result<FrameBegin> read(const v1::FrameBegin& in, const Limits& limits) {
  if (const auto counts = check_counts(in, limits); !counts) return forward(counts);
  FrameBegin begin;
  read_scalars(in, begin);
  read_times(in, begin);
  for (const v1::FrameView& view : in.views()) {
    auto read = read_view(view);
    if (!read) return forward(read);
    begin.views.push_back(std::move(*read));
  }
  for (const v1::SliceEntry& slice : in.slices()) {
    const auto read = read_slice(slice);
    if (!read) return forward(read);
    begin.slices.push_back(*read);
  }
  for (const v1::InstanceMotion& motion : in.motions()) {
    begin.motions.push_back({motion.instance(), wire::read(motion.stage_from_before())});
  }
  if (const auto checked = check_frame_begin(begin, limits); !checked) return forward(checked);
  return begin;
}

void write(const SliceHeader& slice, v1::Slice& out) {
  out.set_epoch(slice.epoch);
  out.set_frame(slice.frame);
  out.set_slice(slice.slice);
  out.set_offset_bytes(slice.offset_bytes);
}

SliceHeader read(const v1::Slice& in) {
  return {in.epoch(), in.frame(), in.slice(), in.offset_bytes()};
}

void write(const FrameEnd& end, v1::FrameEnd& out) {
  out.set_epoch(end.epoch);
  out.set_frame(end.frame);
  out.set_view_received_server_ns(ns_of(end.view_received));
  out.set_render_begin_server_ns(ns_of(end.render_begin));
  out.set_render_end_server_ns(ns_of(end.render_end));
  out.set_encode_begin_server_ns(ns_of(end.encode_begin));
  out.set_encode_end_server_ns(ns_of(end.encode_end));
  out.set_rays(end.rays);
  out.set_cells(end.cells);
  out.set_hidden_cells(end.hidden_cells);
}

Result<FrameEnd> read(const v1::FrameEnd& in) {
  const FrameEnd end{in.epoch(),
                     in.frame(),
                     server_time(in.view_received_server_ns()),
                     server_time(in.render_begin_server_ns()),
                     server_time(in.render_end_server_ns()),
                     server_time(in.encode_begin_server_ns()),
                     server_time(in.encode_end_server_ns()),
                     in.rays(),
                     in.cells(),
                     in.hidden_cells()};
  for (const ServerTime time :
       {end.view_received, end.render_begin, end.render_end, end.encode_begin, end.encode_end}) {
    if (!is_plausible(time)) return base::bad_input("time beyond 73 years", "frame_end");
  }
  return end;
}

static_assert(static_cast<int>(SliceCodec::BandMask) == v1::SliceEntry::CODEC_BAND_MASK);
static_assert(static_cast<int>(PlaneKind::Mask) == v1::SliceEntry::PLANE_MASK);

}  // namespace macula::net::wire
