#include "tests/bench/compare.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "server/exr/exr.h"
#include "shared/base/text.h"
#include "shared/image/draw.h"
#include "shared/image/png.h"
#include "shared/image/tone.h"
#include "shared/metrics/error.h"
#include "shared/metrics/foveated.h"
#include "shared/metrics/ssim.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

using base::bad_input;
using base::forward;
using image::Plane;

/// FLIP above this is plainly visible.
constexpr float kVisibleFlip = 0.3F;

enum class Range { Display, Radiance };

struct Picture {
  Range range = Range::Display;
  Plane<Rgb> linear;   ///< radiance of an EXR, else display-linear
  Plane<Rgb> encoded;  ///< sRGB values in [0, 1]
};

Result<void> check_finite(const Plane<Rgb>& picture, const std::string& path) {
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (math::is_finite(picture(x, y))) continue;
      return bad_input(base::concat("pixel ", x, ",", y, " is not a finite number"), path,
                       "a comparison needs finite radiance everywhere");
    }
  }
  return {};
}

Plane<Rgb> display_encoded(const Plane<Rgb>& radiance, double exposure_ev) {
  const image::Tone tone{static_cast<float>(exposure_ev), image::ToneCurve::Linear};
  Plane<Rgb> result(radiance.width(), radiance.height());
  std::ranges::transform(radiance.pixels(), result.pixels().begin(), [&tone](const Rgb& c) {
    const Rgb display = image::display_linear(tone, c);
    return Rgb{image::srgb_from_linear(display.x), image::srgb_from_linear(display.y),
               image::srgb_from_linear(display.z)};
  });
  return result;
}

Result<Picture> load_exr(const std::string& path, double exposure_ev) {
  auto radiance = exr::read(path);
  if (!radiance) return forward(radiance);
  if (const auto finite = check_finite(*radiance, path); !finite) return forward(finite);
  Plane<Rgb> encoded = display_encoded(*radiance, exposure_ev);
  return Picture{Range::Radiance, std::move(*radiance), std::move(encoded)};
}

Result<Picture> load_png(const std::string& path) {
  const auto picture = image::read_png(path);
  if (!picture) return forward(picture);
  return Picture{Range::Display, image::decode_display_linear(*picture),
                 metrics::unit_from_8bit(*picture)};
}

Result<Picture> load(const std::string& path, double exposure_ev) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".exr") return load_exr(path, exposure_ev);
  if (extension == ".png") return load_png(path);
  return bad_input("unknown kind of picture", path, "allowed: .png (sRGB) and .exr (linear)");
}

struct Pair {
  Picture reference, test;

  bool is_radiance() const {
    return reference.range == Range::Radiance && test.range == Range::Radiance;
  }
};

/// Beside a PNG, an EXR counts as what a display shows of it.
void bring_to_display(Picture& picture) {
  if (picture.range == Range::Display) return;
  std::ranges::transform(picture.encoded.pixels(), picture.linear.pixels().begin(),
                         [](const Rgb& c) {
                           return Rgb{image::linear_from_srgb(c.x), image::linear_from_srgb(c.y),
                                      image::linear_from_srgb(c.z)};
                         });
  picture.range = Range::Display;
}

Result<Pair> load_pair(const CompareOptions& options) {
  auto reference = load(options.reference, options.exposure_ev);
  if (!reference) return forward(reference);
  auto test = load(options.test, options.exposure_ev);
  if (!test) return forward(test);
  const image::Rect wanted = reference->linear.rect(), given = test->linear.rect();
  if (wanted != given) {
    return bad_input(base::concat("is ", given.width, "x", given.height, " px, but ",
                                  options.reference, " is ", wanted.width, "x", wanted.height),
                     options.test, "both pictures must have the same size");
  }
  Pair pair{std::move(*reference), std::move(*test)};
  if (!pair.is_radiance()) {
    bring_to_display(pair.reference);
    bring_to_display(pair.test);
  }
  return pair;
}

metrics::GazedView view_of(const Pair& pair, const CompareOptions& options) {
  const Plane<Rgb>& picture = pair.reference.linear;
  auto view =
      metrics::GazedView::centred(picture.width(), picture.height(), options.pixels_per_degree);
  if (options.gaze_px) view.gaze_px = *options.gaze_px;
  return view;
}

