#include "shared/codec/depth.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "shared/base/text.h"
#include "shared/codec/depth_simd.h"
#include "shared/codec/depth_thinning.h"
#include "shared/codec/packed.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;

/// A frame that sees nothing nearer than 1e30 m is scaled as if it did, to stay clear of
/// subnormals.
constexpr float kSmallestScale = 1e-30F;
constexpr float kResidualUnitsPerStep = 16.0F;
constexpr std::array kDivisors{1, 2, 4, 8};

/// By comparing bits: positive floats order as integers do, and integers have vector minima.
float nearest_depth(std::span<const float> depth_m, float nearest_m) {
  auto nearest = std::bit_cast<std::int32_t>(kNothingThere);
  for (const float depth : depth_m) {
    const float known = depth == depth ? depth : kNothingThere;
    nearest = std::min(nearest, std::bit_cast<std::int32_t>(std::max(known, nearest_m)));
  }
  return std::bit_cast<float>(nearest);
}

float choose_scale(const image::Plane<float>& depth_m, float nearest_m) {
  const float nearest = nearest_depth(depth_m.pixels(), nearest_m);
  return nearest == kNothingThere ? 0.0F : std::max(1.0F / nearest, kSmallestScale);
}

std::uint16_t zigzag(std::uint16_t delta) {
  return static_cast<std::uint16_t>((delta << 1) ^ (delta & 0x8000U ? 0xFFFFU : 0U));
}

std::uint16_t unzigzag(std::uint16_t code) {
  return static_cast<std::uint16_t>((code >> 1) ^ (code & 1U ? 0xFFFFU : 0U));
}

/// `samples[-1]` is the prediction of the first.
void filter_row(const std::uint16_t* samples, std::size_t width, std::uint8_t* low,
                std::uint8_t* high) {
  for (std::size_t x = 0; x < width; ++x) {
    const auto code = zigzag(static_cast<std::uint16_t>(samples[x] - *(samples + x - 1)));
    low[x] = static_cast<std::uint8_t>(code);
    high[x] = static_cast<std::uint8_t>(code >> 8);
  }
}

/// Inverse of filter_row; returns the first sample, which predicts the next row's.
std::uint16_t restore_row(const std::uint8_t* low, const std::uint8_t* high, std::uint16_t before,
                          std::span<std::uint16_t> samples) {
  for (std::size_t x = 0; x < samples.size(); ++x)
    samples[x] = unzigzag(static_cast<std::uint16_t>(low[x] | (high[x] << 8)));
  for (auto& sample : samples) sample = before = static_cast<std::uint16_t>(before + sample);
  return samples.front();
}

/// Columns' errors over one row of blocks -> one byte a block.
void append_residuals(std::span<const float> error, float step_per_m,
                      std::vector<std::uint8_t>& out) {
  for (std::size_t first = 0; first < error.size(); first += kDepthBlockPx) {
    const auto block =
        error.subspan(first, std::min<std::size_t>(kDepthBlockPx, error.size() - first));
    const float worst = *std::max_element(block.begin(), block.end());
    const float units =
        worst > 0.0F ? std::ceil(worst * (kResidualUnitsPerStep / step_per_m)) : 0.0F;
    out.push_back(static_cast<std::uint8_t>(std::min(units, 255.0F)));
  }
}

/// What a thread keeps between frames.
struct Workspace {
  Scratch<float> depth;
  Scratch<std::uint16_t> samples;
  Scratch<float> error;
  Scratch<std::uint8_t> filtered;
};

Workspace& workspace() {
  static thread_local Workspace memory;
  return memory;
}

/// Samples, then residuals by the way, then what zstd likes: all low bytes and all high bytes.
std::span<const std::uint8_t> filter_plane(const image::Plane<float>& depth_m, float nearest_m,
                                           const Quantizer& quantizer,
                                           std::vector<std::uint8_t>& residual) {
  const auto width = static_cast<std::size_t>(depth_m.width());
  const auto filtered = workspace().filtered.take(2 * depth_m.size());
  const auto depth = workspace().depth.take(width + kRowPadding);
  const auto row = workspace().samples.take(1 + width + kRowPadding);  // [0] predicts the first
  const auto error = workspace().error.take(width + kRowPadding);
  std::fill(depth.begin(), depth.end(), kNothingThere);
  std::fill(error.begin(), error.end(), 0.0F);
  row[0] = 0;
  for (int y = 0; y < depth_m.height(); ++y) {
    std::copy(depth_m.row(y).begin(), depth_m.row(y).end(), depth.begin());
    quantize_row(depth.data(), width, quantizer, nearest_m, &row[1], error.data());
    auto* low = filtered.data() + static_cast<std::size_t>(y) * width;
    filter_row(&row[1], width, low, low + depth_m.size());
    row[0] = row[1];
    if ((y + 1) % kDepthBlockPx != 0 && y + 1 != depth_m.height()) continue;
    append_residuals(error.first(width), quantizer.step_per_m, residual);
    std::fill(error.begin(), error.end(), 0.0F);
  }
  return filtered;
}

