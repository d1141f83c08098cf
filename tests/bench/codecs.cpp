#include "tests/bench/codecs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "client/frames/statistics.h"
#include "shared/base/cpu_time.h"
#include "shared/codec/h264.h"
#include "shared/codec/quantiser_offsets.h"
#include "shared/foveation/eccentricity.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/reprojection_setting.h"

namespace macula::bench {
namespace {

using base::forward;
using Pictures = std::vector<image::Plane<Rgb8>>;

constexpr double kPan_deg_per_frame = 60.0 / 72.0;

foveation::RateModel cortical() {
  return *foveation::find_rate_model("cortical");
}

PixelGrid grid_of(const std::string& name, const CodecsOptions& options) {
  const double aspect = static_cast<double>(options.width_px) / options.height_px;
  foveation::Display display{math::symmetric_fov(Degrees{options.vertical_fov_deg}, aspect),
                             options.width_px, options.height_px};
  if (name == "uniform") return foveation::make_uniform_grid(display);
  display.width_px *= 2;
  display.height_px *= 2;
  return foveation::make_foveal_grid(display, {}, cortical());
}

Pictures render(ReprojectionSetting& setting, const PixelGrid& grid, int frames,
                Progress& progress) {
  Pictures pictures;
  const Pose from = setting.stage_from_camera();
  for (int i = 0; i < frames; ++i) {
    const DQuat turn =
        glm::angleAxis(Radians{Degrees{kPan_deg_per_frame * i}}.value(), DVec3{0.0, 1.0, 0.0});
    pictures.push_back(
        setting.render({from.position, glm::normalize(turn * from.rotation)}, grid).color);
    progress.advance();
  }
  return pictures;
}

/// What a codec made of all frames but the first, which has nothing to lean on.
struct Outcome {
  double bytes = 0.0, f10_db = 0.0, out10_db = 0.0, encode_ms = 0.0, decode_ms = 0.0;
};

/// Squared errors inside and outside 10 degrees of the middle.
class Errors {
 public:
  explicit Errors(const PixelGrid& grid) {
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        const Degrees e = foveation::eccentricity(Vec3{0.0F, 0.0F, -1.0F}, grid.ray(x, y));
        outside_.push_back(e.value() > 10.0);
      }
    }
  }
  void add(const image::Plane<Rgb8>& a, const image::Plane<Rgb8>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Rgb8 p = a.pixels()[i], q = b.pixels()[i];
      squares_[outside_[i]] +=
          std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
      counts_[outside_[i]] += 3.0;
    }
  }
  double db(std::size_t outside) const {
    return -10.0 * std::log10(squares_[outside] / counts_[outside] / (255.0 * 255.0));
  }

 private:
  std::vector<std::uint8_t> outside_;
  std::array<double, 2> squares_{}, counts_{};
};

/// Codes the frames by `encode(picture)` -> bytes and `decode(bytes, picture)`.
template <class Encode, class Decode>
Result<Outcome> measure(const Pictures& pictures, const PixelGrid& grid, Encode&& encode,
                        Decode&& decode) {
  Errors errors(grid);
  frames::Series encode_ms, decode_ms;
  Outcome outcome;
  image::Plane<Rgb8> decoded(grid.width(), grid.height());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Nanoseconds begin = base::thread_cpu_time();
    const Result<codec::Bytes> bytes = encode(pictures[i]);
    const Nanoseconds middle = base::thread_cpu_time();
    if (!bytes) return forward(bytes);
    if (const Result<void> done = decode(*bytes, decoded); !done) return forward(done);
    if (i == 0) continue;
    decode_ms.add(units::to_ms(base::thread_cpu_time() - middle));
    encode_ms.add(units::to_ms(middle - begin));
    errors.add(pictures[i], decoded);
    outcome.bytes += static_cast<double>(bytes->size()) / static_cast<double>(pictures.size() - 1);
  }
  outcome.f10_db = errors.db(0);
  outcome.out10_db = errors.db(1);
  outcome.encode_ms = encode_ms.quantile(0.5);
  outcome.decode_ms = decode_ms.quantile(0.5);
  return outcome;
}

Result<Outcome> measure_jpeg(const Pictures& pictures, const PixelGrid& grid, int quality) {
  codec::ColorOptions options;
  options.jpeg_quality = quality;
  return measure(
      pictures, grid,
      [&](const image::Plane<Rgb8>& picture) {
        return codec::encode_color(picture, picture.rect(), options);
      },
      [&](const codec::Bytes& bytes, image::Plane<Rgb8>& out) {
        return codec::decode_color(bytes, options.codec, out.rect(), out);
      });
}

