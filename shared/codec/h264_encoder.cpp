#include <cstdint>
extern "C" {
#include <x264.h>
}

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "shared/base/text.h"
#include "shared/codec/h264.h"
#include "shared/codec/h264_canvas.h"
#include "shared/codec/yuv_simd.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;

/// Rate control counts frames, not seconds: bytes a frame at this made-up rate.
constexpr int kNominalFps = 72;
/// Where nothing bounds a frame x264 still wants a bound to be changed later: the largest it takes,
/// 2 Gbit/s.
constexpr std::size_t kNoBoundBytes = 3U << 20;
constexpr int kMostSide_px = 8192;
/// Offsets need adaptive quantisation, which must not be zero and is not to do anything.
constexpr float kAdaptiveStrength = 0.01F;
/// Macroblocks of the canvas that the frame does not reach repeat its edge; they cost least here.
constexpr float kOutsideOffset = 10.0F;

struct Close {
  void operator()(x264_t* encoder) const { x264_encoder_close(encoder); }
};

std::size_t rounded_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

/// The three planes of a canvas, in rows of whole vectors.
class Planes {
 public:
  void resize(int width_px, int height_px) {
    stride_ = rounded_up(static_cast<std::size_t>(width_px), kYuvRowPixels);
    height_ = static_cast<std::size_t>(height_px);
    luma_.resize(stride_ * height_);
    cb_.resize(luma_.size() / 4);
    cr_.resize(luma_.size() / 4);
  }
  /// The picture, its last column and row repeated over the rest.
  void fill(const image::Plane<Rgb8>& picture) {
    // Whole vectors are read in place; only what reaches over the picture's edge is copied first.
    const std::size_t whole =
        static_cast<std::size_t>(picture.width()) / kYuvRowPixels * kYuvRowPixels;
    for (std::size_t y = 0; y < height_; y += 2) {
      const Rgb8* const upper = row_of(picture, y);
      const Rgb8* const lower = row_of(picture, y + 1);
      convert(upper, lower, 0, whole, y);
      if (whole == stride_) continue;
      fill_row(picture, upper + whole, whole, upper_);
      fill_row(picture, lower + whole, whole, lower_);
      convert(upper_.data(), lower_.data(), whole, stride_ - whole, y);
    }
  }
  void describe(x264_image_t& image) {
    image.i_csp = X264_CSP_I420;
    image.i_plane = 3;
    std::uint8_t* const planes[] = {luma_.data(), cb_.data(), cr_.data()};
    for (int i = 0; i < 3; ++i) {
      image.plane[i] = planes[i];
      image.i_stride[i] = static_cast<int>(i == 0 ? stride_ : stride_ / 2);
    }
  }

 private:
  static const Rgb8* row_of(const image::Plane<Rgb8>& picture, std::size_t y) {
    return picture.row(std::min(static_cast<int>(y), picture.height() - 1)).data();
  }
  /// The row's pixels from column `first` on, which `from` points to, and its last one repeated.
  void fill_row(const image::Plane<Rgb8>& picture, const Rgb8* from, std::size_t first,
                std::vector<Rgb8>& row) const {
    const std::size_t left = static_cast<std::size_t>(picture.width()) - first;
    const Rgb8 last = from[static_cast<std::ptrdiff_t>(left) - 1];
    row.assign(stride_ - first, last);
    std::copy(from, from + left, row.begin());
  }
  /// Pixels [first, first + count) of rows y and y + 1.
  void convert(const Rgb8* upper, const Rgb8* lower, std::size_t first, std::size_t count,
               std::size_t y) {
    const std::size_t luma = y * stride_ + first, chroma = (y / 2 * stride_ + first) / 2;
    rows_to_yuv(upper, lower, count, &luma_[luma], &luma_[luma + stride_], &cb_[chroma],
                &cr_[chroma]);
  }

  std::size_t stride_ = 0, height_ = 0;
  std::vector<std::uint8_t> luma_, cb_, cr_;
  std::vector<Rgb8> upper_, lower_;
};

/// x264 tells trouble through errors we return; its chatter is not for our log.
void ignore_log(void*, int, const char*, va_list) {}

void set_format(x264_param_t& param, const CanvasSize& canvas) {
  param.i_width = canvas.width_px();
  param.i_height = canvas.height_px();
  param.i_csp = X264_CSP_I420;
  param.i_bitdepth = 8;
  param.b_repeat_headers = 1;
  param.b_annexb = 1;
  param.vui.b_fullrange = 1;
  param.vui.i_colorprim = param.vui.i_transfer = param.vui.i_colmatrix = 1;  // BT.709
}

void set_timing(x264_param_t& param, const H264Options& options) {
  param.b_vfr_input = 0;
  param.i_fps_num = kNominalFps;
  param.i_fps_den = 1;
  param.i_threads = 1;
  param.b_sliced_threads = 0;
  param.i_bframe = 0;
  param.i_keyint_max = std::max(options.refresh_frames, 2);
  param.b_intra_refresh = 1;
  param.i_scenecut_threshold = 0;
}

void set_rate(x264_param_t& param, const H264Encoder::FrameWish& wish) {
  const std::size_t bytes = wish.most_bytes == 0 ? kNoBoundBytes : wish.most_bytes;
  const double kbit = static_cast<double>(bytes) * 8.0 / 1000.0;
  const double frames = wish.burst == H264Encoder::FrameWish::Burst::Yes ? 2.0 : 1.1;
  param.rc.i_rc_method = X264_RC_CRF;
  param.rc.f_rf_constant = static_cast<float>(wish.quantiser);
  param.rc.i_vbv_max_bitrate = static_cast<int>(kbit * kNominalFps) + 1;
  param.rc.i_vbv_buffer_size = static_cast<int>(kbit * frames) + 1;
  param.rc.i_aq_mode = X264_AQ_VARIANCE;
  param.rc.f_aq_strength = kAdaptiveStrength;
}

