// A frame as the server would send it, small and made of known pixels, for tests of what the client
// does with frames.
#pragma once

#include "shared/codec/color.h"
#include "shared/codec/depth.h"
#include "shared/codec/hidden_layer.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/net/client_endpoint.h"

namespace macula::test {

inline constexpr int kFrameWidth = 24, kFrameHeight = 16;

inline foveation::Display small_display() {
  return {math::symmetric_fov(Degrees{60.0}, static_cast<double>(kFrameWidth) / kFrameHeight),
          kFrameWidth, kFrameHeight};
}

/// Red is the column, green the row, blue the eye.
inline image::Plane<Rgb8> known_color(std::size_t eye) {
  image::Plane<Rgb8> color(kFrameWidth, kFrameHeight);
  for (int y = 0; y < kFrameHeight; ++y) {
    for (int x = 0; x < kFrameWidth; ++x) {
      color(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                     static_cast<std::uint8_t>(eye)};
    }
  }
  return color;
}

/// Two meters everywhere, nothing in the top row.
inline image::Plane<float> known_depth() {
  image::Plane<float> depth(kFrameWidth, kFrameHeight, 2.0F);
  for (float& d : depth.row(0)) d = std::numeric_limits<float>::infinity();
  return depth;
}

inline void add_slice(net::ReceivedFrame& frame, net::SliceEntry slice, codec::Bytes bytes) {
  slice.size_bytes = static_cast<std::uint32_t>(bytes.size());
  frame.begin.slices.push_back(slice);
  frame.payloads.push_back(std::move(bytes));
}

/// Colour of one eye as two lossless slices, upper and lower half, and its depth as one.
inline void add_eye(net::ReceivedFrame& frame, std::uint32_t eye) {
  const image::Rect upper{0, 0, kFrameWidth, kFrameHeight / 2};
  const image::Rect lower{0, kFrameHeight / 2, kFrameWidth, kFrameHeight / 2};
  codec::ColorOptions lossless;
  lossless.codec = codec::ColorCodec::Lossless;
  for (const image::Rect& rect : {upper, lower}) {
    add_slice(frame, {eye, 0, net::PlaneKind::Color, net::SliceCodec::Lossless, rect, 0},
              codec::encode_color(known_color(eye), rect, lossless).value());
  }
  const auto depth = codec::encode_depth(known_depth()).value();
  frame.begin.views[eye].depth_inverse_scale_per_m = depth.inverse_scale_per_m;
  add_slice(frame,
            {eye,
             0,
             net::PlaneKind::Depth,
             net::SliceCodec::InverseDepth,
             {0, 0, kFrameWidth, kFrameHeight},
             0},
            depth.bytes);
}

/// Where known_hidden_layer has something: a diagonal stripe.
inline codec::Mask known_band() {
  codec::Mask band(kFrameWidth, kFrameHeight);
  for (int y = 0; y < kFrameHeight; ++y) band(y, y) = band(y + 1, y) = 1;
  return band;
}

/// A grey wall four meters away behind known_band.
inline void add_hidden_layer(net::ReceivedFrame& frame, std::uint32_t eye) {
  const image::Rect whole{0, 0, kFrameWidth, kFrameHeight};
  codec::ColorOptions lossless;
  lossless.codec = codec::ColorCodec::Lossless;
  const auto coded = codec::encode_hidden_layer(
      known_band(), image::Plane<Rgb8>(kFrameWidth, kFrameHeight, Rgb8{90, 90, 90}),
      image::Plane<float>(kFrameWidth, kFrameHeight, 4.0F), lossless);
  frame.begin.views[eye].hidden_depth_inverse_scale_per_m = coded->depth.inverse_scale_per_m;
  add_slice(frame, {eye, 1, net::PlaneKind::Mask, net::SliceCodec::BandMask, whole, 0},
            coded->mask);
  add_slice(frame,
            {eye, 1, net::PlaneKind::Color, net::SliceCodec::Lossless,
             codec::atlas_rect(known_band()), 0},
            coded->color);
  add_slice(frame, {eye, 1, net::PlaneKind::Depth, net::SliceCodec::InverseDepth, whole, 0},
            coded->depth.bytes);
}

inline net::ReceivedFrame make_received_frame(std::uint32_t epoch, std::uint64_t number,
                                              std::uint32_t eyes = 2) {
  net::ReceivedFrame frame;
  frame.begin.epoch = frame.end.epoch = epoch;
  frame.begin.frame = frame.end.frame = number;
  for (std::uint32_t eye = 0; eye < eyes; ++eye) {
    net::FrameView view;
    view.display_fov = small_display().fov;
    view.grid = foveation::make_uniform_grid(small_display());
    frame.begin.views.push_back(view);
    add_eye(frame, eye);
  }
  return frame;
}

}  // namespace macula::test
