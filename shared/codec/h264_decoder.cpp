extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
}

#include <algorithm>
#include <cstring>
#include <vector>

#include "shared/base/text.h"
#include "shared/codec/h264.h"
#include "shared/codec/yuv_simd.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;

constexpr const char* kPlace = "H.264";
constexpr std::int64_t kMostPixels = 8448LL * 8448LL;  // the largest canvas of an encoder

struct FreeContext {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

/// `count` samples into a row that whole vectors may read.
void copy_row(const std::uint8_t* from, std::size_t count, std::vector<std::uint8_t>& row) {
  row.resize((count + kYuvRowPixels - 1) / kYuvRowPixels * kYuvRowPixels);
  std::memcpy(row.data(), from, count);
}

class Decoder final : public H264Decoder {
 public:
  explicit Decoder(AVCodecContext* context)
      : context_(context), frame_(av_frame_alloc()), packet_(av_packet_alloc()) {}

  Result<void> decode(std::span<const std::byte> bytes, const image::Rect& rect,
                      image::Plane<Rgb8>& picture) override {
    if (auto taken = take(bytes); !taken) return fail(taken.error());
    if (auto fits = check_frame(rect); !fits) return fail(fits.error());
    convert(rect, picture);
    av_frame_unref(frame_.get());
    return {};
  }

 private:
  /// What was decoded so far is forgotten: only a key frame can follow.
  Result<void> fail(const Error& error) {
    av_frame_unref(frame_.get());
    avcodec_flush_buffers(context_.get());
    return tl::unexpected(error);
  }

  Result<void> take(std::span<const std::byte> bytes) {
    // The parser may read some bytes past the end.
    padded_.assign(bytes.size() + AV_INPUT_BUFFER_PADDING_SIZE, 0);
    std::memcpy(padded_.data(), bytes.data(), bytes.size());
    packet_->data = padded_.data();
    packet_->size = static_cast<int>(bytes.size());
    if (avcodec_send_packet(context_.get(), packet_.get()) < 0 ||
        avcodec_receive_frame(context_.get(), frame_.get()) < 0) {
      return bad_input("a frame that cannot be decoded", kPlace,
                       "whole frames, from a key frame on");
    }
    if (frame_->decode_error_flags != 0 || (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
      return bad_input("a frame with damage", kPlace);
    }
    return {};
  }

  Result<void> check_frame(const image::Rect& rect) const {
    if (frame_->format != AV_PIX_FMT_YUVJ420P && frame_->format != AV_PIX_FMT_YUV420P) {
      return bad_input("an unknown colour layout", kPlace, "4:2:0, 8 bit");
    }
    if (frame_->width < rect.width || frame_->height < rect.height) {
      return bad_input(concat("a picture of ", frame_->width, " x ", frame_->height), kPlace,
                       concat("at least ", rect.width, " x ", rect.height));
    }
    return {};
  }

  void convert(const image::Rect& rect, image::Plane<Rgb8>& picture) {
    const auto width = static_cast<std::size_t>(rect.width), half = (width + 1) / 2;
    for (int y = 0; y < rect.height; ++y) {
      copy_row(line(0, y), width, luma_);
      copy_row(line(1, y / 2), half, cb_);
      copy_row(line(2, y / 2), half, cr_);
      row_.resize(luma_.size());
      row_from_yuv(luma_.data(), cb_.data(), cr_.data(), luma_.size(), row_.data());
      std::copy_n(row_.begin(), rect.width, picture.row(rect.y + y).begin() + rect.x);
    }
  }
  const std::uint8_t* line(int plane, int y) const {
    return frame_->data[plane] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[plane];
  }

  std::unique_ptr<AVCodecContext, FreeContext> context_;
  std::unique_ptr<AVFrame, FreeFrame> frame_;
  std::unique_ptr<AVPacket, FreePacket> packet_;
  std::vector<std::uint8_t> padded_, luma_, cb_, cr_;
  std::vector<Rgb8> row_;
};

}  // namespace

bool can_decode_h264() {
  return avcodec_find_decoder(AV_CODEC_ID_H264) != nullptr;
}

Result<std::unique_ptr<H264Decoder>> H264Decoder::create() {
  av_log_set_level(AV_LOG_QUIET);  // damage comes back as an Error
  const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_H264);
  AVCodecContext* context = codec != nullptr ? avcodec_alloc_context3(codec) : nullptr;
  if (context == nullptr) return base::runtime_error("libavcodec has no H.264 decoder here");
  context->thread_count = 1;
  context->flags |= AV_CODEC_FLAG_LOW_DELAY;
  context->err_recognition |= AV_EF_EXPLODE | AV_EF_BITSTREAM | AV_EF_BUFFER;
  context->max_pixels = kMostPixels;
  auto decoder = std::make_unique<Decoder>(context);
  if (avcodec_open2(context, codec, nullptr) < 0) {
    return base::runtime_error("libavcodec does not open its H.264 decoder");
  }
  return decoder;
}

}  // namespace macula::codec