Plane<float> flip_of(const Pair& pair, double pixels_per_degree) {
  if (!pair.is_radiance()) {
    return metrics::flip_map(pair.reference.linear, pair.test.linear, pixels_per_degree);
  }
  return metrics::hdr_flip(pair.reference.linear, pair.test.linear, pixels_per_degree).map;
}

using Ssim = double(const Plane<Rgb>&, const Plane<Rgb>&);
/// NaN for pictures in which no window fits.
double ssim_of(const Pair& pair, Ssim ssim) {
  const image::Rect size = pair.test.encoded.rect();
  if (std::min(size.width, size.height) < metrics::kSsimWindow) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return ssim(pair.reference.encoded, pair.test.encoded);
}

/// The nine columns everyone relies on.
Fields headline(const Pair& pair, const metrics::GazedView& view,
                const metrics::ErrorSummary& flip) {
  const auto& [reference, test] = pair;
  return {
      {"mse", metrics::mse(reference.linear, test.linear)},
      {"rmse", metrics::rmse(reference.linear, test.linear)},
      {"relmse", metrics::relative_mse(reference.linear, test.linear)},
      {"psnr_db", metrics::psnr_db(reference.encoded, test.encoded)},
      {"ssim", ssim_of(pair, metrics::ssim_luma)},
      {"flip", flip.mean},
      {"flip_weighted_median", flip.weighted_median},
      {"ew_psnr_db", metrics::ew_psnr_db(reference.encoded, test.encoded, view)},
      {"gp_psnr_db", metrics::gp_psnr_db(reference.encoded, test.encoded, view)},
  };
}

/// What only the JSON report carries.
Fields details(const Pair& pair, const metrics::GazedView& view, const Plane<float>& flip_map,
               const metrics::ErrorSummary& flip) {
  const auto& [reference, test] = pair;
  const auto weights = metrics::acuity_weights(view, flip_map.width(), flip_map.height());
  return {
      {"mse_8bit", 255.0 * 255.0 * metrics::mse(reference.encoded, test.encoded)},
      {"ssim_rgb", ssim_of(pair, metrics::ssim_rgb)},
      {"flip_weighted_q1", flip.weighted_q1},
      {"flip_weighted_q3", flip.weighted_q3},
      {"flip_min", flip.min},
      {"flip_max", flip.max},
      {"flip_acuity_weighted", metrics::weighted_mean(flip_map, weights)},
      {"flip_above_0_3_share", metrics::fraction_above(flip_map, kVisibleFlip)},
  };
}

Fields config_of(const CompareOptions& options, const Pair& pair, const metrics::GazedView& view) {
  return {
      {"reference", options.reference},
      {"test", options.test},
      {"width_px", std::int64_t{pair.reference.linear.width()}},
      {"height_px", std::int64_t{pair.reference.linear.height()}},
      {"pixels_per_degree", options.pixels_per_degree},
      {"gaze_x_px", view.gaze_px.x},
      {"gaze_y_px", view.gaze_px.y},
      {"exposure_ev", options.exposure_ev},
      {"display_values", std::string("PNG as it is; EXR by exposure, clip at 1, sRGB curve")},
      {"flip_kind", std::string(pair.is_radiance() ? "HDR, ACES curve" : "LDR")},
      {"ssim_kind", std::string("BT.601 luma, Gaussian 11x11 sigma 1.5, population covariance, "
                                "border of 5 px left out")},
  };
}

}  // namespace

Result<void> run_compare(const CompareOptions& options) {
  const auto pair = load_pair(options);
  if (!pair) return forward(pair);
  const metrics::GazedView view = view_of(*pair, options);
  const Plane<float> map = flip_of(*pair, options.pixels_per_degree);
  const metrics::ErrorSummary flip = metrics::summarise(map);

  Fields row = headline(*pair, view, flip);
  std::fputs(table_text({row}).c_str(), stdout);
  if (!options.map.empty()) {
    const auto written = image::write_png(options.map, image::false_color(map, 0.0F, 1.0F));
    if (!written) return forward(written);
  }
  if (options.json.empty()) return {};
  for (auto& field : details(*pair, view, map, flip)) row.push_back(std::move(field));
  return write_json(options.json, {"compare", config_of(options, *pair, view), {std::move(row)}});
}

}  // namespace macula::bench
