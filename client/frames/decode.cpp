#include "client/frames/decode.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "client/frames/for_each_eye.h"
#include "shared/base/cpu_time.h"
#include "shared/base/text.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"

namespace macula::frames {
namespace {

using Bytes = std::span<const std::byte>;

bool is_inside(const image::Rect& rect, int width, int height) {
  return rect.x >= 0 && rect.y >= 0 && rect.width > 0 && rect.height > 0 &&
         rect.width <= width - rect.x && rect.height <= height - rect.y;
}

using H264 = std::unique_ptr<codec::H264Decoder>;

/// `decoder` is made when the first slice needs it.
Result<void> decode_h264(const net::SliceEntry& slice, Bytes bytes, H264& decoder,
                         DecodedEye& eye) {
  if (!decoder) {
    auto made = codec::H264Decoder::create();
    if (!made) return base::forward(made);
    decoder = std::move(*made);
  }
  return decoder->decode(bytes, slice.rect, eye.color);
}

Result<void> decode_color_slice(const net::SliceEntry& slice, Bytes bytes, H264& h264,
                                DecodedEye& eye) {
  switch (slice.codec) {
    case net::SliceCodec::Jpeg:
      return codec::decode_color(bytes, codec::ColorCodec::Jpeg, slice.rect, eye.color);
    case net::SliceCodec::Lossless:
      return codec::decode_color(bytes, codec::ColorCodec::Lossless, slice.rect, eye.color);
    case net::SliceCodec::H264:
      return decode_h264(slice, bytes, h264, eye);
    default:
      return base::bad_input("colour comes in a codec this client cannot decode", {},
                             "jpeg, h264 or lossless");
  }
}

Result<void> decode_depth_slice(const net::SliceEntry& slice, Bytes bytes,
                                float inverse_scale_per_m, image::Plane<float>& whole) {
  if (slice.codec != net::SliceCodec::InverseDepth) {
    return base::bad_input("depth comes in a codec this client cannot decode", {}, "inverse depth");
  }
  if (slice.rect == whole.rect()) return codec::decode_depth(bytes, inverse_scale_per_m, whole);
  image::Plane<float> part(slice.rect.width, slice.rect.height);
  if (auto done = codec::decode_depth(bytes, inverse_scale_per_m, part); !done) return done;
  for (int y = 0; y < part.height(); ++y) {
    std::copy(part.row(y).begin(), part.row(y).end(),
              whole.row(slice.rect.y + y).begin() + slice.rect.x);
  }
  return {};
}

Result<void> decode_slice(const net::SliceEntry& slice, Bytes bytes, const net::FrameView& view,
                          H264& h264, DecodedEye& eye) {
  if (!is_inside(slice.rect, eye.color.width(), eye.color.height())) {
    return base::bad_input("its rectangle leaves the grid", {},
                           "a rectangle inside the eye's grid");
  }
  if (slice.plane == net::PlaneKind::Mask) {
    return base::bad_input("the first layer has no mask", {}, "colour and depth");
  }
  return slice.plane == net::PlaneKind::Color
             ? decode_color_slice(slice, bytes, h264, eye)
             : decode_depth_slice(slice, bytes, view.depth_inverse_scale_per_m,
                                  eye.inverse_depth_per_m);
}

/// The second layer's mask, which comes first and tells what its atlas holds.
Result<void> decode_mask_slice(const net::SliceEntry& slice, Bytes bytes, DecodedEye& eye) {
  const int width = eye.color.width(), height = eye.color.height();
  if (slice.rect != eye.color.rect()) {
    return base::bad_input("its mask has another size", {}, "the grid's");
  }
  eye.hidden.emplace(codec::HiddenLayerPlanes{codec::Mask(width, height),
                                              image::Plane<Rgb8>(width, height),
                                              image::Plane<float>(width, height)});
  return codec::decode_mask(bytes, eye.hidden->mask);
}

Result<void> decode_atlas_slice(const net::SliceEntry& slice, Bytes bytes, DecodedEye& eye) {
  const image::Rect expected = codec::atlas_rect(eye.hidden->mask);
  if (slice.rect != expected || expected.height == 0) {
    return base::bad_input("its atlas does not fit its mask", {},
                           base::concat(expected.width, " x ", expected.height));
  }
  const bool lossless = slice.codec == net::SliceCodec::Lossless;
  if (!lossless && slice.codec != net::SliceCodec::Jpeg) {
    return base::bad_input("its atlas comes in a codec this client cannot decode", {},
                           "jpeg or lossless");
  }
  image::Plane<Rgb8> atlas(expected.width, expected.height);
  const auto codec = lossless ? codec::ColorCodec::Lossless : codec::ColorCodec::Jpeg;
  if (auto done = codec::decode_color(bytes, codec, expected, atlas); !done) return done;
  codec::unpack_atlas(eye.hidden->mask, atlas, eye.hidden->color);
  return {};
}

Result<void> decode_hidden_slice(const net::SliceEntry& slice, Bytes bytes,
                                 const net::FrameView& view, DecodedEye& eye) {
  if (slice.plane == net::PlaneKind::Mask) return decode_mask_slice(slice, bytes, eye);
  if (!eye.hidden) return base::bad_input("its mask is missing", {}, "a mask before all else");
  if (slice.plane == net::PlaneKind::Color) return decode_atlas_slice(slice, bytes, eye);
  if (!is_inside(slice.rect, eye.color.width(), eye.color.height())) {
    return base::bad_input("its rectangle leaves the grid", {},
                           "a rectangle inside the eye's grid");
  }
  return decode_depth_slice(slice, bytes, view.hidden_depth_inverse_scale_per_m,
                            eye.hidden->inverse_depth_per_m);
}

std::string place(const net::FrameBegin& begin, std::size_t slice) {
  return base::concat("frame ", begin.frame, ", slice ", slice);
}

/// One eye from its slices; the error of the first that fails.
Result<DecodedEye> decode_eye(const net::ReceivedFrame& received, std::size_t eye_index,
                              H264& h264) {
  const net::FrameBegin& begin = received.begin;
  const net::FrameView& view = begin.views[eye_index];
  const int width = view.grid.width(), height = view.grid.height();
  DecodedEye eye{image::Plane<Rgb8>(width, height), image::Plane<float>(width, height)};
  std::uint64_t colored = 0;
  for (std::size_t i = 0; i < begin.slices.size(); ++i) {
    const net::SliceEntry& slice = begin.slices[i];
    if (slice.eye != eye_index || slice.layer > 1) continue;
    const auto done = slice.layer == 0
                          ? decode_slice(slice, received.payloads[i], view, h264, eye)
                          : decode_hidden_slice(slice, received.payloads[i], view, eye);
    if (!done) {
      Error error = done.error();
      error.where = place(begin, i);
      return tl::unexpected(std::move(error));
    }
    if (slice.plane == net::PlaneKind::Color && slice.layer == 0) {
      colored += static_cast<std::uint64_t>(slice.rect.width) * slice.rect.height;
    }
  }
  if (colored < eye.color.size()) {
    return base::bad_input(base::concat("colour covers ", colored, " of ", eye.color.size(),
                                        " cells of eye ", eye_index),
                           base::concat("frame ", begin.frame), "every cell of the grid");
  }
  return eye;
}

std::uint64_t payload_bytes(const net::ReceivedFrame& received) {
  std::uint64_t bytes = 0;
  for (const auto& payload : received.payloads) bytes += payload.size();
  return bytes;
}

}  // namespace

Result<void> FrameDecoder::check_reference(const net::FrameBegin& begin) const {
  const FrameId needed{begin.epoch, begin.reference_frame};
  if (begin.is_key || last_ == needed) return {};
  return base::bad_input(
      base::concat("it leans on frame ", needed.frame, ", which was not decoded"),
      base::concat("frame ", begin.frame), "a key frame first");
}

Result<DecodedFrame> FrameDecoder::decode(net::ReceivedFrame received) {
  const net::FrameBegin& begin = received.begin;
  if (received.payloads.size() != begin.slices.size()) {
    return base::bad_input(
        base::concat(received.payloads.size(), " payloads for ", begin.slices.size(), " slices"),
        base::concat("frame ", begin.frame), "one payload a slice");
  }
  if (auto known = check_reference(begin); !known) return base::forward(known);
  last_.reset();  // until all of this one is there
  std::vector<Result<DecodedEye>> eyes(begin.views.size());
  std::vector<Nanoseconds> cpu(eyes.size());
  h264_.resize(eyes.size());
  for_each_eye(eyes.size(), [&](std::size_t eye) {
    const Nanoseconds before = base::thread_cpu_time();
    eyes[eye] = decode_eye(received, eye, h264_[eye]);
    cpu[eye] = base::thread_cpu_time() - before;
  });
  if (options_.delay > Nanoseconds{0}) std::this_thread::sleep_for(options_.delay);

  DecodedFrame frame;
  for (auto& eye : eyes) {
    if (!eye) return base::forward(eye);
    frame.eyes.push_back(std::move(*eye));
  }
  last_ = FrameId{begin.epoch, begin.frame};
  frame.cpu = std::accumulate(cpu.begin(), cpu.end(), Nanoseconds{0});
  frame.bytes = payload_bytes(received);
  frame.begin = std::move(received.begin);
  frame.end = received.end;
  frame.first_byte = received.first_byte;
  frame.last_byte = received.last_byte;
  frame.decoded = ClientTime{clock_.now()};
  return frame;
}

}  // namespace macula::frames
