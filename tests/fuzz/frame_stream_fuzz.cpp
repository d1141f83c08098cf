// A client's whole way of a frame: messages in a row (each two bytes of length, then the bytes; a
// slice's payload is the next of them), assembled and decoded.
#include <utility>

#include "client/frames/decode.h"
#include "shared/base/clock.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"
#include "shared/net/frame_assembler.h"
#include "shared/net/wire.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr std::uint32_t kEpoch = 7;
constexpr int kSide = 16;

/// Chunks off the front of the input.
class Chunks {
 public:
  explicit Chunks(Input input) : rest_(input) {}
  bool is_empty() const { return rest_.size() < 2; }
  Input take() {
    if (is_empty()) return {};
    const std::size_t wanted = rest_[0] | rest_[1] << 8U;
    const std::size_t size = std::min(wanted, rest_.size() - 2);
    const Input chunk = rest_.subspan(2, size);
    rest_ = rest_.subspan(2 + size);
    return chunk;
  }

 private:
  Input rest_;
};

class Client {
 public:
  void take(const net::Message& message, Chunks& chunks) {
    using Step = net::FrameAssembler::Step;
    Step step = Step::Ignored;
    if (const auto* begin = std::get_if<net::FrameBegin>(&message)) {
      if (net::check_frame_begin(*begin, limits_)) step = assembler_.begin(*begin, {});
    } else if (const auto* slice = std::get_if<net::SliceHeader>(&message)) {
      step = assembler_.slice(*slice, as_bytes(chunks.take()));
    } else if (const auto* end = std::get_if<net::FrameEnd>(&message)) {
      step = assembler_.end(*end, {});
    }
    if (step == Step::Completed)
      if (auto frame = assembler_.take()) (void)decoder_.decode(std::move(*frame));
  }
  void start() { assembler_.start_epoch(kEpoch); }

 private:
  // Small pictures: a fuzzer finds nothing more in large ones.
  net::Limits limits_{.max_frame_bytes = 1U << 20, .max_side_px = 256, .max_cells = 1U << 16};
  base::ManualClock clock_;
  net::FrameAssembler assembler_{limits_};
  frames::FrameDecoder decoder_{clock_};
};

void put(std::string& out, std::string_view bytes) {
  out.push_back(static_cast<char>(bytes.size() & 0xFFU));
  out.push_back(static_cast<char>(bytes.size() >> 8U));
  out.append(bytes);
}

struct Slice {
  net::SliceEntry entry;
  std::vector<std::byte> bytes;
};

std::vector<Slice> slices_of(codec::ColorCodec color, net::FrameView& view) {
  const image::Rect rect{0, 0, kSide, kSide};
  image::Plane<Rgb8> picture(kSide, kSide);
  image::Plane<float> depth(kSide, kSide);
  for (int i = 0; i < kSide; ++i) {
    picture(i, i / 2) = {200, 100, 50};
    depth(i, i / 3) = 1.0F + static_cast<float>(i);
  }
  auto colors = codec::encode_color(picture, rect, {color, 85, codec::Chroma::Half});
  auto depths = codec::encode_depth(depth);
  require(colors && depths, "a seed cannot be encoded");
  view.depth_inverse_scale_per_m = depths->inverse_scale_per_m;
  view.depth_residual = depths->residual;
  const auto codec =
      color == codec::ColorCodec::Jpeg ? net::SliceCodec::Jpeg : net::SliceCodec::Lossless;
  const auto size = [](const auto& bytes) { return static_cast<std::uint32_t>(bytes.size()); };
  return {{{0, 0, net::PlaneKind::Color, codec, rect, size(*colors)}, *colors},
          {{0, 0, net::PlaneKind::Depth, net::SliceCodec::InverseDepth, rect, size(depths->bytes)},
           depths->bytes}};
}

std::string frame(std::uint64_t number, codec::ColorCodec color) {
  net::FrameBegin begin;
  begin.epoch = kEpoch;
  begin.frame = number;
  net::FrameView view;
  const foveation::Display display{math::symmetric_fov(Degrees{90.0}, 1.0), kSide, kSide};
  view.display_fov = display.fov;
  view.grid = foveation::make_uniform_grid(display);
  const auto slices = slices_of(color, view);
  begin.views.push_back(view);
  for (const Slice& slice : slices) begin.slices.push_back(slice.entry);
  std::string out;
  put(out, net::encode_envelope(begin));
  for (std::uint32_t i = 0; i < slices.size(); ++i) {
    put(out, net::encode_envelope(net::SliceHeader{kEpoch, number, i, 0}));
    put(out, {reinterpret_cast<const char*>(slices[i].bytes.data()), slices[i].bytes.size()});
  }
  put(out, net::encode_envelope(net::FrameEnd{.epoch = kEpoch, .frame = number}));
  return out;
}

}  // namespace

void try_input(Input input) {
  Client client;
  client.start();
  for (Chunks chunks(input); !chunks.is_empty();) {
    const auto message = net::decode_envelope(as_bytes(chunks.take()));
    if (message) client.take(*message, chunks);
  }
}

std::vector<std::string> seeds() {
  const std::string jpeg = frame(1, codec::ColorCodec::Jpeg);
  const std::string lossless = frame(2, codec::ColorCodec::Lossless);
  return {jpeg, lossless, jpeg + lossless};
}

}  // namespace macula::fuzz