Result<Outcome> measure_h264(const Pictures& pictures, const PixelGrid& grid,
                             codec::H264Options::Effort effort, double quantiser,
                             const std::vector<float>& offsets) {
  auto encoder = codec::H264Encoder::create({.effort = effort});
  auto decoder = codec::H264Decoder::create();
  if (!encoder) return forward(encoder);
  if (!decoder) return forward(decoder);
  return measure(
      pictures, grid,
      [&](const image::Plane<Rgb8>& picture) -> Result<codec::Bytes> {
        codec::H264Encoder::FrameWish wish;
        wish.quantiser = quantiser;
        wish.quantiser_offsets = offsets;
        auto coded = (*encoder)->encode(picture, wish);
        if (!coded) return forward(coded);
        return std::move(coded->bytes);
      },
      [&](const codec::Bytes& bytes, image::Plane<Rgb8>& out) {
        return (*decoder)->decode(bytes, out.rect(), out);
      });
}

/// PSNR of a curve at so many bytes, linear over their logarithm; NaN beyond its ends.
double db_at(const std::vector<Outcome>& curve, double Outcome::*db, double bytes) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Outcome &more = curve[i - 1], &less = curve[i];  // quantisers rise, bytes fall
    if (bytes > more.bytes || bytes < less.bytes) continue;
    const double share = std::log(bytes / less.bytes) / std::log(more.bytes / less.bytes);
    return std::lerp(less.*db, more.*db, share);
  }
  return NAN;
}

class Rows {
 public:
  Rows(std::string scene, std::string grid, Report& report)
      : scene_(std::move(scene)), grid_(std::move(grid)), report_(report) {}
  void add(const char* codec, double quality, const Outcome& o, double f10_gain = NAN,
           double out10_gain = NAN) {
    report_.rows.push_back({{"scene", scene_},
                            {"grid", grid_},
                            {"codec", codec},
                            {"quality", quality},
                            {"bytes_per_frame", o.bytes},
                            {"psnr_f10_db", o.f10_db},
                            {"psnr_out10_db", o.out10_db},
                            {"encode_cpu_ms", o.encode_ms},
                            {"decode_cpu_ms", o.decode_ms},
                            {"f10_gain_db", f10_gain},
                            {"out10_gain_db", out10_gain}});
  }

 private:
  const std::string scene_, grid_;
  Report& report_;
};

Result<void> add_rows(const CodecsOptions& options, const std::string& scene,
                      const std::string& grid_name, Progress& progress, Report& report) {
  auto setting = ReprojectionSetting::create(scene, "full", options.threads);
  if (!setting) return forward(setting);
  const PixelGrid grid = grid_of(grid_name, options);
  const Pictures pictures = render(*setting, grid, options.frames, progress);
  Rows rows(scene, grid_name, report);
  for (const int quality : {60, 75, 85, 95}) {
    const auto outcome = measure_jpeg(pictures, grid, quality);
    if (!outcome) return forward(outcome);
    rows.add("jpeg", quality, *outcome);
  }
  using Effort = codec::H264Options::Effort;
  const auto offsets =
      codec::quantiser_offsets(grid, {}, cortical(), {-options.coarsest, options.coarsest});
  std::vector<Outcome> plain;
  for (const double quantiser : {12.0, 16.0, 20.0, 24.0, 28.0, 32.0, 36.0, 40.0}) {
    const auto outcome = measure_h264(pictures, grid, Effort::Ultrafast, quantiser, {});
    if (!outcome) return forward(outcome);
    rows.add("h264-plain", quantiser, *outcome);
    plain.push_back(*outcome);
  }
  for (const double quantiser : {18.0, 22.0, 26.0, 30.0, 34.0}) {
    const auto outcome = measure_h264(pictures, grid, Effort::Ultrafast, quantiser, offsets);
    if (!outcome) return forward(outcome);
    rows.add("h264-foveal", quantiser, *outcome,
             outcome->f10_db - db_at(plain, &Outcome::f10_db, outcome->bytes),
             outcome->out10_db - db_at(plain, &Outcome::out10_db, outcome->bytes));
  }
  const auto careful = measure_h264(pictures, grid, Effort::Superfast, 22.0, offsets);
  if (!careful) return forward(careful);
  rows.add("h264-superfast", 22.0, *careful);
  return {};
}

}  // namespace

Result<void> run_codecs(const CodecsOptions& options) {
  Report report{"codecs",
                {{"width_px", std::int64_t{options.width_px}},
                 {"height_px", std::int64_t{options.height_px}},
                 {"vertical_fov_deg", options.vertical_fov_deg},
                 {"frames", std::int64_t{options.frames}},
                 {"coarsest", options.coarsest}},
                {}};
  Progress progress(
      "rendering",
      static_cast<std::int64_t>(options.scenes.size() * options.grids.size()) * options.frames);
  for (const std::string& scene : options.scenes) {
    for (const std::string& grid : options.grids) {
      if (auto done = add_rows(options, scene, grid, progress, report); !done) return done;
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
