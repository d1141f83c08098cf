#include "server/session/hello.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "shared/base/text.h"
#include "shared/codec/h264.h"
#include "shared/foveation/rate.h"
#include "shared/math/fov.h"

namespace macula::session {
namespace {

/// In the order in which `auto` prefers them.
std::vector<std::string_view> known_codecs() {
  if (codec::can_encode_h264()) return {"h264", "jpeg", "lossless"};
  return {"jpeg", "lossless"};
}

std::string list_of_codecs() {
  return codec::can_encode_h264() ? "jpeg, h264, lossless"
                                  : "jpeg, lossless (this build has no h264)";
}

bool is_known_codec(std::string_view name) {
  const auto known = known_codecs();
  return std::find(known.begin(), known.end(), name) != known.end();
}

bool can_decode(const net::Hello& hello, std::string_view codec) {
  return std::find(hello.codecs.begin(), hello.codecs.end(), codec) != hello.codecs.end();
}

/// The fractions make_foveal_grid accepts: 1.5 and small whole numbers.
bool is_oversampling(double value) {
  return value == 1.5 || (value >= 1.0 && value <= 4.0 && value == std::floor(value));
}

Result<void> check_display(const foveation::Display& eye, int max_side_px) {
  const auto in_range = [&](int side) { return side >= 1 && side <= max_side_px; };
  if (!math::is_valid(eye.fov))
    return base::bad_input("the display's field of view is not valid", "Hello.eyes",
                           "left < right, down < up, each within +-90 degrees");
  if (!in_range(eye.width_px) || !in_range(eye.height_px))
    return base::bad_input(
        base::concat("a display of ", eye.width_px, " x ", eye.height_px, " pixels"), "Hello.eyes",
        base::concat("1 to ", max_side_px, " a side"));
  return {};
}

}  // namespace

Result<void> check_settings(const net::Settings& settings) {
  if (!settings.color_codec.empty() && !is_known_codec(settings.color_codec))
    return base::bad_input(base::concat("unknown codec '", settings.color_codec, "'"),
                           "Settings.color_codec", list_of_codecs());
  if (settings.jpeg_quality < 0 || settings.jpeg_quality > 100)
    return base::bad_input(base::concat("JPEG quality ", settings.jpeg_quality),
                           "Settings.jpeg_quality", "1 to 100, or 0 for the default");
  if (!settings.rate_model.empty())
    if (const auto model = foveation::find_rate_model(settings.rate_model); !model)
      return base::forward(model);
  if (settings.fovea_oversampling != 0.0 && !is_oversampling(settings.fovea_oversampling))
    return base::bad_input(base::concat("oversampling ", settings.fovea_oversampling),
                           "Settings.fovea_oversampling", "1, 1.5, 2, 3 or 4; 0 for the default");
  return {};
}

std::string negotiated_codec(const net::Hello& hello, const ServerOffer& offer) {
  if (!hello.settings.color_codec.empty()) return hello.settings.color_codec;
  if (can_decode(hello, offer.default_codec)) return offer.default_codec;
  for (const std::string_view codec : known_codecs())
    if (can_decode(hello, codec)) return std::string{codec};
  return {};
}

Result<ClientSetup> check_hello(const net::Hello& hello, const ServerOffer& offer) {
  if (hello.eyes.empty() || hello.eyes.size() > 2)
    return base::bad_input(base::concat(hello.eyes.size(), " eyes announced"), "Hello.eyes",
                           "1 or 2");
  for (const foveation::Display& eye : hello.eyes)
    if (const auto fits = check_display(eye, offer.max_side_px); !fits) return base::forward(fits);
  if (!(hello.refresh_hz > 0.0 && hello.refresh_hz <= 1000.0))
    return base::bad_input(base::concat("a refresh rate of ", hello.refresh_hz, " Hz"),
                           "Hello.refresh_hz", "above 0, at most 1000");
  if (const auto good = check_settings(hello.settings); !good) return base::forward(good);
  ClientSetup setup{hello.eyes, hello.refresh_hz, hello.settings};
  setup.takes_hidden_layer = std::find(hello.abilities.begin(), hello.abilities.end(),
                                       net::kHiddenLayerAbility) != hello.abilities.end();
  setup.settings.color_codec = negotiated_codec(hello, offer);
  if (!can_decode(hello, setup.settings.color_codec))
    return base::bad_input("no colour codec in common", "Hello.codecs",
                           "this server encodes " + list_of_codecs());
  return setup;
}

}  // namespace macula::session