class Encoder final : public H264Encoder {
 public:
  explicit Encoder(const H264Options& options) : options_(options) {}

  Result<Coded> encode(const image::Plane<Rgb8>& picture, const FrameWish& wish) override {
    if (auto ok = check(picture, wish); !ok) return base::forward(ok);
    const bool resized = canvas_.fit(picture.width(), picture.height(), wish.now);
    if (resized || !x264_) {
      if (auto opened = open(wish); !opened) return base::forward(opened);
    } else {
      retune(wish);
    }
    planes_.fill(picture);
    auto coded = code(picture, wish);
    if (!coded) x264_.reset();
    return coded;
  }

 private:
  static Result<void> check(const image::Plane<Rgb8>& picture, const FrameWish& wish) {
    if (picture.empty() || picture.width() > kMostSide_px || picture.height() > kMostSide_px) {
      return bad_input(concat(picture.width(), " x ", picture.height(), " px"), "H.264 frame",
                       concat("1 to ", kMostSide_px, " a side"));
    }
    if (!(wish.quantiser >= 0.0 && wish.quantiser <= 51.0)) {
      return bad_input(concat("quantiser ", wish.quantiser), "H.264 frame", "0 to 51");
    }
    const std::size_t blocks = blocks_of(picture.width()) * blocks_of(picture.height());
    if (!wish.quantiser_offsets.empty() && wish.quantiser_offsets.size() != blocks) {
      return bad_input(concat(wish.quantiser_offsets.size(), " quantiser offsets"), "H.264 frame",
                       concat("none or ", blocks));
    }
    return {};
  }
  static std::size_t blocks_of(int px) {
    return static_cast<std::size_t>((px + kMacroblockPx - 1) / kMacroblockPx);
  }

  Result<void> open(const FrameWish& wish) {
    const bool superfast = options_.effort == H264Options::Effort::Superfast;
    x264_param_default_preset(&param_, superfast ? "superfast" : "ultrafast", "zerolatency");
    set_format(param_, canvas_);
    set_timing(param_, options_);
    set_rate(param_, wish);
    param_.pf_log = ignore_log;
    param_.i_log_level = X264_LOG_NONE;
    x264_param_apply_profile(&param_, "high");
    x264_.reset(x264_encoder_open(&param_));
    if (!x264_) {
      return base::runtime_error(concat("x264 takes no picture of ", canvas_.width_px(), " x ",
                                        canvas_.height_px(), " px"));
    }
    planes_.resize(canvas_.width_px(), canvas_.height_px());
    frames_ = 0;
    return {};
  }

  void retune(const FrameWish& wish) {
    const x264_param_t before = param_;
    set_rate(param_, wish);
    const auto same = [&](auto member) { return before.rc.*member == param_.rc.*member; };
    using Rate = decltype(param_.rc);
    if (same(&Rate::f_rf_constant) && same(&Rate::i_vbv_max_bitrate) &&
        same(&Rate::i_vbv_buffer_size)) {
      return;
    }
    x264_encoder_reconfig(x264_.get(), &param_);
  }

  /// The frame's offsets laid out over the canvas.
  float* spread_offsets(const image::Plane<Rgb8>& picture, std::span<const float> offsets) {
    if (offsets.empty()) return nullptr;
    const std::size_t across = blocks_of(canvas_.width_px()), down = blocks_of(canvas_.height_px());
    const std::size_t own_across = blocks_of(picture.width()),
                      own_down = blocks_of(picture.height());
    offsets_.assign(across * down, kOutsideOffset);
    for (std::size_t y = 0; y < own_down; ++y) {
      const auto row = offsets.subspan(y * own_across, own_across);
      std::copy(row.begin(), row.end(), offsets_.begin() + static_cast<std::ptrdiff_t>(y * across));
    }
    return offsets_.data();
  }

  Result<Coded> code(const image::Plane<Rgb8>& picture, const FrameWish& wish) {
    x264_picture_t in, out;
    x264_picture_init(&in);
    planes_.describe(in.img);
    in.i_pts = frames_++;
    in.i_type = wish.kind == Kind::Key ? X264_TYPE_IDR : X264_TYPE_AUTO;
    in.prop.quant_offsets = spread_offsets(picture, wish.quantiser_offsets);
    x264_nal_t* nals = nullptr;
    int count = 0;
    const int size = x264_encoder_encode(x264_.get(), &nals, &count, &in, &out);
    if (size <= 0) return base::runtime_error("x264 could not encode a frame");
    // NAL units lie one after another in memory.
    const auto* first = reinterpret_cast<const std::byte*>(nals[0].p_payload);
    const bool is_key = out.i_type == X264_TYPE_IDR;
    return Coded{Bytes(first, first + size), is_key ? Kind::Key : Kind::Delta};
  }

  const H264Options options_;
  CanvasSize canvas_;
  x264_param_t param_{};
  std::unique_ptr<x264_t, Close> x264_;
  Planes planes_;
  std::vector<float> offsets_;
  std::int64_t frames_ = 0;
};

}  // namespace

bool can_encode_h264() {
  return true;
}

Result<std::unique_ptr<H264Encoder>> H264Encoder::create(const H264Options& options) {
  return std::make_unique<Encoder>(options);
}

}  // namespace macula::codec
