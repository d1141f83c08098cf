#include "tests/bench/arguments.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace macula::bench {
namespace {

using base::bad_input;
using base::forward;

constexpr int kLargestSide_px = 16384;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// The whole text as one finite number.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(static_cast<double>(value))) return {};
  return value;
}

/// Exactly `count` finite numbers with commas between them.
std::optional<std::vector<double>> numbers(std::string_view text, std::size_t count) {
  std::vector<double> values;
  for (const std::string_view part : split(text, ',')) {
    const auto value = number<double>(part);
    if (!value) return {};
    values.push_back(*value);
  }
  if (values.size() != count) return {};
  return values;
}

std::optional<DVec3> vector3(std::string_view text) {
  const auto values = numbers(text, 3);
  if (!values) return {};
  return DVec3{(*values)[0], (*values)[1], (*values)[2]};
}

tl::unexpected<Error> refuse(const std::string& option, const std::string& text,
                             const std::string& allowed) {
  return bad_input("'" + text + "' is not understood", option, "give " + allowed);
}

}  // namespace

Result<PictureSize> parse_size(const std::string& option, const std::string& text) {
  const auto parts = split(text, 'x');
  const auto fits = [](const std::optional<int>& side) {
    return side && *side >= 1 && *side <= kLargestSide_px;
  };
  if (parts.size() == 2) {
    const auto width = number<int>(parts[0]), height = number<int>(parts[1]);
    if (fits(width) && fits(height)) return PictureSize{*width, *height};
  }
  return refuse(option, text, "WIDTHxHEIGHT in pixels, 1 to 16384 each, e.g. 640x480");
}

Result<DVec2> parse_pair(const std::string& option, const std::string& text) {
  const auto values = numbers(text, 2);
  if (!values) return refuse(option, text, "two numbers with a comma between, e.g. 320,240.5");
  return DVec2{(*values)[0], (*values)[1]};
}

Result<foveation::RateModel> parse_ramp(const std::string& option, const std::string& text) {
  const auto values = numbers(text, 3);
  if (values) {
    const double inner = (*values)[0], outer = (*values)[1], floor = (*values)[2];
    if (0.0 <= inner && inner < outer && outer <= 180.0 && floor > 0.0 && floor <= 1.0)
      return foveation::RateModel{foveation::RateCurve::Ray, Degrees{inner}, Degrees{outer}, floor};
  }
  return refuse(option, text, "INNER,OUTER,FLOOR: two angles and the least rate, e.g. 10,35,0.05");
}

Result<StillGaze> parse_gaze(const std::string& option, const std::string& text) {
  const auto pair = parse_pair(option, text);
  if (!pair) return forward(pair);
  if (std::abs(pair->x) > 180.0 || std::abs(pair->y) > 90.0) {
    return refuse(option, text, "yaw within -180..180 and pitch within -90..90 degrees");
  }
  return StillGaze{Degrees{pair->x}, Degrees{pair->y}};
}

Result<StillCamera> parse_camera(const std::string& option, const std::string& text) {
  const auto parts = split(text, ';');
  const std::string form =
      "a camera name of the scene or \"ex,ey,ez;tx,ty,tz;ux,uy,uz;vfov_deg\" in the file's units";
  if (parts.size() != 4) return refuse(option, text, form);
  const auto eye = vector3(parts[0]), target = vector3(parts[1]), up = vector3(parts[2]);
  const auto fov = number<double>(parts[3]);
  if (!eye || !target || !up || !fov) return refuse(option, text, form);
  if (*fov <= 0.0 || *fov >= 180.0) {
    return refuse(option, text, "a vertical field of view between 0 and 180 degrees");
  }
  const DVec3 forwards = *target - *eye;
  // A sine of the angle between them below 1e-6 leaves the roll to rounding.
  if (!(length(cross(forwards, *up)) > 1e-6 * length(forwards) * length(*up))) {
    return refuse(option, text,
                  "a target away from the eye and an up vector that is not along the view");
  }
  return StillCamera{*eye, *target, *up, Degrees{*fov}};
}

}  // namespace macula::bench