Result<void> check_plane(const image::Plane<float>& plane) {
  if (!plane.empty() && plane.width() <= kMaxPackedSide && plane.height() <= kMaxPackedSide)
    return {};
  return bad_input(concat(plane.width(), " x ", plane.height(), " samples"), "depth plane",
                   "1 to 65535 a side");
}

/// At the plane's own resolution.
EncodedDepth encode_whole(const image::Plane<float>& depth_m, float nearest_m) {
  EncodedDepth encoded;
  encoded.inverse_scale_per_m = choose_scale(depth_m, nearest_m);
  const Quantizer quantizer(encoded.inverse_scale_per_m);
  const auto filtered = filter_plane(depth_m, nearest_m, quantizer, encoded.residual);
  encoded.bytes = pack({depth_m.width(), depth_m.height()}, filtered);
  return encoded;
}

Result<void> decode_whole(std::span<const std::byte> bytes, float inverse_scale_per_m,
                          image::Plane<float>& inverse_depth) {
  const auto filtered = unpack(bytes, {inverse_depth.width(), inverse_depth.height()},
                               2 * inverse_depth.size(), workspace().filtered);
  if (!filtered) return base::forward(filtered);
  const Quantizer quantizer(inverse_scale_per_m);
  const auto samples = workspace().samples.take(static_cast<std::size_t>(inverse_depth.width()));
  std::uint16_t before = 0;
  for (int y = 0; y < inverse_depth.height(); ++y) {
    const auto* low = filtered->data() + static_cast<std::size_t>(y) * samples.size();
    before = restore_row(low, low + inverse_depth.size(), before, samples);
    std::transform(samples.begin(), samples.end(), inverse_depth.row(y).begin(),
                   [&](std::uint16_t sample) { return quantizer.inverse(sample); });
  }
  return {};
}

/// Which of the divisors the bytes were thinned by; 1 for all that fit none, so that unpacking says
/// what is wrong with them.
int divisor_of(std::span<const std::byte> bytes, const image::Plane<float>& whole) {
  const auto claimed = packed_size(bytes);
  if (!claimed) return 1;
  for (const int divisor : kDivisors) {
    if (claimed->width == thinned(whole.width(), divisor) &&
        claimed->height == thinned(whole.height(), divisor)) {
      return divisor;
    }
  }
  return 1;
}

}  // namespace

Result<EncodedDepth> encode_depth(const image::Plane<float>& depth_m, const DepthOptions& options) {
  const float nearest_m = options.nearest_m;
  if (!(nearest_m >= 1e-6F && nearest_m <= 1e6F))
    return bad_input(concat("nearest_m = ", nearest_m), "depth options", "1e-6 to 1e6 m");
  if (std::find(kDivisors.begin(), kDivisors.end(), options.divisor) == kDivisors.end())
    return bad_input(concat("divisor ", options.divisor), "depth options", "1, 2, 4 or 8");
  if (auto ok = check_plane(depth_m); !ok) return base::forward(ok);
  EncodedDepth encoded = options.divisor == 1
                             ? encode_whole(depth_m, nearest_m)
                             : encode_whole(thin(depth_m, options.divisor), nearest_m);
  if (options.divisor > 1 || options.residual == DepthOptions::Residual::No) {
    encoded.residual.clear();
  }
  return encoded;
}

Result<void> decode_depth(std::span<const std::byte> bytes, float inverse_scale_per_m,
                          image::Plane<float>& inverse_depth) {
  if (!(inverse_scale_per_m >= 0.0F && std::isfinite(inverse_scale_per_m)))
    return bad_input(concat("scale ", inverse_scale_per_m, " per meter"), "depth slice",
                     "a finite number, not negative");
  if (auto ok = check_plane(inverse_depth); !ok) return ok;
  const int divisor = divisor_of(bytes, inverse_depth);
  if (divisor == 1) return decode_whole(bytes, inverse_scale_per_m, inverse_depth);
  image::Plane<float> samples(thinned(inverse_depth.width(), divisor),
                              thinned(inverse_depth.height(), divisor));
  if (auto done = decode_whole(bytes, inverse_scale_per_m, samples); !done) return done;
  spread(samples, divisor, inverse_depth);
  return {};
}

}  // namespace macula::codec
